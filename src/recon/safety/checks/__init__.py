"""The preflight checklist, worked out from a vehicle's state and profile, and its airspace.

Every point is computed; none is ticked by hand. A point that fails or is unknown holds missions
back (rule preflight) until an operator overrides the list with a reason, which is logged and ends
with the landing. Attention holds nothing back. Points about what only some apps report are on the
list of those. What no app reports (propellers, the controller's mode switch) is on the pilot's own
list.
"""

from collections.abc import Callable

from recon.model.vehicle import VehicleState
from recon.safety.check import Check
from recon.safety.checks import aircraft, place, reported, site_facts
from recon.safety.situation import Situation

_CHECKS: tuple[Callable[[VehicleState, Situation], Check], ...] = (
    aircraft.link,
    aircraft.battery,
    site_facts.endurance,
    aircraft.gnss,
    aircraft.wind,
    site_facts.altitude_reference,
    site_facts.go_home_height,
    site_facts.failsafe,
    place.home_place,
    place.pad_altitude,
    place.fence,
    place.ground,
    place.clock,
    site_facts.camera_interval,
    aircraft.app,
)
_REPORTED_CHECKS: tuple[Callable[[VehicleState, Situation], Check | None], ...] = (
    reported.home_point,
    reported.aircraft_limits,
    reported.storage,
    reported.dji_check,
)


def checklist(vehicle: VehicleState, situation: Situation) -> tuple[Check, ...]:
    """Return every point of a vehicle's checklist, in display order. Pure."""
    points = tuple(check(vehicle, situation) for check in _CHECKS)
    if not vehicle.app_facts.is_known():
        return points
    found = (check(vehicle, situation) for check in _REPORTED_CHECKS)
    return (*points, *(point for point in found if point is not None))
