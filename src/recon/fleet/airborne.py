"""Whether a vehicle is in the air, believed rather than reported: a wrong flag must not land it.

Theory of operation. The belief is True, False, or None (it may be in the air; every rule treats it
so, and no hover is sent for one report in doubt). What a packet reports counts as follows:

    report                  after flight                          after the ground
    in flight               True, at once                         True, at once: a takeoff
    unknown                 None                                  None; the takeoff is not seen
    on the ground           False with evidence of a landing,     False, unless there are signs of
                            else True or None                     flight: then None or True

A *landing* is believed when the vehicle was slow (under 0.5 m/s) for 1 s of such reports and

- its last report in flight was in a landing mode, it has come down by 1 m in that mode, and has not
  moved since; or
- it is within 15 m of its takeoff point and 2 m of its takeoff height; or
- its takeoff point is unknown, a gap of telemetry was long enough to descend, and it is at takeoff
  height after it; or
- its battery was changed in a gap (only on the ground can it rise).

Where none of these holds, two minutes of rest count in which the battery stays the same: motors
that run empty it by 3 % and more in that time. A descent without a landing mode is no evidence: a
hover that follows one looks the same. Until then the belief is *True* if it has moved since, or if
it was not landing and has not come down by 2 m from the greatest height of the last half minute or
more; else it is None. (A landing from knee height comes down by less than any bound.)

On the ground, *signs of flight* are a speed over 2 m/s, a height that moved away by more than 5 m
(a step at once is a new zero of the barometer), and a mode that exists only in flight. Each makes
the belief None after 1 s, a flight mode with motion makes it True; they are gone after 1 s without.
"""

from typing import NamedTuple

from recon.fleet.settings import AirborneSettings
from recon.geo.distance import horizontal_distance_m
from recon.model.geo import LatLon
from recon.model.mission import DJI
from recon.model.replacing import replace
from recon.model.report import CoreReport
from recon.model.trust import FlightEvidence, GroundReports, GroundStand
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import FlightMode, VehicleState

LANDING_MODES = frozenset({FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING})
FLIGHT_MODES = frozenset(
    {
        FlightMode.GPS_WAYPOINT,
        FlightMode.GO_HOME,
        FlightMode.GPS_HOT_POINT,
        FlightMode.GPS_FOLLOW_ME,
        FlightMode.ACTIVE_TRACK,
        FlightMode.TAP_FLY,
    }
)
"""Modes that exist only in flight. Landing modes linger after a landing."""


class AirborneBelief(NamedTuple):
    """The belief after a packet; `is_doubted` when the report contradicts it for good reason."""

    is_flying: bool | None
    evidence: FlightEvidence
    takes_off: bool = False
    home: LatLon | None = None
    """Where it took off, when it does."""
    is_doubted: bool = False


def believe(
    state: VehicleState,
    report: CoreReport,
    now_ns: int,
    settings: AirborneSettings,
    *,
    is_changed: bool = True,
) -> AirborneBelief:
    """Return whether a vehicle is in the air after a believed packet. Pure.

    `state` is the one before the packet, `is_changed` whether its values differ from that one's:
    values that stand still show no landing.
    """
    evidence = state.trust.evidence
    if report.is_flying:
        return _reported_in_flight(state, report, now_ns, settings)
    if report.is_flying is None:
        return AirborneBelief(None, replace(evidence, ground=None))
    if evidence.flown_at_ns is not None:
        return _reported_on_ground_after_flight(state, report, now_ns, settings, is_changed)
    return _reported_on_ground(state, report, now_ns, settings)


def flown(at_ns: int) -> FlightEvidence:
    """Return the evidence of a vehicle known only to have flown, as after a restart."""
    return FlightEvidence(flown_at_ns=at_ns)


