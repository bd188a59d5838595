"""Applies telemetry reports to a vehicle's state."""

from dataclasses import fields
from math import isfinite
from typing import Any

from recon.fleet.airborne import AirborneBelief
from recon.fleet.go_home import fold_go_home
from recon.fleet.settings import FleetSettings
from recon.fleet.trust import is_backlog, judge_battery, judge_core, merged_trust
from recon.geo.distance import horizontal_distance_m
from recon.model.geo import LatLon
from recon.model.replacing import replace
from recon.model.report import CoreReport, ExtendedReport
from recon.model.units import Stamped, seconds_to_ns
from recon.model.vehicle import FlightMode, MissionNumbers, TrackPoint, VehicleState

LEAST_TRACK_STEP_M = 0.5


def fold_core(
    state: VehicleState, report: CoreReport, now_ns: int, settings: FleetSettings
) -> VehicleState:
    """Return the state after core telemetry (ICD 3.1.1), if it is believed (`fleet.trust`).

    A field reported as unknown becomes unknown: old values are never kept as new ones. The takeoff
    point changes at a believed takeoff only.
    """
    state, belief = judge_core(state, report, now_ns, settings)
    if belief is None:
        return state
    offset_m = _altitude_offset_m(report)
    state = replace(
        state,
        is_flying=Stamped(belief.is_flying, now_ns),
        reported_is_flying=Stamped(report.is_flying, now_ns),
        position=Stamped(report.position, now_ns),
        height_above_takeoff_m=Stamped(report.height_above_takeoff_m, now_ns),
        reported_altitude_m=Stamped(report.reported_altitude_m, now_ns),
        velocity_ned=Stamped(report.velocity_ned, now_ns),
        attitude=Stamped(report.attitude, now_ns),
        altitude_offset_m=Stamped(offset_m, now_ns),
        altitude_offset_at_takeoff_m=_offset_at_takeoff_m(state, belief, offset_m),
        takeoff_point=belief.home if belief.takes_off else state.takeoff_point,
        airborne_since_ns=_airborne_since_ns(state, belief, now_ns),
        core_received_at_ns=now_ns,
        track=_extend_track(state, report, now_ns, settings),
    )
    flight = fold_go_home(state, now_ns)
    return state if flight is state.go_home else replace(state, go_home=flight)


def fold_extended(
    state: VehicleState, report: ExtendedReport, now_ns: int, settings: FleetSettings
) -> VehicleState:
    """Return the state after extended telemetry (ICD 3.1.2)."""
    if is_backlog(state, now_ns):
        return state
    battery, trust = judge_battery(state, _battery(state, report), now_ns, settings.trust)
    mission_numbers, newest_mission_id = _mission_numbers(state, report)
    return replace(
        state,
        gnss_satellite_count=Stamped(report.gnss_satellite_count, now_ns),
        gnss_signal_level=Stamped(report.gnss_signal_level, now_ns),
        max_height_reached=Stamped(report.max_height_reached, now_ns),
        max_distance_reached=Stamped(report.max_distance_reached, now_ns),
        battery_fraction=Stamped(battery, now_ns),
        battery_warning=Stamped(report.battery_warning, now_ns),
        wind_level=Stamped(report.wind_level, now_ns),
        camera_state=Stamped(report.camera_state, now_ns),
        flight_mode=Stamped(report.flight_mode, now_ns),
        mission_id=Stamped(report.mission_id, now_ns),
        mission_numbers=mission_numbers,
        newest_mission_id=newest_mission_id,
        extended_received_at_ns=now_ns,
        trust=trust,
    )


