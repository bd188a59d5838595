"""QGroundControl's .plan: a plain mission, or its survey item.

Versions are those that QGroundControl 4.3 to 5 write: plan 1, mission 2, fence and rally points 2,
survey 5, transects 2, camera 2. A fence of another version would be read as none.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import ceil
from typing import Any

from recon.geo.distance import horizontal_distance_m
from recon.geo.local_frame import OnGlobe
from recon.plans.flight_plan import ExportedPlan, PhotoTrigger, PlanExportError
from recon.plans.mavlink_items import TAKEOFF, MissionItem, after_rows, before_rows, rows

ABOVE_HOME, NO_PLACE = 3, 2
"""MAV_FRAME: above home, and that of commands without a place."""
RELATIVE = 1
"""QGroundControl's altitude mode: relative to launch."""
PX4, MULTIROTOR = 12, 2
MANUAL_CAMERA = "Manual (no camera specs)"


def qgc_mission(plan: ExportedPlan) -> bytes:
    """Return the plan of a flight as plain mission items."""
    items = (*before_rows(plan), *rows(plan, plan.photos), *after_rows(plan))
    return _plan(plan, list(_simple(items, 1)))


def qgc_survey(plan: ExportedPlan) -> bytes:
    """Return the plan of a flight with its rows as a survey item, which may be edited there.

    The item keeps the rows as they are until it is edited. Its photos are by distance. Raises
    `PlanExportError` for rows that are not one area.
    """
    ground = plan.ground
    if ground is None or len(ground.rings) != 1:
        areas = 0 if ground is None else len(ground.rings)
        raise PlanExportError(
            f"{plan.name}: a survey item has one area, and these rows are {areas}: write .plan"
        )
    photos = PhotoTrigger(every_m=ground.photo_m)
    before = list(_simple(before_rows(plan), 1))
    inside = list(_simple(rows(plan, photos), len(before) + 1))
    after = _simple(after_rows(plan), len(before) + len(inside) + 1)
    item = {
        "type": "ComplexItem",
        "complexItemType": "survey",
        "version": 5,
        "angle": round(ground.bearing_deg, 3),
        "entryLocation": 0,
        "flyAlternateTransects": False,
        "splitConcavePolygons": False,
        "polygon": [_lat_lon(corner) for corner in ground.rings[0]],
        "TransectStyleComplexItem": {
            "version": 2,
            "CameraCalc": {
                "version": 2,
                "CameraName": MANUAL_CAMERA,
                "DistanceMode": RELATIVE,
                "DistanceToSurface": plan.waypoints[0].height_above_takeoff_m,
                "AdjustedFootprintFrontal": ground.photo_m,
                "AdjustedFootprintSide": ground.row_m,
            },
            "CameraShots": ceil(_length_m(plan) / ground.photo_m) + 1,
            "CameraTriggerInTurnAround": True,
            "HoverAndCapture": False,
            "Refly90Degrees": False,
            "TurnAroundDistance": 0,
            "VisualTransectPoints": [_lat_lon(each) for each in plan.waypoints],
            "Items": inside,
        },
    }
    return _plan(plan, [*before, item, *after])


def _plan(plan: ExportedPlan, items: Sequence[dict[str, Any]]) -> bytes:
    home = plan.takeoff or plan.waypoints[0]
    speed_mps = plan.waypoints[0].speed_mps
    document = {
        "fileType": "Plan",
        "version": 1,
        "groundStation": "QGroundControl",
        "mission": {
            "version": 2,
            "firmwareType": PX4,
            "vehicleType": MULTIROTOR,
            "globalPlanAltitudeMode": RELATIVE,
            "cruiseSpeed": speed_mps,
            "hoverSpeed": speed_mps,
            # Its height above the sea is not known; the autopilot puts home where it arms.
            "plannedHomePosition": [*_lat_lon(home), 0],
            "items": items,
        },
        "geoFence": {"version": 2, "polygons": [], "circles": []},
        "rallyPoints": {"version": 2, "points": []},
    }
    return json.dumps(document, indent=1, allow_nan=False).encode("ascii")


def _simple(items: Iterable[MissionItem], first_number: int) -> Iterator[dict[str, Any]]:
    for number, item in enumerate(items, start=first_number):
        common = {
            "type": "SimpleItem",
            "autoContinue": True,
            "command": item.command,
            "doJumpId": number,
            "frame": ABOVE_HOME if item.has_place else NO_PLACE,
            "params": _parameters(item),
        }
        if item.has_place:
            common["AMSLAltAboveTerrain"] = None
            common["Altitude"], common["AltitudeMode"] = item.place[2], RELATIVE
        yield common


def _parameters(item: MissionItem) -> list[float | None]:
    """Null is "as it is": an aircraft takes off where it stands, and keeps its own yaw rule."""
    if not item.has_place:
        return [*item.parameters, *item.place]
    latitude_deg, longitude_deg, height_m = item.place
    stands = item.command == TAKEOFF
    place = (None, None) if stands else (round(latitude_deg, 8), round(longitude_deg, 8))
    return [*item.parameters[:3], None, *place, height_m]


def _lat_lon(place: OnGlobe) -> list[float]:
    return [round(place.latitude_deg, 8), round(place.longitude_deg, 8)]


def _length_m(plan: ExportedPlan) -> float:
    return sum(horizontal_distance_m(a, b) for a, b in pairwise(plan.waypoints))