def _reported_in_flight(
    state: VehicleState, report: CoreReport, now_ns: int, settings: AirborneSettings
) -> AirborneBelief:
    before, height_m = state.trust.evidence, report.height_above_takeoff_m
    ground, mode = before.ground, state.flight_mode
    high_m, older_m, since_ns = before.high_m, before.older_high_m, before.high_since_ns
    if before.flown_at_ns is None:
        high_m, older_m, since_ns = height_m, None, now_ns
    elif now_ns - since_ns >= seconds_to_ns(settings.height_window_s):
        high_m, older_m, since_ns = height_m, high_m, now_ns
    elif height_m is not None:
        high_m = height_m if high_m is None else max(high_m, height_m)
    landing_at_ns, landing_from_m = before.landing_at_ns, before.landing_from_m
    if mode.value in LANDING_MODES:
        landing_at_ns = now_ns
        if height_m is not None:
            landing_from_m = height_m if landing_from_m is None else max(landing_from_m, height_m)
    elif landing_at_ns is not None and now_ns - landing_at_ns > seconds_to_ns(settings.landing_s):
        landing_at_ns = landing_from_m = None
    evidence = FlightEvidence(
        flown_at_ns=now_ns,
        flown_height_m=height_m,
        battery_fraction=state.battery_fraction.value,
        high_m=high_m,
        older_high_m=older_m,
        high_since_ns=since_ns,
        landing_at_ns=landing_at_ns,
        landing_from_m=landing_from_m,
    )
    if ground is None:
        return AirborneBelief(True, evidence)
    return AirborneBelief(True, evidence, True, _home(ground, report, now_ns, settings))


def _home(
    ground: GroundStand, report: CoreReport, now_ns: int, settings: AirborneSettings
) -> LatLon | None:
    """Where it took off: here, unless that happened in a gap of telemetry."""
    gap_s = (now_ns - ground.at_ns) / NS_PER_S
    stood = ground.position
    if stood is None or gap_s <= settings.takeoff_seen_s:
        return report.position or stood
    if gap_s <= settings.stands_still_s:
        return stood
    return None


def _reported_on_ground_after_flight(
    state: VehicleState,
    report: CoreReport,
    now_ns: int,
    settings: AirborneSettings,
    is_changed: bool,
) -> AirborneBelief:
    before = state.trust.evidence
    speed_mps = None if report.velocity_ned is None else report.velocity_ned.speed_mps
    is_slow = is_changed and speed_mps is not None and speed_mps < settings.slow_mps
    slow_since_ns = (before.slow_since_ns or now_ns) if is_slow else None
    reports = _continued(before.reports, state, report, speed_mps, now_ns, settings)
    evidence = replace(before, slow_since_ns=slow_since_ns, reports=reports)
    rested = slow_since_ns is not None and now_ns - slow_since_ns >= seconds_to_ns(settings.slow_s)
    is_home = _is_at_takeoff(state, report, settings)
    lands = _lands(evidence, reports, report.height_above_takeoff_m)
    if rested and (
        lands
        or is_home
        or _has_descended_in_gap(state, reports, report, settings)
        or _battery_was_changed(evidence, reports, state, settings)
    ):
        return AirborneBelief(False, _on_ground(report, now_ns))
    if _rests_without_power(reports, state, now_ns, settings):
        return AirborneBelief(False, _on_ground(report, now_ns))
    moved_ns = reports.moved_at_ns
    if moved_ns is not None and now_ns - moved_ns < seconds_to_ns(settings.slow_s):
        return AirborneBelief(True, evidence, is_doubted=True)
    was_landing = evidence.landing_from_m is not None and not reports.has_moved
    is_up = _is_up(evidence, report.height_above_takeoff_m, settings)
    if is_up and not (was_landing or is_home):
        return AirborneBelief(True, evidence, is_doubted=True)
    lasts_ns = now_ns - reports.since_ns
    return AirborneBelief(None, evidence, is_doubted=lasts_ns >= seconds_to_ns(settings.doubt_s))


