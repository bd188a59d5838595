"""One region to survey from a file, checked before any request to the station."""

from pathlib import Path
from typing import Any

from recon.cli.output import print_warning
from recon.client import ClientError
from recon.fields.choice import chosen_features, listed
from recon.fields.field_file import FORMATS, ImportedFeature, read_import
from recon.fields.limits import LARGEST_FILE_BYTES
from recon.model.airspace import Region
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint, LocalFrame
from recon.site.geojson import Feature, regions_of
from recon.site.reading import read_bounded

Rings = list[list[list[float]]]


class RegionFileError(ClientError):
    """Not a region to survey; the text names the file, the feature and the reason."""


def read_region(
    path: Path, feature: str | None, origin: GeoPoint, *, close_paths: bool = False
) -> tuple[str, Rings]:
    """Return the name and the rings of the one region in a file, or of the feature of that name.

    Raises `RegionFileError`, also for a region far from `origin`, the site's.
    """
    chosen = _chosen(path, feature, close_paths=close_paths)
    try:
        regions_of(chosen, LocalFrame(origin))
    except SiteError as problem:
        raise RegionFileError(str(problem)) from problem
    rings: Any = chosen.geometry["coordinates"]
    return _name(chosen) or path.stem, rings


def region_in(
    path: Path, feature: str | None, site_frame: LocalFrame | None, *, close_paths: bool = False
) -> tuple[str, Region, LocalFrame]:
    """Return the name of the one region in a file, and the region in metres of a frame.

    Without a site's frame its own has the region's first corner as origin. Raises
    `RegionFileError`.
    """
    chosen = _chosen(path, feature, close_paths=close_paths)
    try:
        frame = site_frame or LocalFrame(_first_corner(chosen))
        (region,) = regions_of(chosen, frame)
    except SiteError as problem:
        raise RegionFileError(str(problem)) from problem
    return _name(chosen) or path.stem, region, frame


def _first_corner(chosen: Feature) -> GeoPoint:
    longitude_deg, latitude_deg = chosen.geometry["coordinates"][0][0][:2]
    return GeoPoint(latitude_deg, longitude_deg, 0.0)


def _chosen(path: Path, name: str | None, *, close_paths: bool) -> Feature:
    try:
        data = read_bounded(path, LARGEST_FILE_BYTES, f"a file with a region: {FORMATS}")
        found = read_import(path.name, data, close_paths=close_paths)
        features = chosen_features(path, found, None if name is None else [name])
    except SiteError as problem:
        raise RegionFileError(str(problem)) from problem
    for warning in (*found.warnings, *(f"excluded: {each}" for each in found.excluded)):
        print_warning(warning)
    polygons = [each for each in features if each.geometry["type"] == "Polygon"]
    if not polygons:
        raise RegionFileError(f"{path}: expected a polygon, got points alone")
    if len(polygons) > 1:
        raise RegionFileError(
            f"{path}: expected one region, got {len(polygons)}: choose one with --feature "
            f"({listed(found, polygons)})"
        )
    return _feature(path, polygons[0])


def _feature(path: Path, polygon: ImportedFeature) -> Feature:
    place = f"{path}: {polygon.name!a}" if polygon.name else str(path)
    return Feature(place, 1, {"name": polygon.name or None}, polygon.geometry)


def _name(feature: Feature) -> str | None:
    name: str | None = feature.properties["name"]
    return name
