"""Shapes of another coordinate reference system on WGS84, and how accurate that is."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

from recon.fields.shape import FieldFileError, Found, Position, Shape

WARN_FROM_M = 1.0


def to_globe(found: Found, crs: str) -> Found:
    """Return shapes in degrees of WGS84, with warnings about their accuracy.

    Raises `FieldFileError` for a system that nobody knows.
    """
    from recon.geo.datum import UnknownDatumError, path_to_wgs84

    corners = [place for shape in found.shapes for ring in shape.rings for place in ring]
    try:
        path = path_to_wgs84(crs, corners)
    except UnknownDatumError as problem:
        raise FieldFileError(str(problem)) from problem
    moved = iter(path.to_globe(corners))
    shapes = [replace(shape, rings=_regrouped(shape, moved)) for shape in found.shapes]
    warnings = list(found.warnings)
    if path.accuracy_m is None:
        warnings.append(
            f"{path.name}: no transformation to WGS84 is known; shapes may be off by 100 m and "
            "more, and cannot become fences: export the file as WGS84 (EPSG:4326)"
        )
    elif path.accuracy_m > WARN_FROM_M:
        warnings.append(
            f"{path.name}: the transformation to WGS84 is accurate to {path.accuracy_m:g} m "
            f"({path.description}); exported as WGS84 (EPSG:4326) by a program with its grids, "
            "shapes are where they belong"
        )
    return replace(
        found, shapes=shapes, warnings=warnings, is_fit_for_fences=path.accuracy_m is not None
    )


def _regrouped(shape: Shape, places: Iterator[Position]) -> list[list[Position]]:
    return [list(islice(places, len(ring))) for ring in shape.rings]