def _continued(
    before: GroundReports | None,
    state: VehicleState,
    report: CoreReport,
    speed_mps: float | None,
    now_ns: int,
    settings: AirborneSettings,
) -> GroundReports:
    """Return the run of reports with this one; motion in it refutes the landing it reports."""
    height_m, battery = report.height_above_takeoff_m, state.battery_fraction.value
    if before is None:
        return GroundReports(now_ns, now_ns, height_m, battery)
    has_moved = speed_mps is not None and speed_mps > settings.moving_mps
    if height_m is not None and before.height_m is not None:
        has_moved = has_moved or abs(height_m - before.height_m) > settings.rest_m
    if has_moved:
        return GroundReports(before.since_ns, now_ns, height_m, battery, True, now_ns)
    if before.battery_fraction is None and battery is not None:
        return replace(before, rest_since_ns=now_ns, battery_fraction=battery)
    if now_ns - before.rest_since_ns > seconds_to_ns(settings.rest_s + settings.slow_s):
        return replace(before, rest_since_ns=now_ns, battery_fraction=battery)
    return before


def _lands(evidence: FlightEvidence, reports: GroundReports, height_m: float | None) -> bool:
    """Whether its last reports in flight were of a landing that has come down."""
    if evidence.landing_from_m is None or height_m is None or reports.has_moved:
        return False
    return evidence.landing_from_m - height_m >= 1.0


def _is_at_takeoff(state: VehicleState, report: CoreReport, settings: AirborneSettings) -> bool:
    home, here, height_m = state.takeoff_point, report.position, report.height_above_takeoff_m
    if home is None or here is None or height_m is None:
        return False
    is_low = abs(height_m) <= settings.takeoff_height_m
    return is_low and horizontal_distance_m(home, here) <= settings.takeoff_radius_m


def _has_descended_in_gap(
    state: VehicleState, reports: GroundReports, report: CoreReport, s: AirborneSettings
) -> bool:
    """Whether it is at takeoff height after a gap that was long enough to come down in.

    Only while its takeoff point is unknown: elsewhere that height may be high above a valley.
    """
    evidence = state.trust.evidence
    height_m, flown_ns = report.height_above_takeoff_m, evidence.flown_at_ns
    if height_m is None or flown_ns is None or reports.has_moved or state.takeoff_point is not None:
        return False
    gap_s = (reports.since_ns - flown_ns) / NS_PER_S
    if gap_s < s.landing_gap_s or abs(height_m) > s.takeoff_height_m:
        return False
    flown_m = evidence.flown_height_m
    return flown_m is None or flown_m - height_m <= gap_s * DJI.fastest_vertical_mps


def _battery_was_changed(
    evidence: FlightEvidence, reports: GroundReports, state: VehicleState, s: AirborneSettings
) -> bool:
    flown_ns, before = evidence.flown_at_ns, evidence.battery_fraction
    battery = state.battery_fraction
    if flown_ns is None or before is None:
        return False
    if battery.value is None or battery.received_at_ns is None:
        return False
    is_gap = reports.since_ns - flown_ns >= seconds_to_ns(s.battery_change_gap_s)
    is_new = battery.received_at_ns > flown_ns
    return is_gap and is_new and battery.value > before + s.battery_gain_fraction


def _rests_without_power(
    reports: GroundReports, state: VehicleState, now_ns: int, settings: AirborneSettings
) -> bool:
    """Whether its battery has stayed the same for longer than any motors leave it so."""
    battery, at_rest = state.battery_fraction, reports.battery_fraction
    if battery.value is None or at_rest is None or battery.received_at_ns is None:
        return False
    if now_ns - reports.rest_since_ns < seconds_to_ns(settings.rest_s):
        return False
    is_fresh = now_ns - battery.received_at_ns <= seconds_to_ns(settings.battery_fresh_s)
    return is_fresh and abs(at_rest - battery.value) < settings.rest_fraction


def _is_up(evidence: FlightEvidence, height_m: float | None, settings: AirborneSettings) -> bool:
    """Whether it has not come down since it flew."""
    heights = (evidence.high_m, evidence.older_high_m)
    known = [high_m for high_m in heights if high_m is not None]
    return height_m is not None and bool(known) and height_m >= max(known) - settings.rest_m


