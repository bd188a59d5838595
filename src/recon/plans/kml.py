"""KML: the path and the waypoints of each flight in its folder, for maps and as a drawing.

A KML height is above the ground under each place (`relativeToGround`), not above takeoff: plans
whose heights differ are refused before (`features`).
"""

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from recon.model.mission import Waypoint
from recon.plans.flight_plan import ExportedPlan, shown

KML = "http://www.opengis.net/kml/2.2"
COLOURS = ("ff2f6fde", "ffb8860b", "ff2e8b57", "ff8b3a8b", "ff3030c0", "ff808000")
"""Of the flights' paths in turn, as aabbggrr."""


def kml_of(plans: Sequence[ExportedPlan]) -> bytes:
    """Return one document with all flights."""
    root = Element("kml", {"xmlns": KML})
    document = SubElement(root, "Document")
    SubElement(document, "name").text = shown(plans[0].title)
    for number, plan in enumerate(plans):
        folder = SubElement(document, "Folder")
        SubElement(folder, "name").text = shown(plan.name)
        path = _placemark(folder, f"path of {shown(plan.name)}")
        style = SubElement(SubElement(path, "Style"), "LineStyle")
        SubElement(style, "color").text = COLOURS[number % len(COLOURS)]
        SubElement(style, "width").text = "3"
        _shape(path, "LineString", plan.waypoints)
        for index, waypoint in enumerate(plan.waypoints, start=1):
            _shape(_placemark(folder, f"{index}"), "Point", [waypoint])
    indent(root)
    data: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return data


def _placemark(folder: Element, name: str) -> Element:
    placemark = SubElement(folder, "Placemark")
    SubElement(placemark, "name").text = name
    return placemark


def _shape(placemark: Element, kind: str, waypoints: Sequence[Waypoint]) -> None:
    shape = SubElement(placemark, kind)
    SubElement(shape, "altitudeMode").text = "relativeToGround"
    SubElement(shape, "coordinates").text = " ".join(
        f"{each.longitude_deg:.8f},{each.latitude_deg:.8f},{each.height_above_takeoff_m:.3f}"
        for each in waypoints
    )
