"""Files that are made to do harm, with what the refusal says; and the largest that are read."""

import io
import json
import zipfile
from collections.abc import Callable, Mapping
from typing import Any

from recon.fields import limits

HOLE = [(-93.6032, 41.9012), (-93.6030, 41.9012), (-93.6030, 41.9014), (-93.6032, 41.9012)]
OUTLINE = [(-93.604, 41.901), (-93.602, 41.901), (-93.602, 41.902), (-93.604, 41.901)]

KML = f"""<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><name>north field</name><Polygon>
<outerBoundaryIs><LinearRing><coordinates>{" ".join(f"{x},{y},0" for x, y in OUTLINE)}
</coordinates></LinearRing></outerBoundaryIs>
<innerBoundaryIs><LinearRing><coordinates>{" ".join(f"{x},{y},0" for x, y in HOLE)}
</coordinates></LinearRing></innerBoundaryIs></Polygon></Placemark></Document></kml>"""


def zip_named(**files: bytes | str) -> bytes:
    return zip_of({name.replace("__", "."): data for name, data in files.items()})


def zip_of(files: dict[str, bytes | str]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return packed.getvalue()


ENTITIES = KML.replace("<kml", '<!DOCTYPE a [<!ENTITY b "bb"><!ENTITY c "&b;&b;">]><kml', 1)

VRT = """<!-- <kml> --><OGRVRTDataSource><OGRVRTLayer name="a"><SrcDataSource>/home/a.csv
</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>"""


def _packed(method: int) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", method) as archive:
        archive.writestr("doc.kml", bytes(1024))
    return packed.getvalue()


def _corners(count: int, shapes: int) -> bytes:
    ring = [[k * 1e-7, (k % 2) * 1e-7] for k in range(count)]
    shape = {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}
    one = {"type": "Feature", "properties": {}, "geometry": shape}
    return json.dumps({"type": "FeatureCollection", "features": [one] * shapes}).encode()


DEEP = b"<kml>" + b"<Folder>" * 200 + b"</Folder>" * 200 + b"</kml>"
MANY = b"<kml>" + b"<a/>" * 500_000 + b"</kml>"
NESTED = b'{"type":"Polygon","coordinates":' + b"[" * 100_000 + b"]" * 100_000 + b"}"

HOSTILE: Mapping[str, tuple[Callable[[], bytes], str]] = {
    "an LZMA bomb": (lambda: _packed(zipfile.ZIP_LZMA), "stored or deflated"),
    "a bzip2 bomb": (lambda: _packed(zipfile.ZIP_BZIP2), "stored or deflated"),
    "a member without a name": (lambda: zip_of({".": KML}), "names inside the archive"),
    # Names end at a zero.
    "a member with an empty name": (
        lambda: zip_of({"a.kml": KML}).replace(b"a.kml", b"\0.kml"),
        "names inside the archive",
    ),
    "a file that names another": (lambda: VRT.encode(), "other XML"),
    "two documents": (lambda: KML.encode() + VRT.encode(), "invalid XML"),
    "more corners than are read": (lambda: _corners(9_000, 30), "at most 250000 corners"),
    "a bomb": (lambda: zip_named(doc__kml=b"<kml>" + bytes(40 * 1024 * 1024)), "when unpacked"),
    "a way out": (lambda: zip_of({"../../etc/doc.kml": KML}), "names inside the archive"),
    "an absolute name": (lambda: zip_of({"/etc/doc.kml": KML}), "names inside the archive"),
    "many files": (lambda: zip_of({f"{n}.kml": "" for n in range(2001)}), "at most 2000 files"),
    "entities": (lambda: ENTITIES.encode(), "without a document type"),
    "entities in a KMZ": (lambda: zip_named(doc__kml=ENTITIES), "without a document type"),
    "deep XML": (lambda: DEEP, "elements deep"),
    "endless XML": (lambda: MANY, "XML elements"),
    "deep JSON": (lambda: NESTED, "nested deeply"),
    "a zip cut off": (lambda: zip_named(doc__kml=KML)[:-30], "zip archive that can be read"),
    "a bare .shp": (lambda: b"\x00\x00\x27\x0a" + bytes(100), "as a zip"),
    "no fields": (lambda: zip_named(readme__txt="hello"), "got neither, but .txt"),
    "a Shapefile without .prj": (lambda: zip_named(a__shp=b"", a__shx=b"", a__dbf=b""), ".prj"),
    "a false Shapefile": (
        lambda: zip_named(a__shp=b"x", a__shx=b"", a__dbf=b"", a__prj=b""),
        "another kind of file",
    ),
    "other XML": (lambda: b"<svg/>", "other XML"),
    "a program": (lambda: b"\x7fELF" + bytes(100), "another kind of file"),
    "nothing": (lambda: b"", "another kind of file"),
    "a damaged GeoPackage": (lambda: b"SQLite format 3\x00" + bytes(2000), "damaged"),
    "a huge file": (lambda: b"{" + bytes(limits.LARGEST_FILE_BYTES), "at most"),
    "ISOXML with entities": (
        lambda: ENTITIES.replace("kml", "ISO11783_TaskData").encode(),
        "without a document type",
    ),
    "deep GPX": (lambda: DEEP.replace(b"kml", b"gpx"), "elements deep"),
    "endless GPX": (
        lambda: b"<gpx><trk><trkseg>" + b'<trkpt lat="1" lon="1"/>' * 400_000,
        "XML elements",
    ),
    "endless attributes": (
        lambda: b"<kml " + b" ".join(b'a%d="1"' % n for n in range(300_000)) + b"/>",
        "got none",
    ),
    "a number of a million digits": (
        lambda: b'{"type":"Point","coordinates":[' + b"1" * 1_000_000 + b",1]}",
        "JSON",
    ),
    "endless coordinates": (
        lambda: KML.replace("</coordinates>", "1,1 " * 1_000_000 + "</coordinates>", 1).encode(),
        "touches itself",
    ),
}


def _star(corners: int) -> list[list[float]]:
    """Every edge crosses nearly every other."""
    return [
        [0.01 * ((k * (corners // 2)) % corners) / corners, 0.01 * (k % 2)] for k in range(corners)
    ]


def _geojson(*geometries: Mapping[str, Any]) -> bytes:
    features = [{"type": "Feature", "properties": {}, "geometry": each} for each in geometries]
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


def _polygon(*rings: list[list[float]]) -> Mapping[str, Any]:
    return {"type": "Polygon", "coordinates": [[*ring, ring[0]] for ring in rings]}


def _cell(number: int) -> list[list[float]]:
    x, y = 1e-4 * (number % 100 + 1), 1e-4 * (number // 100 + 1)
    return [[x, y], [x + 5e-5, y], [x + 5e-5, y + 5e-5]]


AROUND = [[0.0, 0.0], [0.02, 0.0], [0.02, 0.02], [0.0, 0.02]]
LARGE: Mapping[str, Callable[[], bytes]] = {
    "2,400 holes in one field": lambda: _geojson(_polygon(AROUND, *map(_cell, range(2_400)))),
    "20 stars of 9,000 corners": lambda: _geojson(*[_polygon(_star(9_000))] * 20),
    "5,000 fields": lambda: _geojson(*[_polygon(_cell(number)) for number in range(5_000)]),
    "a name of 10 MB": lambda: KML.replace("north field", "n" * 10_000_000).encode(),
}
"""What a person's program may write at the limits: read or refused in the same time."""
