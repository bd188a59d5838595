"""What is set in motion must know where it is."""

from collections.abc import Iterator

from recon.model.command import Command, Refusal
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety.path.order_path import is_stop
from recon.safety.settings import SafetySettings
from recon.safety.situation import Situation

RULE = "gnss"


def gnss(command: Command, situation: Situation) -> Refusal | None:
    """Refuse motion without a fix of quality; what only stops it needs none."""
    vehicle = situation.vehicle
    if vehicle is None or not command.moves:
        return None
    if is_stop(command, situation):
        return None
    fault = gnss_fault(vehicle, situation.settings)
    return None if fault is None else Refusal(RULE, f"{vehicle.display_name}: {fault}")


_WITHOUT_GNSS = {
    FlightMode.MANUAL: "MANUAL",
    FlightMode.ATTI: "ATTI",
    FlightMode.ATTI_COURSE_LOCK: "ATTI_COURSE_LOCK",
}
"""In these modes the aircraft drifts with the wind and flies no mission and no stick's velocity."""


def gnss_fault(vehicle: VehicleState, settings: SafetySettings) -> str | None:
    """Return in words what is wrong with a vehicle's GNSS, or None.

    On the ground more is asked than in the air: there the home point is still to be recorded. Ages
    are not looked at: that is the rule link_age.
    """
    return next(_faults(vehicle, settings), None)


def _faults(vehicle: VehicleState, settings: SafetySettings) -> Iterator[str]:
    if vehicle.position.value is None:
        yield "it reports no position: wait for a fix"
    count = vehicle.gnss_satellite_count.value
    if count is None:
        yield "how many satellites it sees is not known: wait for extended telemetry"
    elif count < settings.min_satellites:
        yield f"it sees {count} satellites, {settings.min_satellites} are needed: {_OPEN_SKY}"
    yield from _signal(vehicle, settings)
    mode = vehicle.flight_mode.value
    if mode is None or mode is FlightMode.UNKNOWN:
        yield "its flight mode is not known, so neither whether it holds its place by GNSS"
    elif mode in _WITHOUT_GNSS:
        yield f"it flies in {_WITHOUT_GNSS[mode]}, without GNSS: the pilot has to steer it"


def _signal(vehicle: VehicleState, settings: SafetySettings) -> Iterator[str]:
    level = vehicle.gnss_signal_level.value
    on_ground = vehicle.is_flying.value is False
    least = settings.min_gnss_level_on_ground if on_ground else settings.min_gnss_level
    if level is None:
        yield f"its GNSS signal level is none or unknown, {least} of 5 is needed: {_OPEN_SKY}"
    elif level < least:
        why = " before a takeoff, to record its home" if on_ground else ""
        yield f"its GNSS signal level is {level}, {least} of 5 is needed{why}: {_OPEN_SKY}"


_OPEN_SKY = "wait, or go where the sky is open"
