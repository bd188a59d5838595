"""GeoJSON layers (RFC 7946) as QGIS writes them: features with polygons or points near the site.

Edges are straight in the local frame, where RFC 7946 has them straight in degrees: at 45 degrees of
latitude the two differ by 2 cm in the middle of an edge of 1 km, by 2 m in one of 10 km.
"""

import json
from codecs import BOM_UTF8
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec import Meta

from recon.fields.json_file import WGS84
from recon.geo import enu_from_geo, region_fault
from recon.model.airspace import Region
from recon.model.arrays import FloatArray
from recon.model.errors import SiteError
from recon.model.geo import LatLon, LocalFrame
from recon.site.reading import convert, read_bounded, refuse_non_finite, shown_value

LARGEST_LAYER_BYTES = 4 * 1024 * 1024
MOST_FEATURES = 1_000
MOST_CORNERS = 10_000
"""Most corners of one feature: a drawn outline has tens, a surveyed one hundreds."""
GEOMETRIES = ("Polygon", "MultiPolygon", "Point")
FARTHEST_M = 50_000.0
"""Farthest corner from the origin: more is another place, or swapped latitude and longitude."""
SWAPPED = "latitude and longitude look swapped: GeoJSON writes the longitude first"

Position = Annotated[
    list[float],
    Meta(min_length=2, max_length=3, description="a position: longitude, latitude[, height]"),
]
Ring = Annotated[list[Position], Meta(min_length=4, description="a ring of at least 4 positions")]
Rings = Annotated[list[Ring], Meta(min_length=1, description="a polygon's list of rings")]
Polygons = Annotated[list[Rings], Meta(min_length=1, description="a list of polygons")]


@dataclass(frozen=True, slots=True, eq=False)
class Feature:
    """One feature: `place` names it in errors; `geometry` is not checked yet."""

    place: str
    number: int
    properties: Mapping[str, Any]
    geometry: Mapping[str, Any]


def read_features(path: Path) -> tuple[Feature, ...]:
    """Return a layer's features in the file's order. Raises `SiteError`.

    A file of one feature, or of one geometry without properties, is a layer of that alone.
    """
    data = _read_json(path)
    kind = data.get("type") if isinstance(data, dict) else None
    if kind in GEOMETRIES:
        data, kind = {"type": "Feature", "geometry": data}, "Feature"
    if kind == "Feature":
        return (_feature(path, 1, data),)
    if kind != "FeatureCollection":
        got = shown_value(kind if isinstance(data, dict) else data)
        raise SiteError(
            f"{path}: expected a GeoJSON FeatureCollection, Feature or polygon, got {got}"
        )
    features = _object(str(path), data, kind).get("features")
    if not isinstance(features, list):
        raise SiteError(f"{path}: expected a list of features, got {shown_value(features)}")
    if len(features) > MOST_FEATURES:
        raise SiteError(f"{path}: expected at most {MOST_FEATURES} features, got {len(features)}")
    return tuple(_feature(path, number, each) for number, each in enumerate(features, start=1))


def regions_of(feature: Feature, frame: LocalFrame) -> tuple[Region, ...]:
    """Return the polygons of a Polygon or MultiPolygon, checked. Raises `SiteError`."""
    coordinates = feature.geometry.get("coordinates")
    kind = feature.geometry.get("type")
    if kind == "Polygon":
        polygons = [convert(feature.place, coordinates, Rings, "coordinates")]
    elif kind == "MultiPolygon":
        polygons = convert(feature.place, coordinates, Polygons, "coordinates")
    else:
        raise SiteError(
            f"{feature.place}: expected a Polygon or MultiPolygon, got {shown_value(kind)}"
        )
    corners = sum(len(ring) for rings in polygons for ring in rings)
    if corners > MOST_CORNERS:
        raise SiteError(f"{feature.place}: expected at most {MOST_CORNERS} corners, got {corners}")
    return tuple(_region(feature.place, rings, frame) for rings in polygons)


def point_of(feature: Feature, frame: LocalFrame) -> LatLon:
    """Return where a Point is; its height, if it has one, is not read. Raises `SiteError`."""
    kind = feature.geometry.get("type")
    if kind != "Point":
        raise SiteError(f"{feature.place}: expected a Point, got {shown_value(kind)}")
    position = convert(feature.place, feature.geometry.get("coordinates"), Position, "coordinates")
    _local_m(feature.place, [position], frame)
    return LatLon(latitude_deg=position[1], longitude_deg=position[0])


def _read_json(path: Path) -> object:
    data = read_bounded(path, LARGEST_LAYER_BYTES, "a GeoJSON file").removeprefix(BOM_UTF8)
    try:
        return msgspec.json.decode(data)
    except (msgspec.DecodeError, UnicodeDecodeError) as problem:
        raise SiteError(_not_json(path, data)) from problem
    except RecursionError as problem:
        raise SiteError(f"{path}: expected a GeoJSON file, got one nested too deeply") from problem


