"""Zones of authorities: ED-269, its successor ED-318, and the FAA's facility map of ceilings.

What is not free becomes a keep-out zone at its heights. Of two heights above different things, and
of times, the zone keeps what is safe: it has no ceiling then, and is there at all times; whose it
is and when it holds stands in its notes.
"""

from collections.abc import Mapping
from math import isfinite
from typing import Any

from recon.fields.json_shapes import CIRCLE_CORNERS, add_geometry, circle
from recon.fields.shape import Attributes, Found
from recon.model.units import M_PER_FT

FREE = ("NO_RESTRICTION", "NO RESTRICTION")
GROUND, SEA_LEVEL, ELLIPSOID = ("AGL", "SFC"), ("AMSL", "MSL"), ("WGS84", "HAE")
MOST_NOTES = 300

Feature = Mapping[str, Any]


def read_zone(feature: Feature, number: int, found: Found) -> bool:
    """Take a feature of an authority's file; return False where it is not one."""
    properties = feature.get("properties")
    geometry = feature.get("geometry")
    if isinstance(geometry, list) and "restriction" in feature:
        _read_ed269(feature, number, found)
    elif isinstance(properties, dict) and {"variant", "zoneAuthority"} & properties.keys():
        _read_ed318(properties, geometry, number, found)
    elif isinstance(properties, dict) and {"CEILING", "APT1_FAAID"} <= properties.keys():
        _read_ceiling(properties, geometry, found)
    else:
        return False
    return True


def _read_ed269(feature: Feature, number: int, found: Found) -> None:
    name = str(feature.get("name") or feature.get("identifier") or f"zone {number}")
    if str(feature["restriction"]).upper() in FREE:
        found.exclude(name, "a zone without a restriction")
        return
    notes = _notes(
        feature["restriction"], feature.get("zoneAuthority"), feature.get("applicability")
    )
    for volume in feature["geometry"]:
        projection = volume["horizontalProjection"]
        limits = {
            "lower": volume.get("lowerLimit"),
            "lowerReference": volume.get("lowerVerticalReference"),
            "upper": volume.get("upperLimit"),
            "upperReference": volume.get("upperVerticalReference"),
            "uom": volume.get("uomDimensions"),
        }
        if projection.get("type") == "Circle":
            projection = _around(projection["center"], projection["radius"])
        add_geometry(projection, name, found, "keep_out", _heights(limits, projection) | notes)


def _read_ed318(properties: Feature, geometry: Any, number: int, found: Found) -> None:
    name = _text(properties.get("name")) or str(properties.get("identifier") or f"zone {number}")
    kind = str(properties.get("type", "")).upper()
    if kind in FREE:
        found.exclude(name, "a zone without a restriction")
        return
    notes = _notes(kind, properties.get("zoneAuthority"), properties.get("limitedApplicability"))
    parts = geometry["geometries"] if geometry["type"] == "GeometryCollection" else [geometry]
    for part in parts:
        limits = part.get("layer") or {}
        radius_m = (part.get("extent") or {}).get("radius")
        shape = part if radius_m is None else _around(part["coordinates"], radius_m)
        add_geometry(shape, name, found, "keep_out", _heights(limits, shape) | notes)


def _read_ceiling(properties: Feature, geometry: Any, found: Found) -> None:
    """UASFM: feet above ground up to which a request is granted; 0 is none."""
    name = f"{properties['APT1_FAAID']} {properties['CEILING']:g} ft"
    ceiling_m = float(properties["CEILING"]) * M_PER_FT
    notes: Attributes = {"notes": f"FAA UAS facility map, {properties.get('MAP_EFF', 'undated')}"}
    if ceiling_m <= 0.0:
        add_geometry(geometry, name, found, "keep_out", notes)
    else:
        heights: Attributes = {"ceiling_m": round(ceiling_m, 1), "datum": "ground"}
        add_geometry(geometry, name, found, "height_zones", heights | notes)


def _around(centre: Any, radius_m: Any) -> Feature:
    longitude, latitude = float(centre[0]), float(centre[1])
    ring = list(circle(latitude, longitude, float(radius_m), is_inside=False))
    assert len(ring) == CIRCLE_CORNERS
    return {"type": "Polygon", "coordinates": [ring]}


def _heights(limits: Feature, shape: Feature) -> Attributes:
    """Return a zone's floor and ceiling above one datum, or none: then it is at every height."""
    unit_m = M_PER_FT if str(limits.get("uom") or "m").upper() in ("FT", "FEET") else 1.0
    lower, upper = (_limit(limits, side, unit_m) for side in ("lower", "upper"))
    if lower is None or upper is None:
        return {}
    (floor_m, below), (ceiling_m, above) = lower, upper
    if below != above:
        # The ground is no higher above sea level than somebody's guess: no ceiling, no floor.
        return {}
    if below == "ground":
        heights: Attributes = {"ceiling_m": ceiling_m, "datum": "ground"}
        return heights | ({"floor_m": floor_m} if floor_m > 0.0 else {})
    from recon.geo.geoid import LARGEST_ERROR_M, geoid_height_m

    corner: Any = shape["coordinates"]
    while isinstance(corner[0], list | tuple):
        corner = corner[0]
    geoid_m = geoid_height_m(float(corner[1]), float(corner[0])) if below == "sea" else 0.0
    off_m = LARGEST_ERROR_M if below == "sea" else 0.0
    return {
        "floor_m": round(floor_m + geoid_m - off_m, 1),
        "ceiling_m": round(ceiling_m + geoid_m + off_m, 1),
        "datum": "wgs84",
    }


def _limit(limits: Feature, side: str, unit_m: float) -> tuple[float, str] | None:
    value, reference = limits.get(side), str(limits.get(f"{side}Reference") or "").upper()
    if not isinstance(value, int | float) or isinstance(value, bool) or not isfinite(value):
        return None
    for words, datum in ((GROUND, "ground"), (SEA_LEVEL, "sea"), (ELLIPSOID, "wgs84")):
        if reference in words:
            return value * unit_m, datum
    return None


def _notes(restriction: object, authorities: object, times: object) -> Attributes:
    names = [_text(each.get("name")) for each in _listed(authorities)]
    spans = [
        f"{each.get('startDateTime', '')} to {each.get('endDateTime', '')}"
        for each in _listed(times)
        if each.get("permanent") != "YES"
    ]
    parts = [str(restriction), *names, *spans]
    return {"notes": "; ".join(part for part in parts if part)[:MOST_NOTES]}


def _listed(value: object) -> list[Mapping[str, Any]]:
    return [each for each in value if isinstance(each, dict)] if isinstance(value, list) else []


def _text(value: object) -> str:
    """Return a text that is given plain, or once for each language."""
    if isinstance(value, list):
        value = next((each.get("text") for each in _listed(value)), "")
    return "" if value is None else str(value)
