"""The process that reads an imported file: `python import_process.py FILE FEATURES CORNERS ALL`.

It is run as a script, so that its limits are set before anything else is loaded: it imports nothing
of ours. It prints one JSON object: the features, at most FEATURES of CORNERS each and ALL together,
or the problem.
"""

import json
import math
import os
import sys
from collections.abc import Iterator
from typing import Any

MOST_MEMORY_BYTES = 2 * 1024**3
"""Limit of address space: GDAL, PROJ and numpy map 1 GiB before a file is read."""
MOST_CPU_S = 15
MOST_LAYERS = 20
DRIVERS = frozenset({"KML", "LIBKML", "ESRI Shapefile", "GPKG", "GeoJSON"})
"""GDAL has many more, of which some read other files or the network when a file asks for it."""
DECIMALS = 8
"""Decimals of a degree: a millimetre."""


class ImportedFileError(Exception):
    """What is wrong with the file, as the end of a sentence that begins with its name."""


def main() -> None:
    """Read the file named on the command line."""
    _limit_itself()
    try:
        path, *most = sys.argv[1:]
        answer = _read(path, *(int(number) for number in most))
    except ImportedFileError as problem:
        answer = {"problem": str(problem)}
    except MemoryError:
        answer = {"problem": "expected a file that fits into memory, got a larger one"}
    json.dump(answer, sys.stdout)


def _limit_itself() -> None:
    # One thread each: their stacks would count as memory.
    os.environ.update(OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1", GDAL_NUM_THREADS="1")
    # Nothing is fetched, whatever a file names.
    os.environ.update(CPL_VSIL_CURL_ALLOWED_EXTENSIONS="{none}", PROJ_NETWORK="OFF")
    # A GeoPackage's own SQL functions and extensions stay off.
    os.environ.update(OGR_SQLITE_LOAD_EXTENSIONS="", OGR_GPKG_FOREIGN_KEY_CHECK="NO")
    if hasattr(os, "nice"):
        os.nice(10)  # The station is more urgent.
    try:
        import resource
    except ImportError:
        return  # Not on Windows: the time limit of the station remains.
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY_BYTES, MOST_MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_CPU_S, MOST_CPU_S + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _leave_out_other_drivers() -> None:
    import pyogrio

    others = set(pyogrio.list_drivers()) - DRIVERS
    pyogrio.set_gdal_config_options({"GDAL_SKIP": ",".join(sorted(others))})
    pyogrio._ogr._register_drivers()
    if set(pyogrio.list_drivers()) - DRIVERS:
        raise RuntimeError("expected GDAL with the drivers of imports only, got others too")


def _read(path: str, most_features: int, most_corners: int, most_in_all: int) -> dict[str, Any]:
    import pyogrio

    _leave_out_other_drivers()
    try:
        layers = [str(name) for name, kind in pyogrio.list_layers(path) if kind is not None]
    except Exception as problem:
        raise ImportedFileError("expected a file that GDAL reads, got a damaged one") from problem
    if len(layers) > MOST_LAYERS:
        raise ImportedFileError(f"expected at most {MOST_LAYERS} layers, got {len(layers)}")
    features: list[dict[str, Any]] = []
    excluded = corners = 0
    for layer in layers:
        for name, geometry in _layer(path, layer, most_features):
            if geometry is None:
                excluded += 1
                continue
            if len(features) == most_features:
                raise ImportedFileError(f"expected at most {most_features} features, got more")
            corners += _checked_corners(geometry, most_corners)
            if corners > most_in_all:
                raise ImportedFileError(
                    f"expected at most {most_in_all} corners in all features, got more; export the "
                    "field only, or simplify the shapes"
                )
            features.append({"name": name, "geometry": geometry})
    return {"features": features, "excluded": excluded}


def _layer(
    path: str, layer: str, most_features: int
) -> Iterator[tuple[str, dict[str, Any] | None]]:
    import pyogrio.raw
    import shapely

    try:
        meta, _fids, shapes, columns = pyogrio.raw.read(
            path, layer=layer, force_2d=True, max_features=most_features + 1
        )
        geometries = shapely.from_wkb(shapes)
    except Exception as problem:
        raise ImportedFileError("expected a file that GDAL reads, got a damaged one") from problem
    geometries = _to_wgs84(meta.get("crs"), geometries)
    names = _names(list(meta["fields"]), columns, len(geometries))
    for name, geometry in zip(names, geometries, strict=True):
        yield from ((name, shape) for shape in _shapes(geometry))


def _names(fields: list[str], columns: list[Any], count: int) -> list[str]:
    """Return the attribute called name, in any case; empty texts without one."""
    for field, column in zip(fields, columns, strict=True):
        if field.lower() == "name":
            return ["" if value is None else str(value)[:200] for value in column]
    return [""] * count


def _to_wgs84(crs: str | None, geometries: Any) -> Any:
    import numpy as np
    import pyproj
    import shapely

    if crs is None:
        raise ImportedFileError("expected a coordinate reference system in the file, got none")
    try:
        known = pyproj.CRS.from_user_input(crs)
        to_degrees = pyproj.Transformer.from_crs(known, "EPSG:4326", always_xy=True)
    except pyproj.exceptions.ProjError as problem:
        raise ImportedFileError(
            "expected a known coordinate reference system, got another"
        ) from problem

    def moved(points: Any) -> Any:
        return np.column_stack(to_degrees.transform(points[:, 0], points[:, 1]))

    return shapely.transform(geometries, moved)


def _shapes(geometry: Any) -> Iterator[dict[str, Any] | None]:
    """Yield each polygon and point of a geometry as GeoJSON; None for anything else."""
    if geometry is None or geometry.is_empty:
        return
    kind = geometry.geom_type
    if kind in ("MultiPolygon", "MultiPoint", "GeometryCollection"):
        for part in geometry.geoms:
            yield from _shapes(part)
    elif kind == "Polygon":
        rings = (geometry.exterior, *geometry.interiors)
        yield {"type": "Polygon", "coordinates": [_positions(ring.coords) for ring in rings]}
    elif kind == "Point":
        yield {"type": "Point", "coordinates": _positions(geometry.coords)[0]}
    else:
        yield None


def _positions(points: Any) -> list[list[float]]:
    return [[round(float(x), DECIMALS), round(float(y), DECIMALS)] for x, y, *_ in points]


def _checked_corners(geometry: dict[str, Any], most_corners: int) -> int:
    coordinates = geometry["coordinates"]
    rings = coordinates if geometry["type"] == "Polygon" else [[coordinates]]
    corners = [position for ring in rings for position in ring]
    if len(corners) > most_corners:
        raise ImportedFileError(f"expected at most {most_corners} corners, got {len(corners)}")
    if not all(math.isfinite(number) for position in corners for number in position):
        raise ImportedFileError("expected coordinates on the globe, got others")
    return len(corners)


if __name__ == "__main__":
    main()
