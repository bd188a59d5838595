"""Mission Planner's .waypoints: `QGC WPL 110`, a line of twelve columns for each MAVLink item."""

from recon.plans.flight_plan import ExportedPlan
from recon.plans.mavlink_items import WAYPOINT, MissionItem, after_rows, before_rows, rows

HEADER = "QGC WPL 110"
ABSOLUTE, ABOVE_HOME = 0, 3
"""MAV_FRAME: above sea level, and above home."""


def waypoints_of(plan: ExportedPlan) -> bytes:
    """Return the file of a flight.

    Line 0 is home; the autopilot puts the place where it arms there. Its height is written as 0.
    """
    items = [*before_rows(plan), *rows(plan, plan.photos), *after_rows(plan)]
    at = plan.takeoff or plan.waypoints[0]
    lines = [
        _line(0, ABSOLUTE, MissionItem(WAYPOINT, place=(at.latitude_deg, at.longitude_deg, 0.0)))
    ]
    lines += [_line(number, ABOVE_HOME, item) for number, item in enumerate(items, start=1)]
    return "\n".join([HEADER, *lines, ""]).encode("ascii")


def _line(number: int, frame: int, item: MissionItem) -> str:
    latitude, longitude, height = item.place
    columns = (
        *(number, int(number == 0), frame, item.command),
        *(f"{each:.8f}" for each in item.parameters),
        *(f"{latitude:.8f}", f"{longitude:.8f}", f"{height:.6f}", 1),
    )
    return "\t".join(map(str, columns))
