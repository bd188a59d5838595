"""Zones whose heights are under the ground do nothing: they are refused."""

from pathlib import Path

import pytest
from tests.site.terrain import geotiff, load, ridge
from tests.site.test_layers import HOLE, collection, polygon, refusal, ring
from tests.site.test_layers import load as load_layer

from recon.site import SiteError
from recon.site.report import site_warnings

PLACE = "/layer.geojson: zone 'yard': "
RIDGE = [(60, -20), (100, -20), (100, 20), (60, 20)]
FLAT = [(-60, -20), (-40, -20), (-40, 20), (-60, 20)]


def zone(outline: list[tuple[float, float]] = HOLE, **heights: object) -> str:
    return collection(polygon(ring(outline), name="yard", **heights))


@pytest.mark.parametrize(
    ("layer", "heights", "message"),
    [
        (
            "keep_out",
            {"ceiling_m": 30, "datum": "wgs84"},
            "expected ceiling_m above the ground beneath, which is up to 275 m above the WGS84 "
            "ellipsoid, got 30 m from the same; set datum to 'ground' if the height is above "
            "ground, or set a greater height",
        ),
        ("keep_out", {"ceiling_m": 275, "datum": "wgs84"}, "got 275 m from the same"),
        (
            "keep_out",
            {"ceiling_m": -5, "datum": "ground"},
            "expected ceiling_m to be more than 0 m above ground, got -5 m; set a greater height "
            "or remove it",
        ),
        ("keep_out", {"ceiling_m": 0, "datum": "ground"}, "more than 0 m above ground, got 0 m"),
        ("height_zones", {"ceiling_m": 60, "datum": "wgs84"}, "expected ceiling_m above the gr"),
        ("height_zones", {"floor_m": 35, "datum": "wgs84"}, "expected floor_m above the ground"),
        ("height_zones", {"floor_m": -1, "datum": "ground"}, "floor_m to be at least 0 m above"),
    ],
)
def test_heights_under_the_ground_are_refused(
    tmp_path: Path, layer: str, heights: dict[str, object], message: str
) -> None:
    result = refusal(tmp_path, layer, zone(**heights))
    assert result.startswith(PLACE)
    assert message in result


@pytest.mark.parametrize(
    ("layer", "heights"),
    [
        ("keep_out", {}),
        ("keep_out", {"ceiling_m": 30, "datum": "ground"}),
        ("keep_out", {"ceiling_m": 276, "datum": "wgs84"}),
        ("keep_out", {"floor_m": -5, "datum": "ground"}),
        ("keep_out", {"floor_m": 5, "datum": "wgs84"}),
        ("height_zones", {"floor_m": 0, "datum": "ground"}),
        ("height_zones", {"floor_m": 275, "ceiling_m": 305, "datum": "wgs84"}),
    ],
)
def test_heights_that_bind_somewhere_are_read(
    tmp_path: Path, layer: str, heights: dict[str, object]
) -> None:
    (read,) = load_layer(tmp_path, layer, zone(**heights)).layers.zones
    assert (read.floor_m, read.ceiling_m) == (heights.get("floor_m"), heights.get("ceiling_m"))


def over(folder: Path, outline: list[tuple[float, float]], ceiling_m: float) -> str:
    """Return the result for a keep-out zone over hilly ground; the ridge is 305 m high."""
    (folder / "layer.geojson").write_text(zone(outline, ceiling_m=ceiling_m, datum="wgs84"))
    try:
        load(folder, geotiff(ridge), more='[layers]\nkeep_out = "layer.geojson"\n')
    except SiteError as problem:
        return str(problem)
    return "read"


def test_the_elevation_model_tells_the_ground_beneath_where_there_is_one(tmp_path: Path) -> None:
    assert over(tmp_path, FLAT, 280.0) == "read"
    assert "which is up to 30" in over(tmp_path, RIDGE, 280.0)
    assert over(tmp_path, RIDGE, 306.0) == "read"


def test_where_the_model_knows_no_ground_the_sites_counts(tmp_path: Path) -> None:
    far = [(900.0, 900.0), (950.0, 900.0), (950.0, 950.0), (900.0, 950.0)]
    assert over(tmp_path, far, 276.0) == "read"
    assert "up to 275 m above" in over(tmp_path, far, 274.0)


@pytest.mark.parametrize(
    ("floor_m", "datum", "is_warned"),
    [(121, "ground", True), (119, "ground", False), (396, "wgs84", True), (394, "wgs84", False)],
)
def test_a_keep_out_zone_that_begins_above_every_flight_gets_a_warning(
    tmp_path: Path, floor_m: float, datum: str, is_warned: bool
) -> None:
    site = load_layer(tmp_path, "keep_out", zone(floor_m=floor_m, datum=datum))
    warnings = [line for line in site_warnings(site) if "yard" in line]
    assert warnings == is_warned * [
        f"keep-out zone yard begins at {floor_m:g} m ({datum}), above every allowed height there; "
        "is its datum right?"
    ]
