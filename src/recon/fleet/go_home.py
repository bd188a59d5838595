"""Follows a flight home by the aircraft's own go-home, in telemetry.

    none -- mode GO_HOME --> followed -- landing modes --> followed -- ground, other mode --> none

The ICD carries neither the go-home height nor the home point that are set in an aircraft. What is
followed here is what they can be judged by (`safety.go_home`).
"""

from math import hypot

from recon.fleet.airborne import LANDING_MODES
from recon.geo.distance import horizontal_distance_m
from recon.model.replacing import replace
from recon.model.units import ns_to_seconds
from recon.model.vehicle import FlightMode, GoHomeFlight, VehicleState

PROGRESS_M = 1.0
"""Least progress, in distance or height: less is noise of GNSS and barometer."""

LEVEL_MPS = 3.0
"""Ground speed from which it is under way: gusts and GNSS noise stay below."""
BRAKING_MPS2, SETTLES_S = 2.5, 2.0
"""Deceleration before it is under way, and a delay: a mode comes at 1 to 2 Hz."""


def fold_go_home(state: VehicleState, now_ns: int) -> GoHomeFlight | None:
    """Return the flight home after core telemetry received now; None when it does not go home."""
    mode, before = state.flight_mode.value, state.go_home
    if state.is_flying.value is False:
        return None
    if mode is not FlightMode.GO_HOME:
        return before if mode in LANDING_MODES else None
    far_m, height_m = _home_distance_m(state), state.height_above_takeoff_m.value
    if before is None:
        velocity = state.velocity_ned.value
        speed_mps = 0.0 if velocity is None else velocity.speed_mps
        return GoHomeFlight(now_ns, height_m, speed_mps, far_m, height_m, now_ns)
    is_nearer = _is_less(far_m, before.nearest_m)
    is_higher = _is_less(before.highest_m, height_m)
    if before.level_from is None and is_under_way(state, before, now_ns):
        before = replace(before, level_from=state.position.value)
    if not (is_nearer or is_higher):
        return before
    return replace(
        before,
        nearest_m=far_m if is_nearer else before.nearest_m,
        highest_m=height_m if is_higher else before.highest_m,
        progress_at_ns=now_ns,
    )


def is_under_way(state: VehicleState, flight: GoHomeFlight, now_ns: int) -> bool:
    """Return whether it flies home over the ground, having braked from its former flight."""
    velocity = state.velocity_ned.value
    if state.flight_mode.value is not FlightMode.GO_HOME or velocity is None:
        return False
    settles_s = flight.start_speed_mps / BRAKING_MPS2 + SETTLES_S
    has_settled = ns_to_seconds(now_ns - flight.since_ns) >= settles_s
    return has_settled and hypot(velocity.north_mps, velocity.east_mps) >= LEVEL_MPS


def _is_less(one_m: float | None, other_m: float | None) -> bool:
    """Whether the one is known, and less by more than noise; anything is news when none was."""
    if one_m is None or other_m is None:
        return one_m is not other_m
    return one_m <= other_m - PROGRESS_M


def _home_distance_m(state: VehicleState) -> float | None:
    pad = None if state.profile is None else state.profile.pad_place
    home, position = state.takeoff_point or pad, state.position.value
    return None if home is None or position is None else horizontal_distance_m(position, home)
