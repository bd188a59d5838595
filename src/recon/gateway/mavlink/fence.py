"""The site's boundary and zones as items of a fence.

MAVLink's fences have no heights and no holes. So a keep-out zone is shown at every height, though
it may be flown over; holes of a zone are shown as filled; height zones, which limit heights only,
are not shown. What is shown is a picture of the gate's rules: the gate judges by the site.
"""

from collections.abc import Iterable, Sequence
from typing import Any

from recon.client.messages import TemporaryZoneStatus
from recon.client.site import SiteFeature
from recon.gateway.mavlink.dialect import mavlink
from recon.gateway.mavlink.telemetry import encoded_degrees

MAX_FENCE_ITEMS = 4000
_SHAPES = {
    "boundary": mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
    "keep_out": mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION,
}

Place = Sequence[float]
"""Longitude and latitude, degrees."""


class FenceTooLongError(ValueError):
    """A fence of more items than clients can be expected to take."""


def fence_items(
    features: Iterable[SiteFeature], zones: Iterable[TemporaryZoneStatus]
) -> tuple[Any, ...]:
    """Return the items of a fence; raises `FenceTooLongError`."""
    items: list[Any] = []
    for feature in features:
        command = _SHAPES.get(feature.layer)
        if command is not None:
            for ring in _outer_rings(feature):
                items += _corners(command, ring)
    for zone in zones:
        if zone.radius_m is None:
            items += _corners(_SHAPES["keep_out"], zone.ring)
        else:
            items.append(_circle(zone.ring, zone.radius_m))
    if len(items) > MAX_FENCE_ITEMS:
        raise FenceTooLongError(f"the fence has {len(items)} corners, more than {MAX_FENCE_ITEMS}")
    return tuple(items)


def _outer_rings(feature: SiteFeature) -> Iterable[Sequence[Place]]:
    shape = feature.geometry
    match shape["type"]:
        case "Polygon":
            yield shape["coordinates"][0]
        case "MultiPolygon":
            for part in shape["coordinates"]:
                yield part[0]


def _corners(command: int, ring: Sequence[Place]) -> list[Any]:
    corners = list(ring[:-1] if ring[0] == ring[-1] else ring)
    return [_item(command, len(corners), corner) for corner in corners]


def _circle(ring: Sequence[Place], radius_m: float) -> Any:
    corners = list(ring[:-1] if ring[0] == ring[-1] else ring)
    longitude_deg = sum(corner[0] for corner in corners) / len(corners)
    latitude_deg = sum(corner[1] for corner in corners) / len(corners)
    centre = (longitude_deg, latitude_deg)
    return _item(mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION, radius_m, centre)


def _item(command: int, param1: float, place: Place) -> Any:
    return mavlink.MAVLink_mission_item_int_message(
        *(0, 0, 0, mavlink.MAV_FRAME_GLOBAL_INT, command, 0, 1, param1, 0.0, 0.0, 0.0),
        *(encoded_degrees(place[1]), encoded_degrees(place[0]), 0.0),
        mavlink.MAV_MISSION_TYPE_FENCE,
    )
