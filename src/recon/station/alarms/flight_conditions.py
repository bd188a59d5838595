"""Conditions of a vehicle in flight, and doubts about its telemetry, as alarms.

Each compares the newest telemetry with what the aircraft can do. The protocol carries no time of
measurement, so a link that delays every packet alike looks live, until an order is answered late
(`event_alarms.note_slow_answer`).
"""

from collections.abc import Iterator
from typing import NamedTuple

from recon.fleet.state import staleness
from recon.model.severity import Severity
from recon.model.trust import DoubtKind
from recon.model.vehicle import Staleness, VehicleState
from recon.safety.failsafe import attitude, gnss_lost, wind
from recon.station.state.settings import FlightAlarmSettings, StationSettings


class FlightCondition(NamedTuple):
    """A fact about one vehicle: rule, severity, a sentence without its name, and a delay."""

    rule: str
    severity: Severity
    text: str
    after_s: float = 0.0


def conditions(
    vehicle: VehicleState, now_ns: int, settings: StationSettings
) -> Iterator[FlightCondition]:
    """Yield what is doubted about a vehicle, and what is wrong with its flight."""
    on_ground = vehicle.is_flying.value is False
    for doubt in vehicle.trust.doubts:
        if doubt.until_ns > now_ns:
            is_minor = on_ground or doubt.kind is DoubtKind.BATTERY
            severity = Severity.WARNING if is_minor else Severity.ERROR
            yield FlightCondition(doubt.kind.value, severity, doubt.text)
    is_live = staleness(vehicle, now_ns) in (Staleness.LIVE, Staleness.LATE)
    if on_ground or not is_live:
        return
    yield from _gnss(vehicle, settings)
    yield from _height(vehicle, settings.flight_alarms)
    yield from _wind(vehicle, settings)
    yield from _attitude(vehicle, settings.flight_alarms)
    yield from _descent(vehicle, settings.flight_alarms)


def _gnss(vehicle: VehicleState, settings: StationSettings) -> Iterator[FlightCondition]:
    limits, after_s = settings.safety, settings.flight_alarms.gnss_s
    count, level = vehicle.gnss_satellite_count.value, vehicle.gnss_signal_level.value
    if vehicle.extended_received_at_ns is None:
        return
    if gnss_lost.is_lost(vehicle):
        text = (
            f"GNSS lost ({_reception(count, level)}): it drifts with the wind; its pilot must "
            "steer it"
        )
        yield FlightCondition("gnss", Severity.CRITICAL, text, after_s)
    elif (count is not None and count < limits.min_satellites) or (
        level is not None and level < limits.min_gnss_level
    ):
        text = (
            f"GNSS poor ({_reception(count, level)}), at least {limits.min_satellites} satellites "
            f"and level {limits.min_gnss_level} are needed: watch its position, and be "
            "ready to steer it"
        )
        yield FlightCondition("gnss", Severity.ERROR, text, after_s)


def _reception(count: int | None, level: int | None) -> str:
    satellites = "an unknown number of satellites" if count is None else f"{count} satellites"
    return f"{satellites}, signal level {'unknown' if level is None else f'{level} of 5'}"


def _height(vehicle: VehicleState, limits: FlightAlarmSettings) -> Iterator[FlightCondition]:
    if vehicle.height_above_takeoff_m.value is None:
        text = (
            "height unknown in flight: it counts as at any height. Check its app; land it if the "
            "height does not return"
        )
        yield FlightCondition("height_unknown", Severity.ERROR, text, limits.height_s)


def _wind(vehicle: VehicleState, settings: StationSettings) -> Iterator[FlightCondition]:
    text = wind.words(vehicle, settings.safety.preflight.strong_wind_level)
    if text is not None:
        yield FlightCondition("strong_wind", Severity.WARNING, text)


def _attitude(vehicle: VehicleState, limits: FlightAlarmSettings) -> Iterator[FlightCondition]:
    text = attitude.words(vehicle, limits.max_tilt_deg)
    if text is not None:
        yield FlightCondition("attitude", Severity.CRITICAL, text, limits.tilt_s)


def _descent(vehicle: VehicleState, limits: FlightAlarmSettings) -> Iterator[FlightCondition]:
    velocity = vehicle.velocity_ned.value
    if velocity is not None and velocity.down_mps > limits.max_descent_mps:
        text = (
            f"descends at {velocity.down_mps:.1f} m/s, limit {limits.max_descent_mps:g} m/s: it "
            "may be falling; keep clear below, its pilot must take over"
        )
        yield FlightCondition("descent", Severity.CRITICAL, text, limits.descent_s)
