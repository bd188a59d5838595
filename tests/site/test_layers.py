"""A site's GeoJSON layers: what they become, and what a bad one gets."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from tests.examples import examples

from recon.geo import geo_from_enu
from recon.model.airspace import HeightDatum, LandingPad, ZoneKind
from recon.model.geo import GeoPoint, LocalFrame
from recon.site import Site, SiteError, load_site, site_report

ORIGIN = GeoPoint(41.9012, -93.6034, 275.0)
FRAME = LocalFrame(ORIGIN)
HEAD = """name = "a field"
[origin]
latitude_deg = 41.9012
longitude_deg = -93.6034
ground_altitude_m = 275.0
"""
SQUARE = [(-100, -100), (100, -100), (100, 100), (-100, 100)]
HOLE = [(-10, -10), (10, -10), (10, 10), (-10, 10)]
BOW = [(-100, -100), (100, 100), (100, -100), (-100, 100)]


def ring(outline: list[tuple[float, float]]) -> list[list[float]]:
    points = [(east, north, 0.0) for east, north in [*outline, outline[0]]]
    latitude, longitude, _ = geo_from_enu(FRAME, points)
    return [[float(x), float(y)] for x, y in zip(longitude, latitude, strict=True)]


def swapped(coordinates: list[list[float]]) -> list[list[float]]:
    return [[latitude, longitude] for longitude, latitude in coordinates]


def polygon(*rings: list[list[float]], **properties: object) -> dict[str, Any]:
    geometry = {"type": "Polygon", "coordinates": list(rings)}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def pad(east: float, north: float, **properties: object) -> dict[str, Any]:
    geometry = {"type": "Point", "coordinates": ring([(east, north)])[0]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features: object, **more: object) -> str:
    return json.dumps({"type": "FeatureCollection", "features": list(features), **more})


def load(folder: Path, layer: str, text: str | bytes, more: str = "") -> Site:
    (folder / "layer.geojson").write_bytes(text.encode() if isinstance(text, str) else text)
    toml = f'{HEAD}[layers]\n{layer} = "layer.geojson"\n{more}'
    (folder / "site.toml").write_text(toml, encoding="utf-8")
    return load_site(folder)


def refusal(folder: Path, layer: str, text: str | bytes, more: str = "") -> str:
    with pytest.raises(SiteError) as caught:
        load(folder, layer, text, more)
    message = str(caught.value)
    assert message.isprintable()
    return message.replace(str(folder), "")


def test_a_boundary_with_a_hole_comes_in_local_metres(tmp_path: Path) -> None:
    site = load(tmp_path, "boundary", collection(polygon(ring(SQUARE), ring(HOLE))))
    boundary = site.layers.boundary
    assert boundary is not None
    assert boundary.outline_m == pytest.approx(np.array(SQUARE), abs=1e-4)
    assert boundary.holes_m[0] == pytest.approx(np.array(HOLE), abs=1e-4)
    assert dict(site.layers.files) == {"boundary": "layer.geojson"}


def test_one_feature_or_one_geometry_is_a_layer_of_that_alone(tmp_path: Path) -> None:
    feature = polygon(ring(SQUARE), ring(HOLE), name="hay")
    whole = load(tmp_path, "boundary", collection(feature)).layers.boundary
    assert whole is not None
    for alone in (feature, feature["geometry"]):
        read = load(tmp_path, "boundary", json.dumps(alone)).layers.boundary
        assert read is not None
        assert (read.outline_m == whole.outline_m).all()
        assert len(read.holes_m) == 1


def test_no_layers_are_empty_layers(tmp_path: Path) -> None:
    (tmp_path / "site.toml").write_text(HEAD)
    layers = load_site(tmp_path).layers
    assert (layers.boundary, layers.zones, layers.landing_pads) == (None, (), ())
    assert (dict(layers.files), dict(layers.survey_regions)) == ({}, {})


@pytest.mark.parametrize(
    "name", ["urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:EPSG::4326", "EPSG:4326"]
)
def test_a_layer_as_qgis_writes_it_is_read(tmp_path: Path, name: str) -> None:
    text = collection(
        {
            "type": "Feature",
            "properties": {"fid": 1, "id": None, "name": "barn", "notes": "ask", "floor_m": None},
            "geometry": {"type": "MultiPolygon", "coordinates": [[ring(SQUARE)]]},
        },
        name="keep out",
        crs={"type": "name", "properties": {"name": name}},
    )
    (zone,) = load(tmp_path, "keep_out", text).layers.zones
    assert (zone.name, zone.kind) == ("barn", ZoneKind.KEEP_OUT)
    assert (zone.floor_m, zone.ceiling_m, zone.datum) == (None, None, None)


def test_zones_have_heights_above_a_datum_that_is_named(tmp_path: Path) -> None:
    low = polygon(ring(HOLE), name="trees", floor_m=40, datum="ground")
    band = polygon(ring(SQUARE), floor_m=300.0, ceiling_m=390.5, datum="wgs84")
    trees, second = load(tmp_path, "height_zones", collection(low, band)).layers.zones
    assert (trees.name, trees.kind) == ("trees", ZoneKind.HEIGHT)
    assert (trees.floor_m, trees.ceiling_m, trees.datum) == (40.0, None, HeightDatum.GROUND)
    assert (second.name, second.datum) == ("height 2", HeightDatum.WGS84)
    assert (second.floor_m, second.ceiling_m) == (300.0, 390.5)


def test_pads_reach_the_profiles_of_their_vehicles(tmp_path: Path) -> None:
    text = collection(
        pad(5, 6, serial="A", altitude_m=274.5), pad(20, 0, name="spare", altitude_m=275)
    )
    site = load(tmp_path, "landing_pads", text, '[[vehicles]]\nserial = "A"\nname = "North"\n')
    own, spare = site.layers.landing_pads
    assert isinstance(own, LandingPad)
    assert (own.name, own.serial, own.place.ellipsoid_height_m) == ("A", "A", 274.5)
    assert (spare.name, spare.serial) == ("spare", None)
    assert site.profiles["A"].pad == own.place
    assert site.profiles["A"].name == "North"
    assert "layer landing_pads from layer.geojson: 2 pads" in site_report(site)


def test_survey_regions_keep_their_order_and_get_names(tmp_path: Path) -> None:
    both = {"type": "MultiPolygon", "coordinates": [[ring(HOLE)], [ring(SQUARE)]]}
    text = collection(
        polygon(ring(SQUARE)),
        {"type": "Feature", "properties": {"name": "east"}, "geometry": both},
    )
    regions = load(tmp_path, "survey_regions", text).layers.survey_regions
    assert list(regions) == ["region 1", "east, part 1", "east, part 2"]
    assert regions["east, part 1"].outline_m == pytest.approx(np.array(HOLE), abs=1e-4)


LINE = {"type": "LineString", "coordinates": ring(SQUARE)}
FAR = [[-94.6, 41.9], [-94.5, 41.9], [-94.5, 42.0], [-94.6, 41.9]]
ANTIPODE = [[86.3966, -41.9012], [86.4, -41.9012], [86.4, -41.9], [86.3966, -41.9012]]
LCC = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::26915"}}
FILE = "/layer.geojson: "
ONE = FILE + "feature 1: "


@pytest.mark.parametrize(
    ("layer", "text", "message"),
    [
        ("boundary", "", FILE + "expected a GeoJSON file, got invalid JSON at line 1, column 1"),
        (
            "boundary",
            '{"type": ',
            FILE + "expected a GeoJSON file, got invalid JSON at line 1, col",
        ),
        (
            "boundary",
            b'{"type": "\xff"}',
            FILE + "expected a GeoJSON file, got bytes that are not UTF-8",
        ),
        ("boundary", "[" * 100_000, FILE + "expected a GeoJSON file, got one nested too deeply"),
        (
            "boundary",
            collection(polygon(name="hay")).replace("[]", "[[[NaN, 1]]]"),
            FILE
            + "feature 1 ('hay'): geometry.coordinates[0][0][0]: expected a finite number, got nan",
        ),
        ("boundary", "[1" + "0" * 5000 + ", NaN]", "got unreadable JSON"),
        ("boundary", "[1e999]", FILE + "[0]: expected a finite number, got inf"),
        ("boundary", " " * 4_200_000, FILE + "expected at most 4194304 bytes, got more"),
        (
            "boundary",
            "[]",
            FILE + "expected a GeoJSON FeatureCollection, Feature or polygon, got a list",
        ),
        (
            "boundary",
            "{}",
            FILE + "expected a GeoJSON FeatureCollection, Feature or polygon, got nothing",
        ),
        (
            "boundary",
            json.dumps(polygon()),
            ONE + "coordinates: expected a polygon's list of rings",
        ),
        ("boundary", '{"type": "LineString"}', "FeatureCollection, Feature or polygon, got 'LineS"),
        ("boundary", '{"type": "FeatureCollection"}', "expected a list of features, got nothing"),
        ("keep_out", collection(*[1] * 1_001), "expected at most 1000 features, got 1001"),
        ("boundary", collection(crs=LCC), "got the CRS 'urn:ogc:def:crs:EPSG::26915'; export"),
        ("boundary", collection(crs=None), "got the CRS nothing"),
        ("boundary", collection({**polygon(), "crs": LCC}), ONE + "expected coordinates in WGS84"),
        ("boundary", collection(), FILE + "expected one polygon, the site's boundary, got 0"),
        ("boundary", collection(polygon(ring(SQUARE)), polygon(ring(SQUARE))), "boundary, got 2"),
        ("boundary", collection(7), ONE + "expected a GeoJSON Feature, got 7"),
        ("boundary", collection({"type": "Feature"}), ONE + "expected a GeoJSON geometry, got no"),
        (
            "boundary",
            collection({**polygon(), "properties": []}),
            "expected properties, got a list",
        ),
        (
            "survey_regions",
            collection(polygon(ring(SQUARE)), {**polygon(name="q\u001b"), "geometry": LINE}),
            "/layer.geojson: feature 2 ('q\\x1b'): properties.name: expected a text of 1 to 64 "
            "characters without control characters, got 'q\\x1b'",
        ),
        (
            "survey_regions",
            collection({**polygon(name="hedge"), "geometry": LINE}),
            "feature 1 ('hedge'): expected a Polygon or MultiPolygon, got 'LineString'",
        ),
        ("boundary", collection(pad(0, 0)), ONE + "expected a Polygon or MultiPolygon, got 'Poi"),
        (
            "boundary",
            collection(polygon()),
            ONE + "coordinates: expected a polygon's list of rings, got",
        ),
        (
            "boundary",
            collection(polygon(ring(SQUARE)[:3])),
            "a ring of at least 4 positions, got a list of 3",
        ),
        (
            "boundary",
            collection(polygon(ring(SQUARE)[:4])),
            ONE + "expected each ring to end where",
        ),
        ("boundary", collection(polygon([["a", 1]] * 4)), "[0][0][0]: expected a number, got 'a'"),
        ("boundary", collection(polygon([[1]] * 4)), "expected a position: longitude, latitude"),
        (
            "boundary",
            collection(polygon([[10**400, 1]] * 4)),
            "[0][0][0]: expected a number, got a number with ve",
        ),
        ("boundary", collection(polygon([[1, 2]] * 10_001)), "at most 10000 corners, got 10001"),
        (
            "keep_out",
            collection(polygon(ring(BOW), name="yard")),
            "feature 1 ('yard'): expected a polygon whose edges do not meet, but its edges cross "
            "or overlap, ",
        ),
        ("keep_out", collection(polygon(ring(SQUARE[:1] * 3))), "fewer than three different corn"),
        (
            "keep_out",
            collection(polygon(ring(HOLE), ring(SQUARE))),
            "a hole lies outside its outline",
        ),
        (
            "boundary",
            collection(polygon(swapped(ring(SQUARE)))),
            "latitude and longitude look swapped: GeoJSON writes the longitude first",
        ),
        (
            "boundary",
            collection(polygon(FAR)),
            ONE
            + "expected corners within 50 km of the site's origin, got longitude -94.6, latitude "
            "41.9, 83 km away; is the origin in site.toml right?",
        ),
        ("boundary", collection(polygon(ANTIPODE)), "is the origin in site.toml right?"),
        (
            "keep_out",
            collection(polygon(ring(SQUARE), height=3)),
            "only the keys name, floor_m, ceiling_m, datum, got 'height'",
        ),
        ("keep_out", collection(polygon(ring(SQUARE), floor_m=3)), "got heights and no datum"),
        ("keep_out", collection(polygon(ring(SQUARE), datum="wgs84")), "a datum and no heights"),
        (
            "keep_out",
            collection(polygon(ring(SQUARE), floor_m=3, datum="msl")),
            "properties.datum: expected 'ground' or 'wgs84', got 'msl'",
        ),
        (
            "height_zones",
            collection(polygon(ring(SQUARE), floor_m=50, ceiling_m=50, datum="ground")),
            "expected floor_m under ceiling_m, got 50 m and 50 m",
        ),
        ("height_zones", collection(polygon(ring(SQUARE))), "expected floor_m, ceiling_m or both"),
        (
            "landing_pads",
            collection(pad(0, 0, name="p")),
            "altitude_m is missing: expected a number of -1000 to ",
        ),
        ("landing_pads", collection(pad(0, 0, altitude_m=275)), "a name, or both, got neither"),
        ("landing_pads", collection(polygon(altitude_m=2, name="p")), "expected a Point, got 'Pol"),
        (
            "landing_pads",
            collection(*[pad(0, 0, altitude_m=275, name="p")] * 2),
            "feature 2 ('p'): expected each pad once, got 'p' again",
        ),
        ("landing_pads", collection(*[pad(0, 0)] * 65), "at most 64 landing pads, got 65"),
        (
            "landing_pads",
            collection(pad(0, 0, altitude_m=275, serial="B")),
            "layers.landing_pads: pad 'B': expected a vehicle's serial, got the unknown 'B'",
        ),
        (
            "landing_pads",
            collection(
                pad(0, 0, altitude_m=275, serial="A"),
                pad(9, 9, altitude_m=275, serial="A", name="x"),
            ),
            "pad 'x': expected one pad for 'A', got another in the layer",
        ),
        (
            "survey_regions",
            collection(*[polygon(ring(SQUARE), name="n")] * 2),
            "feature 2 ('n'): expected each name once, got 'n' again",
        ),
    ],
)
def test_an_error_is_one_sentence_with_file_and_feature(
    tmp_path: Path, layer: str, text: str | bytes, message: str
) -> None:
    assert message in refusal(tmp_path, layer, text, '[[vehicles]]\nserial = "A"\n')


def test_a_pad_given_twice_is_refused(tmp_path: Path) -> None:
    text = collection(pad(0, 0, altitude_m=275, serial="A"))
    more = (
        '[[vehicles]]\nserial = "A"\n'
        "pad = { latitude_deg = 41.9, longitude_deg = -93.6, altitude_m = 275 }\n"
    )
    assert "got another in [[vehicles]]" in refusal(tmp_path, "landing_pads", text, more)


def fenced(folder: Path, *pads: dict[str, Any], more: str = "") -> str:
    """Return the result for a site with a square boundary, a keep-out yard and these pads."""
    (folder / "fence.geojson").write_text(collection(polygon(ring(SQUARE))))
    yard = polygon(ring([(40, 40), (60, 40), (60, 60), (40, 60)]), name="yard")
    loft = polygon(ring(HOLE), name="loft", floor_m=30, datum="ground")
    roof = polygon(ring(HOLE), name="roof", floor_m=300, datum="wgs84")
    (folder / "yard.geojson").write_text(collection(yard, loft, roof))
    lines = 'boundary = "fence.geojson"\nkeep_out = "yard.geojson"\n'
    try:
        load(folder, "landing_pads", collection(*pads), lines + more)
    except SiteError as problem:
        return str(problem).replace(str(folder), "")
    return "read"


def test_pads_lie_inside_the_boundary_and_out_of_zones_with_the_margin(tmp_path: Path) -> None:
    assert fenced(tmp_path, pad(0, 0, name="a", altitude_m=275)) == "read"
    assert fenced(tmp_path, pad(94, 0, name="a", altitude_m=275)) == "read"
    near = [pad(0, 0, name="a", altitude_m=275), pad(97, 0, name="b", altitude_m=275)]
    assert fenced(tmp_path, *near) == (
        "/layer.geojson: feature 2 ('b'): expected a place inside the boundary in fence.geojson, "
        "5 m from its edge at least, got one 3.0 m inside"
    )
    assert "got one 20.0 m outside" in fenced(tmp_path, pad(0, 120, name="a", altitude_m=275))
    assert fenced(tmp_path, pad(50, 36, name="a", altitude_m=275)) == (
        "/layer.geojson: feature 1 ('a'): expected a place 5 m outside the keep-out zone 'yard' at "
        "least, got one 4.0 m outside"
    )
    vehicle = (
        '[[vehicles]]\nserial = "A"\n'
        "pad = { latitude_deg = 41.9112, longitude_deg = -93.6034, altitude_m = 275 }\n"
    )
    assert "/site.toml: vehicles (entry 1).pad: expected a place inside the b" in fenced(
        tmp_path, more=vehicle
    )


def test_the_airspace_holds_what_the_layers_do_and_the_pads_of_profiles(tmp_path: Path) -> None:
    vehicles = (
        '[[vehicles]]\nserial = "A"\n[[vehicles]]\nserial = "B"\nname = "Bea"\n'
        "pad = { latitude_deg = 41.9012, longitude_deg = -93.6034, altitude_m = 274 }\n"
    )
    result = fenced(tmp_path, pad(9, 9, serial="A", altitude_m=275), more=vehicles)
    assert result == "read"
    site = load_site(tmp_path)
    airspace = site.airspace
    assert (airspace.frame, airspace.elevation) == (FRAME, None)
    assert airspace.boundary is site.layers.boundary
    assert [zone.name for zone in airspace.zones] == ["yard", "loft", "roof"]
    assert [(p.name, p.serial) for p in airspace.landing_pads] == [("A", "A"), ("Bea", "B")]
    assert airspace.landing_pads[1].place == GeoPoint(41.9012, -93.6034, 274.0)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('boundary = "none.geojson"', "layers.boundary: expected the name of a file in the site's"),
        ('keep_out = "../x.geojson"', "layers.keep_out: expected the name of a file in the site's"),
        ("keep_out = 3", "layers.keep_out: expected a file's name of 1 to 200 characters without"),
        ('keepout = "a"', "got 'keepout'; did you mean 'keep_out'?"),
    ],
)
def test_a_file_that_is_not_there_is_named(tmp_path: Path, line: str, message: str) -> None:
    (tmp_path / "site.toml").write_text(f"{HEAD}[layers]\n{line}\n")
    with pytest.raises(SiteError) as caught:
        load_site(tmp_path)
    assert message in str(caught.value)


LAYERS = st.sampled_from(["boundary", "keep_out", "height_zones", "landing_pads", "survey_regions"])
numbers = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False),
    st.integers(-(2**70), 2**70),
    st.sampled_from([-93.6034, 41.9012, -93.6, 41.9, 0]),
)
anything = st.recursive(
    st.one_of(st.none(), st.booleans(), numbers, st.text(max_size=8)),
    lambda inner: st.one_of(
        st.lists(inner, max_size=5),
        st.dictionaries(
            st.sampled_from(["type", "name", "crs", "properties", "floor_m"]), inner, max_size=3
        ),
    ),
    max_leaves=12,
)
near = st.tuples(st.floats(-93.7, -93.5), st.floats(41.8, 42.0)).map(list)
positions = st.one_of(near, near, st.lists(numbers, max_size=4))
rings = st.lists(positions, max_size=7).map(lambda ring: ring + ring[:1])
coordinates = st.one_of(
    positions, st.lists(rings, max_size=3), st.lists(st.lists(rings, max_size=2), max_size=2)
)
geometries = st.one_of(
    anything,
    st.fixed_dictionaries(
        {
            "type": st.sampled_from(["Polygon", "MultiPolygon", "Point", "LineString"]),
            "coordinates": st.one_of(coordinates, anything),
        }
    ),
)
properties = st.one_of(
    st.none(),
    anything,
    st.dictionaries(
        st.sampled_from(["name", "floor_m", "ceiling_m", "datum", "serial", "altitude_m", "fid"]),
        st.one_of(numbers, st.sampled_from(["ground", "wgs84", "A", ""]), anything),
        max_size=4,
    ),
)
features = st.fixed_dictionaries(
    {"type": st.just("Feature"), "properties": properties, "geometry": geometries}
)


def outcome(folder: Path, layer: str, data: bytes) -> str:
    try:
        load(folder, layer, data)
    except SiteError as problem:
        return str(problem)
    return "read"


@settings(max_examples=examples(300), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(LAYERS, st.lists(st.one_of(features, features, anything), max_size=3), st.binary(max_size=2))
@example("boundary", [polygon([[0, 0], [0, 5e-324], [5e-324, 0], [0, 0]])], b"")
def test_no_layer_raises_anything_but_a_site_error(
    tmp_path: Path, layer: str, drawn: list[Any], noise: bytes
) -> None:
    text = collection(*drawn).encode()
    middle = len(text) // 2
    for data in (text, text[:middle] + noise + text[middle:], noise):
        result = outcome(tmp_path, layer, data)
        assert result.isprintable()
        assert result == "read" or str(tmp_path) in result


@settings(max_examples=examples(60), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(LAYERS, st.binary(max_size=60))
def test_no_bytes_raise_anything_but_a_site_error(tmp_path: Path, layer: str, data: bytes) -> None:
    assert refusal(tmp_path, layer, data).startswith(FILE)
