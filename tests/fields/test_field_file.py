"""Files from a GIS are read alike in each format; hostile ones are refused with a sentence."""

import json
from pathlib import Path

import numpy as np
import pyogrio.raw
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.fields.hostile import HOLE, HOSTILE, KML, OUTLINE, VRT, zip_named, zip_of

from recon.fields import field_file
from recon.fields.field_file import read_import
from recon.fields.shape import FieldFileError
from recon.model.errors import SiteError

FIELD = shapely.Polygon(OUTLINE, [HOLE])


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


def _shapefilezip_named(folder: Path, crs: str) -> bytes:
    _written(folder, "field.shp", "ESRI Shapefile", crs)
    return zip_of({f"gis/{path.name}": path.read_bytes() for path in folder.glob("field.*")})


@pytest.mark.parametrize("format_", ["kml", "kmz", "shp", "gpkg", "geojson"])
def test_each_format_gives_the_field_with_its_hole_and_name(format_: str, tmp_path: Path) -> None:
    data = {
        "kml": lambda: KML.encode(),
        "kmz": lambda: zip_named(doc__kml=KML),
        "shp": lambda: _shapefilezip_named(tmp_path, "EPSG:26915"),
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