def _not_json(path: Path, data: bytes) -> str:
    """Return the error for a file that is not JSON; NaN and infinity are named."""
    expected = f"{path}: expected a GeoJSON file, got"
    try:
        _refuse_non_finite_features(path, json.loads(data.decode("utf-8")))
    except SiteError as problem:
        return str(problem)
    except json.JSONDecodeError as problem:
        return f"{expected} invalid JSON at line {problem.lineno}, column {problem.colno}"
    except UnicodeDecodeError:
        return f"{expected} bytes that are not UTF-8 text"
    except (ValueError, RecursionError):
        pass  # A number with too many digits, or lists nested too deeply.
    return f"{expected} unreadable JSON"


def _refuse_non_finite_features(path: Path, read: object) -> None:
    features = read.get("features") if isinstance(read, dict) else None
    for number, feature in enumerate(features if isinstance(features, list) else [], start=1):
        refuse_non_finite(_feature_place(path, number, feature), feature, "")
    refuse_non_finite(path, read, "")


def _object(place: str, data: object, kind: str | None) -> dict[str, Any]:
    """Return a JSON object of a GeoJSON type, any type for None, in an accepted CRS."""
    if not isinstance(data, dict) or (kind is not None and data.get("type") != kind):
        got = data.get("type") if isinstance(data, dict) else data
        raise SiteError(f"{place}: expected a GeoJSON {kind or 'geometry'}, got {shown_value(got)}")
    if "crs" in data:
        crs = data["crs"]
        properties = crs.get("properties") if isinstance(crs, dict) else None
        name = properties.get("name") if isinstance(properties, dict) else crs
        if not isinstance(name, str) or name not in WGS84:
            raise SiteError(
                f"{place}: expected coordinates in WGS84 (CRS84 or EPSG:4326), got the CRS "
                f"{shown_value(name)}; export the layer as EPSG:4326"
            )
    return data


def _feature(path: Path, number: int, data: object) -> Feature:
    place = _feature_place(path, number, data)
    feature = _object(place, data, "Feature")
    properties = feature.get("properties")
    if properties is None:
        properties = {}
    if not isinstance(properties, dict):
        raise SiteError(f"{place}: expected properties, got {shown_value(properties)}")
    # An attribute left empty in QGIS is written as null.
    properties = {key: value for key, value in properties.items() if value is not None}
    return Feature(place, number, properties, _object(place, feature.get("geometry"), None))


def _feature_place(path: Path, number: int, feature: object) -> str:
    """Return a feature's place in errors: file, number and its name, if any."""
    properties = feature.get("properties") if isinstance(feature, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    return f"{path}: feature {number}" + (
        f" ({shown_value(name)})" if isinstance(name, str) else ""
    )


def _region(place: str, rings: list[list[list[float]]], frame: LocalFrame) -> Region:
    outline, *holes = (_ring(place, ring, frame) for ring in rings)
    region = Region(outline, tuple(holes))
    fault = region_fault(region)
    if fault is not None:
        raise SiteError(f"{place}: expected a polygon whose edges do not meet, but {fault}")
    return region


def _ring(place: str, positions: list[list[float]], frame: LocalFrame) -> FloatArray:
    if positions[0][:2] != positions[-1][:2]:
        raise SiteError(
            f"{place}: expected each ring to end where it starts, got {positions[0][:2]} first and "
            f"{positions[-1][:2]} last"
        )
    return _local_m(place, positions[:-1], frame)


def _local_m(place: str, positions: list[list[float]], frame: LocalFrame) -> FloatArray:
    """Return east-north metres (N, 2) of a file's positions; `SiteError` for a far one."""
    degrees = np.array([position[:2] for position in positions])
    longitude, latitude = degrees[:, 0], degrees[:, 1]
    enu = enu_from_geo(frame, latitude, longitude, frame.origin.ellipsoid_height_m)
    is_far = _is_far(latitude, longitude, enu)
    if is_far.any():
        first = int(np.argmax(is_far))
        swapped = enu_from_geo(frame, longitude, latitude, frame.origin.ellipsoid_height_m)
        looks_swapped = not _is_far(longitude, latitude, swapped)[first]
        raise SiteError(_far_away(place, degrees[first], enu[first], looks_swapped))
    return np.ascontiguousarray(enu[:, :2])


def _is_far(
    latitude: FloatArray, longitude: FloatArray, enu_m: FloatArray
) -> npt.NDArray[np.bool_]:
    is_off_globe = (np.abs(latitude) > 90.0) | (np.abs(longitude) > 180.0)
    # In three dimensions: east and north are small again on the other side of the earth.
    far: npt.NDArray[np.bool_] = is_off_globe | (np.linalg.norm(enu_m, axis=1) > FARTHEST_M)
    return far


def _far_away(place: str, degrees: FloatArray, enu_m: FloatArray, looks_swapped: bool) -> str:
    got = f"longitude {degrees[0]:.6g}, latitude {degrees[1]:.6g}"
    hint = SWAPPED if looks_swapped else "is the origin in site.toml right?"
    distance_km = float(np.linalg.norm(enu_m)) / 1_000.0
    return (
        f"{place}: expected corners within {FARTHEST_M / 1_000.0:g} km of the site's origin, got "
        f"{got}, {distance_km:.0f} km away; {hint}"
    )