def _on_ground(report: CoreReport, now_ns: int) -> FlightEvidence:
    stand = GroundStand(now_ns, now_ns, report.position, report.height_above_takeoff_m)
    return FlightEvidence(ground=stand)


def _reported_on_ground(
    state: VehicleState, report: CoreReport, now_ns: int, settings: AirborneSettings
) -> AirborneBelief:
    stood = state.trust.evidence.ground
    if stood is None:
        return AirborneBelief(False, _on_ground(report, now_ns))
    ground_m = _ground_height_m(stood, state, report, now_ns, settings)
    moves, flies = _signs(state, report, stood, ground_m, settings)
    if not (moves or flies):
        return _quiet(state, report, stood, ground_m, now_ns, settings)
    since_ns = stood.signs_since_ns or now_ns
    stand = GroundStand(stood.since_ns, now_ns, stood.position, ground_m, since_ns)
    evidence = FlightEvidence(ground=stand)
    if now_ns - since_ns < seconds_to_ns(settings.signs_s):
        return AirborneBelief(state.is_flying.value, evidence)
    if not (moves and flies):
        return AirborneBelief(None, evidence, is_doubted=True)
    height_m = report.height_above_takeoff_m
    flying = FlightEvidence(
        flown_at_ns=now_ns, flown_height_m=height_m, high_m=height_m, high_since_ns=now_ns
    )
    return AirborneBelief(True, flying, True, stood.position, is_doubted=True)


def _signs(
    state: VehicleState,
    report: CoreReport,
    stood: GroundStand,
    ground_m: float | None,
    settings: AirborneSettings,
) -> tuple[bool, bool]:
    """Return whether a vehicle on the ground moves, and whether its mode is one of flight."""
    velocity, height_m = report.velocity_ned, report.height_above_takeoff_m
    moves = velocity is not None and velocity.speed_mps > settings.sign_mps
    if height_m is not None and ground_m is not None:
        moves = moves or abs(height_m - ground_m) > settings.sign_m
    mode = state.flight_mode
    is_new = mode.received_at_ns is not None and mode.received_at_ns > stood.since_ns
    return moves, is_new and mode.value in FLIGHT_MODES


def _quiet(
    state: VehicleState,
    report: CoreReport,
    stood: GroundStand,
    ground_m: float | None,
    now_ns: int,
    settings: AirborneSettings,
) -> AirborneBelief:
    """Return the belief without signs of flight; after a doubt they must be gone for a while."""
    is_on_ground = state.is_flying.value is False
    quiet_ns = stood.quiet_since_ns or now_ns
    if not is_on_ground and now_ns - quiet_ns < seconds_to_ns(settings.signs_s):
        stand = GroundStand(stood.since_ns, now_ns, stood.position, ground_m, None, quiet_ns)
        return AirborneBelief(None, FlightEvidence(ground=stand), is_doubted=True)
    position = report.position or stood.position
    stand = GroundStand(stood.since_ns, now_ns, position, ground_m)
    return AirborneBelief(False, FlightEvidence(ground=stand))


def _ground_height_m(
    stood: GroundStand,
    state: VehicleState,
    report: CoreReport,
    now_ns: int,
    settings: AirborneSettings,
) -> float | None:
    """Return the height of the ground below it: slow changes are the air pressure's."""
    height_m, ground_m = report.height_above_takeoff_m, stood.height_m
    if height_m is None or ground_m is None:
        return ground_m if height_m is None else height_m
    seconds = (now_ns - stood.at_ns) / NS_PER_S
    before_m = state.trust.place.height_m
    step_m = settings.sign_m + DJI.fastest_vertical_mps * seconds
    if before_m is not None and abs(height_m - before_m) > step_m:
        return height_m
    if seconds >= settings.landing_gap_s and abs(height_m) <= settings.takeoff_height_m:
        return height_m  # switched on anew
    follows_m = settings.pressure_drift_mps * seconds
    return ground_m + max(-follows_m, min(follows_m, height_m - ground_m))
