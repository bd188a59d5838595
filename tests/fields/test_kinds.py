"""What users' files are like: read right, or left out with a name and a reason."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from recon.fields.field_file import Imported, read_import
from recon.fields.names import cleaned, each_once, name_column
from recon.geo.datum import UnknownDatumError, path_to_wgs84
from recon.model.errors import SiteError

KML = '<kml xmlns="http://www.opengis.net/kml/2.2"><Document>{}</Document></kml>'
SQUARE = "-93.6,41.9,0 -93.599,41.9,0 -93.599,41.901,0 -93.6,41.901,0"
CLOSED = f"{SQUARE} -93.6,41.9,0"
CROSSED = "-93.6,41.9 -93.599,41.901 -93.599,41.9 -93.6,41.901 -93.6,41.9"
PONDS = (
    "-93.5998,41.9002 -93.5996,41.9002 -93.5996,41.9004 -93.5998,41.9002",
    "-93.5994,41.9006 -93.5992,41.9006 -93.5992,41.9008 -93.5994,41.9006",
)


def ring(places: str) -> str:
    return f"<LinearRing><coordinates>{places}</coordinates></LinearRing>"


def polygon(places: str, inside: str = "") -> str:
    return f"<Polygon><outerBoundaryIs>{ring(places)}</outerBoundaryIs>{inside}</Polygon>"


def placemark(name: str, shape: str) -> str:
    return f"<Placemark><name>{name}</name>{shape}</Placemark>"


def kml(*parts: str, close_paths: bool = False) -> Imported:
    return read_import("a.kml", KML.format("".join(parts)).encode(), close_paths=close_paths)


def geojson(crs: str | None, *features: tuple[Mapping[str, Any], object]) -> Imported:
    document: dict[str, Any] = {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "properties": properties, "geometry": geometry}
            for properties, geometry in features
        ],
    }
    if crs is not None:
        document["crs"] = {"type": "name", "properties": {"name": crs}}
    return read_import("a.geojson", json.dumps(document).encode())


def square(x: float, y: float, side: float) -> dict[str, Any]:
    places = [[x, y], [x + side, y], [x + side, y + side], [x, y + side], [x, y]]
    return {"type": "Polygon", "coordinates": [places]}


def test_several_holes_in_one_boundary_as_google_earth_writes_them() -> None:
    inside = f"<innerBoundaryIs>{''.join(map(ring, PONDS))}</innerBoundaryIs>"
    (field,) = kml(placemark("ponds", polygon(CLOSED, inside))).features
    assert len(field.geometry["coordinates"]) == 3


def test_pictures_links_models_and_placemarks_without_a_shape_are_named() -> None:
    frame = "<LatLonBox><north>42</north><south>41</south><east>-93</east><west>-94</west>"
    found = kml(
        placemark("north", polygon(CLOSED)),
        f"<GroundOverlay><name>photo</name>{frame}</LatLonBox></GroundOverlay>",
        "<NetworkLink><name>more</name><Link><href>http://a/b.kml</href></Link></NetworkLink>",
        placemark("barn", "<Model/>"),
        placemark("note", ""),
        placemark("torn", polygon("-93.6,41.9 x -93.5,41.9 -93.5,41.8")),
    )
    assert [each.name for each in found.features] == ["north"]
    assert {each.name: each.reason.split(":")[0] for each in found.excluded} == {
        "photo": "a picture laid on the map",
        "more": "a link to another file",
        "barn": "a 3D model",
        "note": "no shape",
        "torn": "coordinates that cannot be read",
    }


def test_rings_alone_and_rings_that_are_not_closed_are_areas() -> None:
    found = kml(placemark("walked", ring(CLOSED)), placemark("drawn", polygon(SQUARE)))
    walked, drawn = found.features
    assert walked.geometry == drawn.geometry
    assert found.excluded == ()


def test_a_crossed_one_is_named_and_the_others_are_taken() -> None:
    found = kml(placemark("good", polygon(CLOSED)), placemark("eight", polygon(CROSSED)))
    assert [each.name for each in found.features] == ["good"]
    (eight,) = found.excluded
    assert str(eight).startswith("eight: its edges cross or overlap at longitude -93.599500")


def test_a_path_is_an_area_where_it_closes_or_is_asked_to() -> None:
    line = "<LineString><coordinates>{}</coordinates></LineString>"
    found = kml(placemark("round", line.format(CLOSED)))
    assert [each.name for each in found.features] == ["round"]
    assert "the path is taken as an area" in found.warnings[0]
    way = placemark("way", line.format(SQUARE))
    with pytest.raises(SiteError, match="got none: way: a path of 4 points, not an area: close"):
        kml(way)
    assert kml(way, close_paths=True).features[0].geometry == found.features[0].geometry


def test_parts_and_equal_names_are_numbered() -> None:
    both = f"<MultiGeometry>{polygon(CLOSED)}{polygon(CLOSED)}</MultiGeometry>"
    found = kml(placemark("home farm", both), *[placemark("Untitled", polygon(CLOSED))] * 2)
    assert [each.name for each in found.features] == [
        *("home farm, part 1", "home farm, part 2"),
        *("Untitled", "Untitled 2"),
    ]


def test_names_become_one_line_of_a_length_that_a_site_takes() -> None:
    assert cleaned("\n  North\t40 \x00") == "North 40"
    assert len(cleaned("x" * 1000)) == 64
    assert list(each_once(["a", "a", "a 2", "", "", "a"])) == ["a", "a 3", "a 2", "", "", "a 4"]


@pytest.mark.parametrize(
    ("columns", "is_text", "chosen"),
    [
        (("id", "Name"), (False, True), 1),
        (("FARM", "FIELD_NAME"), (True, True), 1),
        (("crop", "Schlag"), (True, True), 1),
        (("id", "what"), (False, True), 1),
        (("crop", "owner"), (True, True), None),
    ],
)
def test_the_column_of_names(
    columns: tuple[str, ...], is_text: tuple[bool, ...], chosen: int | None
) -> None:
    assert name_column(columns, is_text) == chosen


def test_a_feature_without_a_shape_is_counted() -> None:
    found = geojson(None, ({"name": "north"}, square(-93.6, 41.9, 0.01)), ({"name": "empty"}, None))
    assert [str(each) for each in found.excluded] == ["empty: no shape"]


def test_an_rtk_track_is_simplified_within_two_centimetres() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 12_001)
    places = np.column_stack([-93.6 + 0.003 * np.cos(turn), 41.9 + 0.002 * np.sin(turn)])
    found = geojson(None, ({"name": "n"}, {"type": "Polygon", "coordinates": [places.tolist()]}))
    (outline,) = found.features[0].geometry["coordinates"]
    assert 100 < len(outline) < 1_000
    assert found.warnings[0].startswith("n: 12000 corners are simplified to ")
    area = _area_deg2(np.array(outline))
    assert area == pytest.approx(np.pi * 0.003 * 0.002, rel=2e-4)


def _area_deg2(ring: np.ndarray[Any, Any]) -> float:
    x, y = ring[:-1].T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def test_the_accuracy_of_a_transformation_is_stated() -> None:
    found = geojson("urn:ogc:def:crs:EPSG::27700", ({"name": "caister"}, square(651e3, 312e3, 100)))
    (warning,) = found.warnings
    assert "OSGB36 / British National Grid: the transformation to WGS84 is accurate to 2 m" in (
        warning
    )
    longitude, latitude = found.features[0].geometry["coordinates"][0][0]
    assert abs(longitude - 1.7091) < 1e-4
    assert abs(latitude - 52.6476) < 1e-4
    assert found.is_fit_for_fences


def test_of_a_datum_that_nobody_relates_to_wgs84_no_fence_is_made() -> None:
    clarke = "+proj=longlat +ellps=clrk66 +no_defs"
    found = geojson(clarke, ({"name": "old"}, square(-93.6, 41.9, 0.01)))
    assert not found.is_fit_for_fences
    assert "no transformation to WGS84 is known" in found.warnings[0]


@pytest.mark.parametrize(
    ("crs", "accuracy_m"),
    [
        ("EPSG:4326", 0.0),
        ("EPSG:32615", 0.0),
        ("EPSG:25832", 1.0),
        ("EPSG:4490", 0.5),
        ("+proj=longlat +ellps=WGS84 +no_defs", 0.5),
        ("+proj=longlat +ellps=clrk66 +no_defs", None),
    ],
)
def test_paths_to_wgs84_with_their_accuracy(crs: str, accuracy_m: float | None) -> None:
    assert path_to_wgs84(crs).accuracy_m == accuracy_m


def test_an_unknown_system_is_refused() -> None:
    with pytest.raises(UnknownDatumError, match="expected a known coordinate reference system"):
        path_to_wgs84("EPSG:1")
    with pytest.raises(SiteError, match="expected a known coordinate reference system"):
        geojson("urn:ogc:def:crs:EPSG::1", ({}, square(0.0, 0.0, 1.0)))


def test_a_mapping_mission_of_pilot_2_is_its_area_and_a_waypoint_one_its_path() -> None:
    height = '<wpml:height xmlns:wpml="http://www.dji.com/wpmz/1.0.2">60</wpml:height>'
    (area,) = kml(f"<Folder><Placemark>{polygon(SQUARE)}{height}</Placemark></Folder>").features
    assert len(area.geometry["coordinates"][0]) == 5
    points = "".join(
        f"<Placemark><Point><coordinates>{place}</coordinates></Point>"
        f'<w:index xmlns:w="http://www.dji.com/wpmz/1.0.2">{number}</w:index></Placemark>'
        for number, place in enumerate(SQUARE.split())
    )
    with pytest.raises(SiteError, match="waypoints: a path of 4 points"):
        kml(f"<Folder>{points}</Folder>")


def test_fences_of_qgroundcontrol_stay_on_their_safe_side() -> None:
    circle = {"center": [41.9, -93.6], "radius": 100.0}
    circles = [{"circle": circle, "inclusion": is_inside} for is_inside in (True, False)]
    plan = {"fileType": "Plan", "geoFence": {"polygons": [], "circles": circles}}
    inside, outside = read_import("a.plan", json.dumps(plan).encode()).features
    assert (inside.name, outside.name) == ("fence 1, circle", "keep out 2, circle")
    for each, is_inside in ((inside, True), (outside, False)):
        places = np.array(each.geometry["coordinates"][0]) - (-93.6, 41.9)
        places *= 111_195.0 * np.array([np.cos(np.radians(41.9)), 1.0])
        middles = (places[1:] + places[:-1]) / 2.0
        assert is_inside == bool((np.hypot(*places.T) <= 100.05).all())
        assert is_inside != bool((np.hypot(*middles.T) >= 99.99).all())


def test_corners_off_the_globe_are_named() -> None:
    far = {"type": "Point", "coordinates": [500_000.0, 4_600_000.0]}
    found = geojson(None, ({"name": "utm"}, far), ({"name": "n"}, square(-93.6, 41.9, 0.01)))
    assert "utm: expected longitudes and latitudes on the globe, got 500000" in str(
        found.excluded[0]
    )
