"""KML, and DJI's WPML, which is KML with elements of its own.

Read here and not by GDAL, which keeps the last of several holes that Google Earth writes into one
`innerBoundaryIs`, makes a field of a picture's frame, and fails for a whole file at one odd shape.
"""

import re
from collections.abc import Collection, Iterator
from pathlib import PurePosixPath
from xml.etree.ElementTree import Element

from recon.fields.names import name_among
from recon.fields.shape import Found, Kind, Position
from recon.fields.xml_tree import child_text, children, local

PICTURES = frozenset({"GroundOverlay", "PhotoOverlay", "ScreenOverlay"})
CONTAINERS = frozenset({"kml", "Document", "Folder"})
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_POSITION = re.compile(rf"({_NUMBER})\s*,\s*({_NUMBER})(?:\s*,\s*{_NUMBER})?")


def read_kml(root: Element, documents: Collection[str] = ()) -> Found:
    """Return the shapes of a document; `documents` are the others of its archive, read as well."""
    found = Found()
    _read_container(root, "", {PurePosixPath(each).name for each in documents}, found)
    return found


def _read_container(container: Element, folder: str, documents: set[str], found: Found) -> None:
    waypoints: list[Position] = []
    for element in container:
        kind = local(element)
        name = child_text(element, "name")
        if kind in CONTAINERS:
            _read_container(element, name.strip() or folder, documents, found)
        elif kind == "Placemark":
            if children(element, "index") and children(element, "Point"):
                waypoints += _positions(children(element, "Point")[0])
            else:
                _read_placemark(element, folder, found)
        elif kind in PICTURES:
            found.exclude(name, "a picture laid on the map")
        elif kind == "NetworkLink" and _target(element) not in documents:
            found.exclude(name, "a link to another file: open that one, and export it")
    if waypoints:
        found.begin_feature()
        found.add(folder or "waypoints", "path", [waypoints])


def _target(link: Element) -> str:
    href = next((each.text or "" for each in link.iter() if local(each) == "href"), "")
    return PurePosixPath(href.strip()).name


def _read_placemark(placemark: Element, folder: str, found: Found) -> None:
    name = child_text(placemark, "name").strip() or name_among(_attributes(placemark)) or folder
    found.begin_feature()
    before = len(found.shapes), len(found.excluded)
    for element in placemark:
        _read_geometry(element, name, found)
    if before == (len(found.shapes), len(found.excluded)):
        found.exclude(name, "no shape")


def _attributes(placemark: Element) -> dict[str, str]:
    """Return the attributes of a table that was exported as KML."""
    found: dict[str, str] = {}
    for element in placemark.iter():
        if local(element) == "SimpleData":
            found[element.get("name", "")] = element.text or ""
        elif local(element) == "Data":
            found[element.get("name", "")] = child_text(element, "value")
    return found


def _read_geometry(element: Element, name: str, found: Found) -> None:
    match local(element):
        case "MultiGeometry" | "MultiTrack":
            for part in element:
                _read_geometry(part, name, found)
        case "Polygon":
            _read_polygon(element, name, found)
        case "LinearRing":
            _add(name, "polygon", [element], found)
        case "LineString":
            _add(name, "path", [element], found)
        case "Point":
            _add(name, "point", [element], found)
        case "Track":
            found.add(name, "path", [list(_track(element))])
        case "Model":
            found.exclude(name, "a 3D model")


def _read_polygon(polygon: Element, name: str, found: Found) -> None:
    """Any number of rings may be in any number of `innerBoundaryIs`."""
    outer, inner = (
        [ring for side in children(polygon, kind) for ring in children(side, "LinearRing")]
        for kind in ("outerBoundaryIs", "innerBoundaryIs")
    )
    if len(outer) != 1:
        found.exclude(name, f"a polygon with {len(outer)} outer rings: one is expected")
        return
    _add(name, "polygon", [*outer, *inner], found)


def _add(name: str, kind: Kind, elements: list[Element], found: Found) -> None:
    rings = [_positions(element) for element in elements]
    if not all(rings):
        found.exclude(name, "coordinates that cannot be read")
    else:
        found.add(name, kind, rings)


def _positions(element: Element) -> list[Position]:
    """Return an element's positions; none where anything in the text is not one."""
    text = child_text(element, "coordinates")
    positions: list[Position] = []
    at = 0
    for found in _POSITION.finditer(text):
        if text[at : found.start()].strip(" \t\r\n,;"):
            return []
        positions.append((float(found[1]), float(found[2])))
        at = found.end()
    return [] if text[at:].strip(" \t\r\n,;") else positions


def _track(element: Element) -> Iterator[Position]:
    for each in element:
        words = (each.text or "").split() if local(each) == "coord" else []
        try:
            yield float(words[0]), float(words[1])
        except (IndexError, ValueError):
            continue
