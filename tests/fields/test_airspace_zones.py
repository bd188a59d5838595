"""Zones of authorities become keep-out and height zones with their heights and whose they are."""

import json
from typing import Any

import numpy as np
import pytest

from recon.fields.field_file import Imported, ImportedFeature, read_import
from recon.geo.geoid import LARGEST_ERROR_M, geoid_height_m

SQUARE = [[[10.0, 50.0], [10.01, 50.0], [10.01, 50.01], [10.0, 50.01], [10.0, 50.0]]]
AREA = {"type": "Polygon", "coordinates": SQUARE}


def read(document: object) -> Imported:
    return read_import("zones.json", json.dumps(document).encode())


def ed269(restriction: str = "PROHIBITED", **volume: object) -> Imported:
    limits = {
        "uomDimensions": "M",
        "lowerLimit": 0,
        "lowerVerticalReference": "AGL",
        "upperLimit": 120,
        "upperVerticalReference": "AGL",
        "horizontalProjection": AREA,
    }
    zone = {
        "identifier": "AAA001",
        "name": "Hospital",
        "restriction": restriction,
        "zoneAuthority": [{"name": "CAA", "purpose": "AUTHORIZATION"}],
        "applicability": [{"startDateTime": "2026-01-01", "endDateTime": "2026-02-01"}],
        "geometry": [{**limits, **volume}],
    }
    free = {**zone, "name": "open", "restriction": "NO_RESTRICTION"}
    return read({"title": "zones", "features": [zone, free]})


def only(found: Imported) -> ImportedFeature:
    (one,) = found.features
    return one


def test_a_zone_of_ed269_keeps_out_below_its_ceiling() -> None:
    found = ed269()
    zone = only(found)
    assert (zone.name, zone.layer) == ("Hospital", "keep_out")
    assert zone.attributes == {
        "ceiling_m": 120.0,
        "datum": "ground",
        "notes": "PROHIBITED; CAA; 2026-01-01 to 2026-02-01",
    }
    assert [str(each) for each in found.excluded] == ["open: a zone without a restriction"]


def test_a_circle_is_kept_out_of_whole() -> None:
    around = {"type": "Circle", "center": [10.0, 50.0], "radius": 500.0}
    ring = np.array(only(ed269(horizontalProjection=around)).geometry["coordinates"][0])
    off_m = (ring - (10.0, 50.0)) * 111_195.0 * np.array([np.cos(np.radians(50.0)), 1.0])
    middles_m = (off_m[1:] + off_m[:-1]) / 2.0
    assert np.hypot(*middles_m.T).min() >= 499.9


def test_heights_above_sea_level_are_widened_by_what_the_geoid_is_off() -> None:
    sea = {"lowerVerticalReference": "AMSL", "upperVerticalReference": "AMSL", "lowerLimit": 400}
    zone = only(ed269(**sea, upperLimit=2000, uomDimensions="FT"))
    geoid_m = geoid_height_m(50.0, 10.0)
    assert zone.attributes["datum"] == "wgs84"
    assert zone.attributes["floor_m"] == pytest.approx(
        400 * 0.3048 + geoid_m - LARGEST_ERROR_M, abs=0.1
    )
    assert zone.attributes["ceiling_m"] == pytest.approx(
        2000 * 0.3048 + geoid_m + LARGEST_ERROR_M, abs=0.1
    )


@pytest.mark.parametrize(
    "unclear",
    [
        {"upperVerticalReference": "AMSL"},
        {"upperLimit": None},
        {"upperLimit": float("nan")},
        {"upperVerticalReference": "FL"},
    ],
)
def test_of_unclear_heights_it_keeps_out_at_all(unclear: dict[str, Any]) -> None:
    assert only(ed269(**unclear)).attributes.keys() == {"notes"}


def test_a_zone_of_ed318() -> None:
    layer = {"lower": 0, "lowerReference": "AGL", "upper": 60, "upperReference": "AGL", "uom": "m"}
    area = {**AREA, "layer": layer}
    around = {"type": "Point", "coordinates": [10.0, 50.0], "extent": {"radius": 50.0}}
    feature = {
        "type": "Feature",
        "geometry": {
            "type": "GeometryCollection",
            "geometries": [area, {**around, "layer": layer}],
        },
        "properties": {
            "identifier": "B1",
            "name": [{"text": "Airfield", "lang": "en-GB"}],
            "type": "REQ_AUTHORIZATION",
            "variant": "COMMON",
            "zoneAuthority": [{"name": [{"text": "Tower", "lang": "en-GB"}]}],
        },
    }
    first, second = read({"type": "FeatureCollection", "features": [feature]}).features
    assert [first.name, second.name] == ["Airfield, part 1", "Airfield, part 2"]
    assert first.attributes == second.attributes
    assert first.attributes == {
        "ceiling_m": 60.0,
        "datum": "ground",
        "notes": "REQ_AUTHORIZATION; Tower",
    }


@pytest.mark.parametrize(
    ("ceiling_ft", "layer", "ceiling_m"), [(200, "height_zones", 61.0), (0, "keep_out", None)]
)
def test_ceilings_of_the_faa(ceiling_ft: int, layer: str, ceiling_m: float | None) -> None:
    properties = {"CEILING": ceiling_ft, "APT1_FAAID": "AMW", "MAP_EFF": "2026-10-01"}
    feature = {"type": "Feature", "properties": properties, "geometry": AREA}
    zone = only(read({"type": "FeatureCollection", "features": [feature]}))
    assert (zone.name, zone.layer) == (f"AMW {ceiling_ft} ft", layer)
    assert zone.attributes.get("ceiling_m") == ceiling_m


def test_a_damaged_zone_is_named_and_others_are_read() -> None:
    zone = {"identifier": "X", "name": "X", "restriction": "PROHIBITED", "geometry": [{"a": 1}]}
    feature = {"type": "Feature", "properties": {"name": "field"}, "geometry": AREA}
    found = read({"type": "FeatureCollection", "features": [zone, feature]})
    assert only(found).name == "field"
    assert "coordinates that cannot be read" in str(found.excluded[0])