def with_newest_values(
    state: VehicleState, other: VehicleState, settings: FleetSettings
) -> VehicleState:
    """Return a vehicle's state merged with newer values of another link.

    A takeoff reported on the other link is the newer one; its track continues the vehicle's.
    """
    newest: dict[str, Any] = {
        name: max(getattr(state, name), getattr(other, name), key=_received_at_ns)
        for name in STAMPED_FIELDS
    }
    times: dict[str, Any] = {
        name: _later(getattr(state, name), getattr(other, name)) for name in TIME_FIELDS
    }
    last_ns = state.track[-1].at_ns if state.track else -1
    track = (*state.track, *(point for point in other.track if point.at_ns > last_ns))
    has_takeoff = other.takeoff_point is not None or state.altitude_offset_at_takeoff_m is None
    source = other if has_takeoff else state
    is_newer = (other.core_received_at_ns or -1) > (state.core_received_at_ns or -1)
    trust = state.trust
    if is_newer:
        trust, newest["is_flying"] = merged_trust(state, other)
    return replace(
        state,
        **newest,
        **times,
        trust=trust,
        image_count=state.image_count + other.image_count,
        mission_numbers=max(state.mission_numbers, other.mission_numbers),
        altitude_offset_at_takeoff_m=source.altitude_offset_at_takeoff_m,
        takeoff_point=other.takeoff_point or state.takeoff_point,
        track=track[-settings.track_points :],
    )


STAMPED_FIELDS = tuple(
    field.name for field in fields(VehicleState) if isinstance(field.default, Stamped)
)


TIME_FIELDS = ("core_received_at_ns", "extended_received_at_ns", "image_received_at_ns")


def _later(a: int | None, b: int | None) -> int | None:
    return b if a is None else a if b is None else max(a, b)


def _received_at_ns(stamped: Stamped[Any]) -> int:
    return -1 if stamped.received_at_ns is None else stamped.received_at_ns


def _mission_numbers(state: VehicleState, report: ExtendedReport) -> tuple[MissionNumbers, int]:
    """Return what MissionID is known to say, and that of the newest mission.

    Two missions with the same one, apart in time: the app does not count them.
    """
    if report.flight_mode is not FlightMode.GPS_WAYPOINT:
        return state.mission_numbers, state.newest_mission_id
    number, mode = report.mission_id, state.flight_mode.value
    if number == 0:
        return state.mission_numbers, 0
    is_another = mode is not None and mode is not FlightMode.GPS_WAYPOINT
    is_repeated = is_another and number == state.newest_mission_id
    known = MissionNumbers.REPEATED if is_repeated else MissionNumbers.COUNTED
    return max(state.mission_numbers, known), number


def _altitude_offset_m(report: CoreReport) -> float | None:
    if report.reported_altitude_m is None or report.height_above_takeoff_m is None:
        return None
    offset_m = report.reported_altitude_m - report.height_above_takeoff_m
    return offset_m if isfinite(offset_m) else None


def _offset_at_takeoff_m(
    state: VehicleState, belief: AirborneBelief, offset_m: float | None
) -> float | None:
    """The offset of the first packet in flight; None on the ground."""
    if belief.is_flying is False:
        return None
    at_takeoff_m = None if belief.takes_off else state.altitude_offset_at_takeoff_m
    return offset_m if at_takeoff_m is None and belief.is_flying else at_takeoff_m


def _airborne_since_ns(state: VehicleState, belief: AirborneBelief, now_ns: int) -> int | None:
    if belief.is_flying is False:
        return None
    is_new = belief.takes_off or state.airborne_since_ns is None
    return now_ns if is_new else state.airborne_since_ns


def _battery(state: VehicleState, report: ExtendedReport) -> float | None:
    if report.battery_fraction is None:
        return None
    factor = 1.0 if state.profile is None else state.profile.battery_factor
    return min(1.0, report.battery_fraction * factor)


def _extend_track(
    state: VehicleState, report: CoreReport, now_ns: int, settings: FleetSettings
) -> tuple[TrackPoint, ...]:
    if report.position is None:
        return state.track
    if state.track and not _is_worth_a_point(state.track[-1], report.position, now_ns, settings):
        return state.track
    position = report.position
    point = TrackPoint(
        now_ns, position.latitude_deg, position.longitude_deg, report.height_above_takeoff_m
    )
    return (*state.track[-(settings.track_points - 1) :], point)


def _is_worth_a_point(
    last: TrackPoint, position: LatLon, now_ns: int, settings: FleetSettings
) -> bool:
    if now_ns - last.at_ns < seconds_to_ns(settings.track_interval_s):
        return False
    was = LatLon(last.latitude_deg, last.longitude_deg)
    return horizontal_distance_m(was, position) >= LEAST_TRACK_STEP_M
