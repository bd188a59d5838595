"""Files from a GIS are read alike in each format; hostile ones are refused with a sentence."""

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pyogrio.raw
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from recon.fields import field_file, limits
from recon.fields.field_file import read_import
from recon.fields.shape import FieldFileError
from recon.model.errors import SiteError

HOLE = [(-93.6032, 41.9012), (-93.6030, 41.9012), (-93.6030, 41.9014), (-93.6032, 41.9012)]
OUTLINE = [(-93.604, 41.901), (-93.602, 41.901), (-93.602, 41.902), (-93.604, 41.901)]
FIELD = shapely.Polygon(OUTLINE, [HOLE])

KML = f"""<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><name>north field</name><Polygon>
<outerBoundaryIs><LinearRing><coordinates>{" ".join(f"{x},{y},0" for x, y in OUTLINE)}
</coordinates></LinearRing></outerBoundaryIs>
<innerBoundaryIs><LinearRing><coordinates>{" ".join(f"{x},{y},0" for x, y in HOLE)}
</coordinates></LinearRing></innerBoundaryIs></Polygon></Placemark></Document></kml>"""


def _zip(**files: bytes | str) -> bytes:
    return _zip_of({name.replace("__", "."): data for name, data in files.items()})


def _zip_of(files: dict[str, bytes | str]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return packed.getvalue()


def _written(folder: Path, name: str, driver: str, crs: str = "EPSG:4326") -> Path:
    path = folder / name
    geometry = FIELD
    if crs != "EPSG:4326":
        import pyproj

        there = pyproj.Transformer.from_crs("EPSG:4326", crs, always_xy=True)
        geometry = shapely.transform(
            FIELD, lambda p: np.column_stack(there.transform(p[:, 0], p[:, 1]))
        )
    pyogrio.raw.write(
        path,
        geometry=shapely.to_wkb(np.array([geometry])),
        field_data=[np.array(["north field"], dtype=object)],
        fields=["name"],
        geometry_type="Polygon",
        crs=crs,
        driver=driver,
    )
    return path


def _shapefile_zip(folder: Path, crs: str) -> bytes:
    _written(folder, "field.shp", "ESRI Shapefile", crs)
    return _zip_of({f"gis/{path.name}": path.read_bytes() for path in folder.glob("field.*")})


@pytest.mark.parametrize("format_", ["kml", "kmz", "shp", "gpkg", "geojson"])
def test_each_format_gives_the_field_with_its_hole_and_name(format_: str, tmp_path: Path) -> None:
    data = {
        "kml": lambda: KML.encode(),
        "kmz": lambda: _zip(doc__kml=KML),
        "shp": lambda: _shapefile_zip(tmp_path, "EPSG:26915"),
        "gpkg": lambda: _written(tmp_path, "f.gpkg", "GPKG", "EPSG:26915").read_bytes(),
        "geojson": lambda: _written(tmp_path, "f.geojson", "GeoJSON").read_bytes(),
    }[format_]()
    found = read_import(f"field.{format_}", data)
    (feature,) = found.features
    assert feature.name == "north field"
    rings = feature.geometry["coordinates"]
    read = shapely.Polygon(rings[0], rings[1:])
    # A UTM zone is off by less than a centimetre after the path there and back.
    assert shapely.hausdorff_distance(read, FIELD) < 1e-7
    assert len(rings) == 2
    assert found.excluded == ()


def test_points_are_kept_and_lines_counted() -> None:
    shapes = [
        {"type": "Point", "coordinates": OUTLINE[0]},
        {"type": "LineString", "coordinates": OUTLINE[:3]},
        {"type": "MultiPolygon", "coordinates": [[OUTLINE], [HOLE]]},
    ]
    features = [{"type": "Feature", "properties": {}, "geometry": each} for each in shapes]
    data = json.dumps({"type": "FeatureCollection", "features": features}).encode()
    found = read_import("mixed.json", data)
    assert [each.geometry["type"] for each in found.features] == ["Point", "Polygon", "Polygon"]
    (path,) = found.excluded
    assert "a path of" in str(path)


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

HOSTILE = {
    "an LZMA bomb": (lambda: _packed(zipfile.ZIP_LZMA), "stored or deflated"),
    "a bzip2 bomb": (lambda: _packed(zipfile.ZIP_BZIP2), "stored or deflated"),
    "a member without a name": (lambda: _zip_of({".": KML}), "names inside the archive"),
    "a file that names another": (lambda: VRT.encode(), "other XML"),
    "two documents": (lambda: KML.encode() + VRT.encode(), "invalid XML"),
    "more corners than are read": (lambda: _corners(9_000, 30), "at most 250000 corners"),
    "a bomb": (lambda: _zip(doc__kml=b"<kml>" + bytes(40 * 1024 * 1024)), "when unpacked"),
    "a way out": (lambda: _zip_of({"../../etc/doc.kml": KML}), "names inside the archive"),
    "an absolute name": (lambda: _zip_of({"/etc/doc.kml": KML}), "names inside the archive"),
    "many files": (lambda: _zip_of({f"{n}.kml": "" for n in range(2001)}), "at most 2000 files"),
    "entities": (lambda: ENTITIES.encode(), "without a document type"),
    "entities in a KMZ": (lambda: _zip(doc__kml=ENTITIES), "without a document type"),
    "deep XML": (lambda: DEEP, "elements deep"),
    "endless XML": (lambda: MANY, "XML elements"),
    "deep JSON": (lambda: NESTED, "nested deeply"),
    "a zip cut off": (lambda: _zip(doc__kml=KML)[:-30], "zip archive that can be read"),
    "a bare .shp": (lambda: b"\x00\x00\x27\x0a" + bytes(100), "as a zip"),
    "no fields": (lambda: _zip(readme__txt="hello"), "got neither, but .txt"),
    "a Shapefile without .prj": (lambda: _zip(a__shp=b"", a__shx=b"", a__dbf=b""), ".prj"),
    "a false Shapefile": (
        lambda: _zip(a__shp=b"x", a__shx=b"", a__dbf=b"", a__prj=b""),
        "another kind of file",
    ),
    "other XML": (lambda: b"<svg/>", "other XML"),
    "a program": (lambda: b"\x7fELF" + bytes(100), "another kind of file"),
    "nothing": (lambda: b"", "another kind of file"),
    "a damaged GeoPackage": (lambda: b"SQLite format 3\x00" + bytes(2000), "damaged"),
    "a huge file": (lambda: b"{" + bytes(limits.LARGEST_FILE_BYTES), "at most"),
}


@pytest.mark.parametrize("kind", HOSTILE)
def test_hostile_files_are_refused_with_a_sentence(kind: str) -> None:
    make, expected = HOSTILE[kind]
    with pytest.raises(SiteError, match=expected):
        read_import(f"../{kind}\n.zip", make())


def test_no_driver_but_those_of_tables_is_tried(tmp_path: Path) -> None:
    """GDAL has drivers that read other files, or the network, when a file asks for it."""
    (tmp_path / "a.csv").write_text("x,y\n1,2\n")
    (tmp_path / "0.gpkg").write_text(VRT.replace("/home/a.csv", str(tmp_path / "a.csv")))
    with pytest.raises(FieldFileError, match="expected a file that GDAL reads, got a damaged one"):
        field_file._read_in_process({"0.gpkg": ""}, tmp_path, close_paths=False)


@settings(max_examples=40, deadline=None)
@given(
    st.binary(max_size=300), st.sampled_from([b"", b"PK\x03\x04", b"<kml>", b"\x00\x00\x27\x0a"])
)
def test_any_bytes_end_in_a_sentence_before_a_process_is_started(tail: bytes, head: bytes) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(field_file, "_read_in_process", _refused)
        with pytest.raises(SiteError):
            read_import("any", head + tail)


def _refused(_documents: object, _folder: Path, *, close_paths: bool) -> object:
    raise FieldFileError(f"reached the process, {close_paths}")


def test_a_file_that_takes_too_long_is_refused_with_what_to_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    spins = "import resource\nresource.setrlimit(resource.RLIMIT_CPU, (1, 2))\nwhile True: pass\n"
    monkeypatch.setattr(field_file, "PROCESS", ("-c", spins))
    with pytest.raises(SiteError, match=r"a few seconds, got a slower one; simplify its shapes"):
        read_import("field.kml", KML.encode())
