"""Litchi's CSV, as its Mission Hub imports it: one row for each waypoint.

A column that is not set is -1, as Litchi exports it. `altitudemode` 0 is above takeoff.
"""

import csv
import io
from math import atan2, degrees

from recon.geo.distance import offset_north_east_m
from recon.plans.flight_plan import ExportedPlan

MOST_ACTIONS = 15
MOST_WAYPOINTS = 99
STAY = 0
"""Action 0 stays for its parameter, in milliseconds."""
INTERPOLATED, ABOVE_TAKEOFF, UNSET = 2, 0, -1
COLUMNS = (
    *("latitude", "longitude", "altitude(m)", "heading(deg)", "curvesize(m)", "rotationdir"),
    *("gimbalmode", "gimbalpitchangle"),
    *(f"action{what}{n}" for n in range(1, MOST_ACTIONS + 1) for what in ("type", "param")),
    *("altitudemode", "speed(m/s)", "poi_latitude", "poi_longitude", "poi_altitude(m)"),
    *("poi_altitudemode", "photo_timeinterval", "photo_distinterval"),
)


def litchi_csv(plan: ExportedPlan) -> bytes:
    """Return the file of a flight."""
    out = io.StringIO()
    table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
    table.writeheader()
    pitch_deg: float | None = None
    for index, each in enumerate(plan.waypoints):
        pitch_deg = pitch_deg if each.gimbal_pitch_deg is None else each.gimbal_pitch_deg
        is_inner = 0 < index < len(plan.waypoints) - 1
        table.writerow(
            {
                **_nothing(),
                "latitude": f"{each.latitude_deg:.8f}",
                "longitude": f"{each.longitude_deg:.8f}",
                "altitude(m)": f"{each.height_above_takeoff_m:.3f}",
                "heading(deg)": f"{_course_deg(plan, index):.1f}",
                "curvesize(m)": f"{each.corner_radius_m if plan.curved and is_inner else 0.0:.3f}",
                "gimbalmode": 0 if pitch_deg is None else INTERPOLATED,
                "gimbalpitchangle": f"{pitch_deg or 0.0:.1f}",
                "speed(m/s)": f"{each.speed_mps:.3f}",
                **_stay(each.loiter_s),
                **_photos(plan),
            }
        )
    return out.getvalue().encode("ascii")


def _nothing() -> dict[str, object]:
    """Return a row in which nothing happens."""
    actions = {c: UNSET if "type" in c else 0 for c in COLUMNS if c.startswith("action")}
    others = {"rotationdir": 0, "altitudemode": ABOVE_TAKEOFF, "poi_altitudemode": 0}
    places = dict.fromkeys(("poi_latitude", "poi_longitude", "poi_altitude(m)"), 0)
    return {**actions, **others, **places}


def _stay(loiter_s: float | None) -> dict[str, object]:
    if not loiter_s:
        return {}
    return {"actiontype1": STAY, "actionparam1": round(1_000.0 * loiter_s)}


def _photos(plan: ExportedPlan) -> dict[str, object]:
    photos = plan.photos
    every_s, every_m = (None, None) if photos is None else (photos.every_s, photos.every_m)
    return {
        "photo_timeinterval": UNSET if every_s is None else f"{every_s:.1f}",
        "photo_distinterval": UNSET if every_m is None else f"{every_m:.1f}",
    }


def _course_deg(plan: ExportedPlan, index: int) -> float:
    """Return the course to the next waypoint, 0 to 360; at the last one that of the last leg."""
    first = min(index, len(plan.waypoints) - 2)
    start, end = plan.waypoints[first], plan.waypoints[first + 1]
    north_m, east_m = offset_north_east_m(start, end)
    return degrees(atan2(east_m, north_m)) % 360.0
