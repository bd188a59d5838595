"""One region to survey from a file, checked before any request to the station."""

from pathlib import Path
from typing import Any

from recon.client import ClientError
from recon.model.airspace import Region
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint, LocalFrame
from recon.site.geojson import Feature, first_corner_of, is_json, read_features, regions_of
from recon.site.imports import FORMATS, LARGEST_IMPORT_BYTES, read_import
from recon.site.reading import read_bounded

Rings = list[list[list[float]]]


class RegionFileError(ClientError):
    """Not a region to survey; the text names the file, the feature and the reason."""


def read_region(path: Path, feature: str | None, origin: GeoPoint) -> tuple[str, Rings]:
    """Return the name and the rings of the one region in a file, or of the feature of that name.

    Raises `RegionFileError`, also for a region far from `origin`, the site's.
    """
    try:
        chosen = _chosen(path, feature)
        regions = regions_of(chosen, LocalFrame(origin))
    except SiteError as problem:
        raise RegionFileError(str(problem)) from problem
    _refuse_several(chosen, len(regions))
    return _name(chosen) or path.stem, _rings(chosen)


def region_in(
    path: Path, feature: str | None, site_frame: LocalFrame | None
) -> tuple[str, Region, LocalFrame]:
    """Return the name of the one region in a file, and the region in metres of a frame.

    Without a site's frame its own has the region's first corner as origin. Raises
    `RegionFileError`.
    """
    try:
        chosen = _chosen(path, feature)
        frame = site_frame or LocalFrame(_first_corner(chosen))
        regions = regions_of(chosen, frame)
    except SiteError as problem:
        raise RegionFileError(str(problem)) from problem
    _refuse_several(chosen, len(regions))
    return _name(chosen) or path.stem, regions[0], frame


def _first_corner(chosen: Feature) -> GeoPoint:
    place = first_corner_of(chosen)
    return GeoPoint(place.latitude_deg, place.longitude_deg, 0.0)


def _refuse_several(chosen: Feature, polygons: int) -> None:
    if polygons != 1:
        raise RegionFileError(
            f"{chosen.place}: expected one polygon, got {polygons}: make each a feature of its "
            "own and name one with --feature"
        )


def _features(path: Path) -> tuple[Feature, ...]:
    """Return what a GeoJSON file holds, or the polygons of a KML, a Shapefile or the like."""
    data = read_bounded(path, LARGEST_IMPORT_BYTES, f"a file with a region: {FORMATS}")
    if is_json(data) or path.suffix.lower() in (".geojson", ".json"):
        return read_features(path)
    found = read_import(path.name, data)
    polygons = tuple(
        Feature(f"{path}: feature {number}", number, {"name": each.name or None}, each.geometry)
        for number, each in enumerate(found.features, start=1)
        if each.geometry["type"] != "Point"
    )
    if not polygons:
        raise RegionFileError(f"{path}: expected a polygon, got points alone")
    return polygons


def _chosen(path: Path, name: str | None) -> Feature:
    features = _features(path)
    named = [each for each in features if name is None or _name(each) == name]
    if len(named) == 1:
        return named[0]
    known = ", ".join(ascii(_name(each) or f"feature {each.number}") for each in features) or "none"
    if name is None:
        raise RegionFileError(
            f"{path}: expected one feature, got {len(features)}: name one with --feature ({known})"
        )
    raise RegionFileError(
        f"{path}: expected one feature named {name!a}, got {len(named)}; features: {known}"
    )


def _name(feature: Feature) -> str | None:
    name = feature.properties.get("name")
    return name if isinstance(name, str) else None


def _rings(feature: Feature) -> Rings:
    """Return longitude and latitude only; a region has no heights."""
    coordinates: Any = feature.geometry["coordinates"]
    polygon = coordinates if feature.geometry["type"] == "Polygon" else coordinates[0]
    return [[position[:2] for position in ring] for ring in polygon]
