"""GPX 1.1: each flight as a route. `ele` would be a height above the sea, so none is written."""

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from recon.plans.flight_plan import ExportedPlan, shown

GPX = "http://www.topografix.com/GPX/1/1"


def gpx_of(plans: Sequence[ExportedPlan]) -> bytes:
    """Return one document with all flights."""
    root = Element("gpx", {"xmlns": GPX, "version": "1.1", "creator": "Recon"})
    for number, plan in enumerate(plans, start=1):
        route = SubElement(root, "rte")
        SubElement(route, "name").text = shown(plan.name)
        SubElement(route, "number").text = f"{number}"
        for index, each in enumerate(plan.waypoints, start=1):
            place = {"lat": f"{each.latitude_deg:.8f}", "lon": f"{each.longitude_deg:.8f}"}
            point = SubElement(route, "rtept", place)
            SubElement(point, "name").text = f"{index}"
    indent(root)
    data: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return data
