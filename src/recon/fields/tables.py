"""Shapefiles and GeoPackages, by GDAL with these drivers alone."""

from functools import cache
from typing import Any

from recon.fields.names import name_column
from recon.fields.projection import to_globe
from recon.fields.shape import FieldFileError, Found
from recon.model.extras import from_extra

DRIVERS = frozenset({"ESRI Shapefile", "GPKG"})
"""GDAL has many more, of which some read other files or the network when a file asks for it."""
MOST_LAYERS = 200


def read_tables(path: str, most_features: int) -> Found:
    """Return the shapes of all layers. Raises `FieldFileError`."""
    with from_extra("imports", "a Shapefile or GeoPackage", FieldFileError):
        import pyogrio

    _leave_out_other_drivers()
    try:
        layers = [str(name) for name, kind in pyogrio.list_layers(path) if kind is not None]
    except Exception as problem:
        raise FieldFileError("expected a file that GDAL reads, got a damaged one") from problem
    if len(layers) > MOST_LAYERS:
        raise FieldFileError(f"expected at most {MOST_LAYERS} layers, got {len(layers)}")
    found = Found()
    for layer in layers:
        found.extend(_read_layer(path, layer, most_features))
    return found


@cache
def _leave_out_other_drivers() -> None:
    import pyogrio

    others = set(pyogrio.list_drivers()) - DRIVERS
    pyogrio.set_gdal_config_options({"GDAL_SKIP": ",".join(sorted(others))})
    pyogrio._ogr._register_drivers()
    if set(pyogrio.list_drivers()) - DRIVERS:
        raise RuntimeError("expected GDAL with the drivers of imports only, got others too")


def _read_layer(path: str, layer: str, most_features: int) -> Found:
    import pyogrio.raw
    import shapely

    try:
        meta, _fids, wkb, columns = pyogrio.raw.read(
            path, layer=layer, force_2d=True, max_features=most_features + 1
        )
    except Exception as problem:
        raise FieldFileError("expected a file that GDAL reads, got a damaged one") from problem
    found = Found()
    names = _names(list(meta["fields"]), columns, len(wkb))
    # One odd shape is left out, and not the whole layer with it.
    shapes = shapely.from_wkb(wkb, on_invalid="ignore")
    for number, (name, shape) in enumerate(zip(names, shapes, strict=True), start=1):
        found.begin_feature()
        if shape is None or shape.is_empty:
            found.exclude(name or f"row {number} of {layer}", "no shape")
        else:
            _add(shape, name, found)
    if not found.shapes:
        return found
    if meta.get("crs") is None:
        raise FieldFileError("expected a coordinate reference system in the file, got none")
    return to_globe(found, str(meta["crs"]))


def _names(fields: list[str], columns: list[Any], count: int) -> list[str]:
    is_text = [column.dtype == object for column in columns]
    chosen = name_column(fields, is_text)
    values = [None] * count if chosen is None else columns[chosen]
    return ["" if value is None else str(value) for value in values]


def _add(shape: Any, name: str, found: Found) -> None:
    match shape.geom_type:
        case "MultiPolygon" | "MultiPoint" | "MultiLineString" | "GeometryCollection":
            for part in shape.geoms:
                _add(part, name, found)
        case "Polygon":
            rings = (shape.exterior, *shape.interiors)
            found.add(name, "polygon", [list(ring.coords) for ring in rings])
        case "LineString":
            found.add(name, "path", [list(shape.coords)])
        case "LinearRing":
            found.add(name, "polygon", [list(shape.coords)])
        case "Point":
            found.add(name, "point", [list(shape.coords)])
        case other:
            found.exclude(name, f"a {other}")
