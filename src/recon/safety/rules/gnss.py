"""Motion needs a good GNSS fix."""

from collections.abc import Iterator
from dataclasses import replace

from recon.model.command import Command, Refusal
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety.path.order_path import is_stop
from recon.safety.settings import SafetySettings
from recon.safety.situation import Situation

RULE = "gnss"


def gnss(command: Command, situation: Situation) -> Refusal | None:
    """Refuse motion without a good fix; a stop needs none."""
    vehicle = situation.vehicle
    if vehicle is None or not command.moves:
        return None
    if is_stop(command, situation):
        return None
    refusal = gnss_refusal(vehicle, situation.settings)
    if refusal is None:
        return None
    return replace(refusal, reason=f"{vehicle.display_name}: {refusal.reason}")


_WITHOUT_GNSS = {
    FlightMode.MANUAL: "MANUAL",
    FlightMode.ATTI: "ATTI",
    FlightMode.ATTI_COURSE_LOCK: "ATTI_COURSE_LOCK",
}
"""Modes in which the aircraft drifts with the wind and flies no mission or stick velocity."""


def gnss_refusal(vehicle: VehicleState, settings: SafetySettings) -> Refusal | None:
    """Return what is wrong with a vehicle's GNSS, without its name; None if nothing is.

    On the ground the signal must be better than in the air: the home point is still to be recorded.
    Ages are judged by the rule link_age.
    """
    return next(_refusals(vehicle, settings), None)


def _refusals(vehicle: VehicleState, settings: SafetySettings) -> Iterator[Refusal]:
    least = settings.min_satellites
    if vehicle.position.value is None:
        yield Refusal(RULE, "no position reported; wait for a fix")
    count = vehicle.gnss_satellite_count.value
    if count is None:
        yield Refusal(RULE, "satellite count unknown; wait for extended telemetry")
    elif count < least:
        yield Refusal(
            RULE,
            f"at least {least} satellites are needed; got {count}; {_OPEN_SKY}",
            parameters={"satellite_count": count, "min_count": least},
        )
    yield from _signal(vehicle, settings)
    mode = vehicle.flight_mode.value
    if mode is None or mode is FlightMode.UNKNOWN:
        yield Refusal(RULE, "flight mode unknown, so position hold is uncertain")
    elif mode in _WITHOUT_GNSS:
        reason = f"flies in {_WITHOUT_GNSS[mode]}, without GNSS; the pilot must steer it"
        yield Refusal(RULE, reason)


def _signal(vehicle: VehicleState, settings: SafetySettings) -> Iterator[Refusal]:
    level = vehicle.gnss_signal_level.value
    on_ground = vehicle.is_flying.value is False
    least = settings.min_gnss_level_on_ground if on_ground else settings.min_gnss_level
    if level is None:
        reason = f"GNSS signal level unknown, at least {least} of 5 is needed; {_OPEN_SKY}"
        yield Refusal(RULE, reason, parameters={"min_level": least})
    elif level < least:
        why = " before takeoff, to record the home point" if on_ground else ""
        yield Refusal(
            RULE,
            f"GNSS signal level must be at least {least} of 5{why}; got {level}; {_OPEN_SKY}",
            parameters={"signal_level": level, "min_level": least},
        )


_OPEN_SKY = "wait, or move to open sky"
