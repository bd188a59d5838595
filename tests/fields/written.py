"""Fields as other programs write them, from shapely's polygons in degrees."""

import io
import json
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from random import Random
from xml.sax.saxutils import escape

import numpy as np
import pyogrio.raw
import shapely

KML_NS = 'xmlns="http://www.opengis.net/kml/2.2"'
Field = tuple[str, shapely.Polygon]


def drawn(random: Random, holes: int = 0) -> shapely.Polygon:
    """A field of 4 to 12 corners, up to 500 m wide, somewhere on the globe."""
    longitude, latitude = random.uniform(-170.0, 170.0), random.uniform(-60.0, 65.0)
    corners = random.randint(4, 12)
    turns = [2.0 * np.pi * (k + random.uniform(0.0, 0.6)) / corners for k in range(corners)]
    outline = [_corner(longitude, latitude, turn, random.uniform(120.0, 250.0)) for turn in turns]
    pieces = [2.0 * np.pi * k / max(holes, 1) for k in range(holes)]
    inside = [
        [_corner(*_corner(longitude, latitude, at, 30.0), t, 8.0) for t in (0.0, 2.1, 4.2)]
        for at in pieces
    ]
    return shapely.Polygon(outline, inside)


def _corner(longitude: float, latitude: float, turn: float, far_m: float) -> tuple[float, float]:
    east = far_m * np.cos(turn) / 111_195.0 / np.cos(np.radians(latitude))
    return longitude + east, latitude + far_m * np.sin(turn) / 111_195.0


def rings_of(shape: shapely.Polygon) -> list[list[tuple[float, float]]]:
    return [list(ring.coords) for ring in (shape.exterior, *shape.interiors)]


def kml(fields: Sequence[Field], random: Random) -> bytes:
    """Nested folders, all holes in one boundary or each in its own, rings closed or not."""
    text = "".join(_placemark(name, shape, random) for name, shape in fields)
    for _ in range(random.randint(0, 4)):
        text = f"<Folder><name>folder</name>{text}</Folder>"
    head = random.choice(['<?xml version="1.0" encoding="UTF-8"?>\n', "", "\n  "])
    if not head.startswith("<"):
        head = ""
    return f"{head}<kml {KML_NS}><Document>{text}</Document></kml>".encode()


def _placemark(name: str, shape: shapely.Polygon, random: Random) -> str:
    is_closed, in_one = random.random() < 0.7, random.random() < 0.5
    heights = random.choice(["", ",0", ",231.5"])
    between = random.choice([" ", "\n", "\n\t\t"])

    def ring(places: list[tuple[float, float]]) -> str:
        places = places if is_closed else places[:-1]
        text = between.join(f"{x:.9f},{y:.9f}{heights}" for x, y in places)
        return f"<LinearRing><coordinates>{text}</coordinates></LinearRing>"

    outer, *inner = map(ring, rings_of(shape))
    holes = ["".join(inner)] if in_one and inner else inner
    inside = "".join(f"<innerBoundaryIs>{each}</innerBoundaryIs>" for each in holes)
    polygon = f"<Polygon><outerBoundaryIs>{outer}</outerBoundaryIs>{inside}</Polygon>"
    if random.random() < 0.3:
        polygon = f"<MultiGeometry>{polygon}</MultiGeometry>"
    if random.random() < 0.3:
        data = f'<SchemaData><SimpleData name="FIELD_NAME">{escape(name)}</SimpleData></SchemaData>'
        return f"<Placemark><ExtendedData>{data}</ExtendedData>{polygon}</Placemark>"
    return f"<Placemark><name>{escape(name)}</name>{polygon}</Placemark>"


def geojson(fields: Sequence[Field], random: Random) -> bytes:
    column = random.choice(["name", "Name", "FIELD_NAME", "field", "schlagname"])
    features = [
        {
            "type": "Feature",
            "properties": {"id": 1, column: name, "crop": 3},
            "geometry": {"type": "Polygon", "coordinates": rings_of(shape)},
        }
        for name, shape in fields
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


def isoxml(fields: Sequence[Field], _random: Random) -> bytes:
    text = "".join(_partfield(number, *each) for number, each in enumerate(fields, start=1))
    return f'<ISO11783_TaskData VersionMajor="4">{text}</ISO11783_TaskData>'.encode()


def _partfield(number: int, name: str, shape: shapely.Polygon) -> str:
    lines = "".join(
        f'<LSG A="{1 if k == 0 else 2}">'
        + "".join(f'<PNT A="2" C="{y:.9f}" D="{x:.9f}"/>' for x, y in ring)
        + "</LSG>"
        for k, ring in enumerate(rings_of(shape))
    )
    return f'<PFD A="PFD{number}" C="{escape(name)}" D="0"><PLN A="1">{lines}</PLN></PFD>'


def gpx(fields: Sequence[Field], _random: Random) -> bytes:
    tracks = "".join(
        f"<trk><name>{escape(name)}</name><trkseg>"
        + "".join(f'<trkpt lat="{y:.9f}" lon="{x:.9f}"/>' for x, y in shape.exterior.coords)
        + "</trkseg></trk>"
        for name, shape in fields
    )
    return f'<gpx xmlns="http://www.topografix.com/GPX/1/1" version="1.1">{tracks}</gpx>'.encode()


def qgc_plan(fields: Sequence[Field], _random: Random) -> bytes:
    items = [
        {
            "type": "ComplexItem",
            "complexItemType": "survey",
            "polygon": [[y, x] for x, y in shape.exterior.coords[:-1]],
        }
        for _, shape in fields
    ]
    return json.dumps({"fileType": "Plan", "mission": {"items": items}}).encode()


def shapefiles(fields: Sequence[Field], crs: Sequence[str]) -> bytes:
    """A zip as a Mac makes it, with a Shapefile for each field in a system of its own."""
    import pyproj

    files: dict[str, bytes] = {}
    with tempfile.TemporaryDirectory() as folder:
        for number, ((name, shape), system) in enumerate(zip(fields, crs, strict=True)):
            there = pyproj.Transformer.from_crs("EPSG:4326", system, always_xy=True)
            moved = shapely.transform(
                shape, lambda p, to=there: np.column_stack(to.transform(p[:, 0], p[:, 1]))
            )
            pyogrio.raw.write(
                Path(folder) / f"{number}.shp",
                geometry=shapely.to_wkb(np.array([moved])),
                field_data=[np.array([name], dtype=object), np.array([number])],
                fields=["FIELD_NAME", "crop"],
                geometry_type="Polygon",
                crs=system,
                driver="ESRI Shapefile",
            )
        for path in Path(folder).iterdir():
            files[f"farm/{path.stem}/{path.name}"] = path.read_bytes()
            files[f"__MACOSX/farm/{path.stem}/._{path.name}"] = b"\x00\x05\x16\x07" + bytes(80)
    return zipped(files)


def zipped(files: Mapping[str, bytes | str]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return packed.getvalue()
