"""Whether a polygon is one: its edges do not cross."""

from collections.abc import Mapping
from typing import Any

from recon.geo.polygon import fault_words


def fault_of(geometry: Mapping[str, Any]) -> str | None:
    """Return what is wrong with a GeoJSON polygon or point in degrees, and where; else None."""
    if geometry["type"] != "Polygon":
        return None
    import shapely

    outline, *holes = geometry["coordinates"]
    # GEOS appends the position in brackets.
    reason, _, place = str(shapely.is_valid_reason(shapely.Polygon(outline, holes))).partition("[")
    if reason == "Valid Geometry":
        return None
    where = place.rstrip("]").split()
    at = f" at longitude {float(where[0]):.6f}, latitude {float(where[1]):.6f}" if where else ""
    return f"{fault_words(reason)}{at}: mend it in the program that drew it"
