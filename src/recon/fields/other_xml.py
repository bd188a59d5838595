"""GPX, as receivers and phones write tracks, and ISOXML, as farm terminals write their fields."""

from collections.abc import Iterable
from xml.etree.ElementTree import Element

from recon.fields.shape import Found, Position
from recon.fields.xml_tree import child_text, children, local

BOUNDARY, OUTER, INNER = "1", "1", "2"
"""ISO 11783-10: types of a PLN (polygon) and of its LSG (line strings)."""


def read_gpx(root: Element) -> Found:
    """Return tracks and routes as paths, waypoints as points."""
    found = Found()
    for element in root:
        name = child_text(element, "name")
        found.begin_feature()
        match local(element):
            case "trk":
                segments = children(element, "trkseg")
                for points in (_places(segment, "trkpt") for segment in segments):
                    found.add(name, "path", [points])
            case "rte":
                found.add(name, "path", [_places(element, "rtept")])
            case "wpt":
                found.add(name, "point", [_positions([element], "lon", "lat")])
    return found


def _places(element: Element, kind: str) -> list[Position]:
    return _positions(children(element, kind), "lon", "lat")


def read_isoxml(roots: Iterable[Element]) -> Found:
    """Return the boundaries of the partfields (PFD) in TASKDATA.XML and the files it names."""
    found = Found()
    for root in roots:
        for field in (each for each in root.iter() if local(each) == "PFD"):
            _read_field(field, found)
    return found


def _read_field(field: Element, found: Found) -> None:
    name = field.get("C", "").strip() or field.get("B", "").strip() or field.get("A", "")
    polygons = children(field, "PLN")
    found.begin_feature()
    for polygon in polygons:
        if polygon.get("A") == BOUNDARY:
            _read_boundary(polygon, name, found)
        else:
            found.exclude(polygon.get("B") or name, "an area of another kind than a boundary")
    if not polygons:
        found.exclude(name, "a field without a boundary")
    for kind, words in (("LSG", "a line"), ("PNT", "a point"), ("GGP", "guidance lines")):
        if count := len(children(field, kind)):
            found.exclude(name, f"{words} of the field ({count})")


def _read_boundary(polygon: Element, name: str, found: Found) -> None:
    """One PLN may hold several outer rings, each with the holes in it."""
    outer, inner = (
        [
            _positions(children(line, "PNT"), "D", "C")
            for line in children(polygon, "LSG")
            if line.get("A") == kind
        ]
        for kind in (OUTER, INNER)
    )
    if not outer:
        found.exclude(name, "a boundary without an outer ring")
    for ring in outer:
        holes = [each for each in inner if len(outer) == 1 or _starts_in(each, ring)]
        found.add(name, "polygon", [ring, *holes])


def _starts_in(inner: list[Position], outer: list[Position]) -> bool:
    """Return whether a ring's first corner lies inside another ring, by crossings of a ray."""
    if not inner:
        return False
    (x, y), is_inside = inner[0], False
    for (x1, y1), (x2, y2) in zip(outer, [*outer[1:], *outer[:1]], strict=True):
        if (y1 > y) != (y2 > y) and x < x1 + (y - y1) / (y2 - y1) * (x2 - x1):
            is_inside = not is_inside
    return is_inside


def _positions(points: Iterable[Element], longitude: str, latitude: str) -> list[Position]:
    """Return the positions in attributes; NaN for one that cannot be read excludes its shape."""
    found: list[Position] = []
    for each in points:
        try:
            found.append((float(each.get(longitude, "")), float(each.get(latitude, ""))))
        except ValueError:
            found.append((float("nan"), float("nan")))
    return found
