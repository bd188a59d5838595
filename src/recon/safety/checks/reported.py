"""Checks of what an app reports of its aircraft's settings, against the site and what is planned.

A point without a report is no point of the list: a plain app's checklist is as long as it was.
"""

from recon.geo.distance import horizontal_distance_m
from recon.model.vehicle import VehicleState
from recon.safety.check import Check, Point
from recon.safety.datum import NEAR_PAD_M, home
from recon.safety.reported_facts import reported_facts
from recon.safety.situation import Situation

HOME_POINT = Point("home_point", "Aircraft's home point")
LIMITS = Point("aircraft_limits", "Aircraft's limits")
STORAGE = Point("storage", "Photo storage")
DJI_CHECK = Point("dji_check", "App's check with DJI")


def home_point(vehicle: VehicleState, situation: Situation) -> Check | None:
    """The home point in the aircraft is where it takes off; DJI sets it at each takeoff."""
    stated = reported_facts(vehicle, situation.now_ns).home
    expected = home(vehicle)
    if stated is None:
        return None
    if expected is None:
        return HOME_POINT.attention(
            "compared with nothing: takeoff not observed, and no pad",
            "confirm the home point with the pilot",
        )
    off_m = horizontal_distance_m(stated, expected)
    if off_m <= NEAR_PAD_M:
        return HOME_POINT.ok(f"{off_m:.0f} m from where it takes off")
    if vehicle.is_flying.value is False:
        return HOME_POINT.attention(
            f"{off_m:.0f} m from the aircraft, until it takes off",
            "see that the aircraft records a new home point at its takeoff",
        )
    return HOME_POINT.fails(
        f"{off_m:.0f} m from where it took off: a return ends there",
        "set the home point on its controller to where it took off",
    )


def aircraft_limits(vehicle: VehicleState, situation: Situation) -> Check | None:
    """The aircraft's own limits allow what is planned; DJI rejects what exceeds them silently."""
    facts, plan = reported_facts(vehicle, situation.now_ns), situation.facts.planned
    most_m, farthest_m = facts.max_height_m, facts.max_distance_m
    if most_m is None and farthest_m is None:
        return None
    if most_m is not None and plan.highest_m is not None and plan.highest_m > most_m:
        return LIMITS.fails(
            f"maximum height is {most_m:g} m above takeoff; the survey is flown at up to "
            f"{plan.highest_m:g} m",
            "set a greater maximum height on its controller, or survey lower",
        )
    height = "" if most_m is None else f"up to {most_m:g} m above takeoff"
    distance = "" if farthest_m is None else f"up to {farthest_m:g} m from home"
    return LIMITS.ok(", ".join(part for part in (height, distance) if part))


def storage(vehicle: VehicleState, situation: Situation) -> Check | None:
    """The photos that are planned fit where they are stored."""
    left = reported_facts(vehicle, situation.now_ns).storage_left_photos
    if left is None:
        return None
    wanted = situation.facts.planned.photos
    if wanted is not None and left < wanted:
        return STORAGE.fails(
            f"has room for {left} photos; the survey takes about {wanted} more",
            "empty the card, or change it",
        )
    return STORAGE.ok(f"has room for {left} photos")


def dji_check(vehicle: VehicleState, situation: Situation) -> Check | None:
    """The app's check with DJI has passed."""
    facts = reported_facts(vehicle, situation.now_ns)
    answer = facts.dji_check or "no reason given"
    if facts.dji_check_passed is None:
        return None
    if facts.dji_check_passed:
        return DJI_CHECK.ok("passed")
    return DJI_CHECK.fails(f"failed: {answer}", "see the app's screen")
