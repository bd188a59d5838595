"""Whether telemetry is believed: each packet is judged before it becomes part of a vehicle's state.

Theory of operation. A core packet that is not plausible is not telemetry: nothing of it enters the
state and the age of core telemetry grows, so that everything that acts on late and lost telemetry
acts (neutral setpoint after 1 s, gate, hazard area after 3 s). Its doubt is in the state, with a
sentence, until `lingers_s` after the last packet that shows it:

- *jump*: from the last believed place farther than 10 m and 25 m/s (in height 5 m and 12 m/s) times
  the time since. The allowance grows in a gap, and within a burst by its length. Packets that
  follow from each other for 2 s are accepted as the new truth; the doubt stays for a minute then,
  and steered orders end. On the ground heights may jump: the barometer is set to zero there.
- *frozen*: the same position, height, velocity and attitude in flight, for 1 s at a speed of
  0.3 m/s and more, for 5 s at any. Telemetry counts as old as its last change. What is measured
  jitters in its last digits.
- *position stands still*: reported velocities add up to 20 m while the position stays within 3 m.
- *battery*: in flight a rise by more than 10 %, or a fall by more than 20 % within 10 s. The lower
  value is believed. A fall that lasts 10 s is no longer doubted.

A believed packet goes to `fleet.airborne`, which decides whether the vehicle is in the air. After
the station did not run for a second and more (`after_gap`), what arrives in the next second is not
telemetry: it waited in the sockets.
"""

from math import hypot
from typing import Any, NamedTuple

from recon.fleet.airborne import AirborneBelief, believe
from recon.fleet.settings import FleetSettings, TrustSettings
from recon.geo.distance import horizontal_distance_m
from recon.model.mission import DJI
from recon.model.replacing import replace
from recon.model.report import CoreReport
from recon.model.trust import (
    DeadReckoning,
    Doubt,
    DoubtKind,
    GroundReports,
    JumpedPlace,
    KnownPlace,
    Trust,
)
from recon.model.units import NS_PER_S, Stamped, seconds_to_ns
from recon.model.vehicle import VehicleState

_CORE_FIELDS = (
    "is_flying",
    "reported_is_flying",
    "position",
    "height_above_takeoff_m",
    "reported_altitude_m",
    "velocity_ned",
    "attitude",
    "altitude_offset_m",
)


class JudgedCore(NamedTuple):
    """A core packet judged: the state to fold it into, and the belief; None: not telemetry."""

    state: VehicleState
    belief: AirborneBelief | None


def judge_core(
    state: VehicleState, report: CoreReport, now_ns: int, settings: FleetSettings
) -> JudgedCore:
    """Return the state with its trust after a packet, and whether it is in the air."""
    trust, limits = state.trust, settings.trust
    if is_backlog(state, now_ns):
        return JudgedCore(state, None)
    since_ns = _unchanged_since_ns(state, report, now_ns)
    frozen = _frozen(state, report, since_ns, now_ns, limits)
    if frozen is not None:
        aged = _as_old_as(state, since_ns)
        trust = with_doubt(trust, DoubtKind.FROZEN, frozen, now_ns, limits.lingers_s)
        return JudgedCore(replace(aged, trust=trust), None)
    reckoning = _reckoning(trust, report, now_ns, limits)
    if reckoning is not None and hypot(reckoning.north_m, reckoning.east_m) > limits.reckoned_m:
        return _not_telemetry(state, since_ns, reckoning, now_ns, limits)
    place = _place(trust.place, report, now_ns)
    with_height = state.is_flying.value is not False
    jump = _jump(trust.place, report, now_ns, with_height, limits)
    if jump is None and trust.jumped is not None and _stays_off(trust, report):
        jump = "its position and height stay where they jumped to"
    if jump is not None:
        run = _run(trust.jumped, place, report, now_ns, limits)
        if not _is_accepted(run, now_ns, limits):
            text = f"{jump}; not believed. Check its position on its controller"
            trust = with_doubt(trust, DoubtKind.JUMP, text, now_ns, limits.lingers_s)
            trust = replace(trust, jumped=run, changed_at_ns=since_ns, reckoning=None)
            return JudgedCore(_perhaps_flying(replace(state, trust=trust), report), None)
        text = f"{jump}; accepted after {limits.accepted_s:g} s. Check its position before it moves"
        trust = with_doubt(trust, DoubtKind.JUMP, text, now_ns, limits.jump_lingers_s)
        trust = replace(trust, jump_accepted_at_ns=now_ns)
        reckoning = None
    is_changed = since_ns == now_ns
    belief = believe(state, report, now_ns, settings.airborne, is_changed=is_changed)
    doubts = trust.doubts
    if doubts:
        doubts = tuple(doubt for doubt in doubts if doubt.until_ns > now_ns)
    trust = replace(
        trust,
        doubts=doubts,
        evidence=belief.evidence,
        place=place,
        jumped=None,
        changed_at_ns=since_ns,
        reckoning=reckoning,
    )
    if belief.is_doubted:
        trust = _doubted(trust, belief, report, now_ns, limits)
    return JudgedCore(replace(state, trust=trust), belief)


def judge_battery(
    state: VehicleState, fraction: float | None, now_ns: int, limits: TrustSettings
) -> tuple[float | None, Trust]:
    """Return the believed charge after a report, and the trust."""
    trust, before = state.trust, state.battery_fraction
    last_ns = state.extended_received_at_ns
    if fraction is None or before.value is None or last_ns is None:
        return fraction, trust
    if now_ns - last_ns > seconds_to_ns(limits.battery_gap_s):
        return fraction, replace(trust, battery=Stamped(fraction, now_ns))
    if state.is_flying.value is False:
        return fraction, replace(trust, battery=Stamped(fraction, now_ns))
    reference, age_s = trust.battery.value, trust.battery.age_s(now_ns)
    if reference is None or age_s is None or age_s > limits.battery_s:
        reference = before.value
        trust = replace(trust, battery=Stamped(reference, now_ns))
    if fraction > max(before.value, reference) + limits.battery_rise_fraction:
        text = (
            f"its battery rose from {before.value:.0%} to {fraction:.0%} in flight; "
            f"{before.value:.0%} is used"
        )
        return before.value, with_doubt(trust, DoubtKind.BATTERY, text, now_ns, limits.lingers_s)
    if reference - fraction > limits.battery_fall_fraction:
        if before.value - fraction > limits.battery_fall_fraction:
            trust = replace(trust, battery=Stamped(before.value, now_ns))
        text = (
            f"its battery fell from {reference:.0%} to {fraction:.0%} within "
            f"{limits.battery_s:g} s; {fraction:.0%} is used. Land it soon"
        )
        trust = with_doubt(trust, DoubtKind.BATTERY, text, now_ns, limits.lingers_s)
    return fraction, trust


def with_doubt(trust: Trust, kind: DoubtKind, text: str, now_ns: int, lingers_s: float) -> Trust:
    """Return the trust with a doubt that a packet shows, in its words; its first time is kept."""
    until_ns = now_ns + seconds_to_ns(lingers_s)
    others = tuple(doubt for doubt in trust.doubts if doubt.kind is not kind)
    before = trust.doubt(kind)
    if before is None or before.until_ns <= now_ns:
        doubt = Doubt(kind, text, now_ns, now_ns, until_ns)
    else:
        doubt = Doubt(kind, text, before.since_ns, now_ns, until_ns, before.count + 1)
    return replace(trust, doubts=(*others, doubt))


def after_gap(state: VehicleState, now_ns: int, settings: TrustSettings) -> VehicleState:
    """Return a state after the station did not run: what waited in its sockets is not telemetry."""
    not_before_ns = now_ns + seconds_to_ns(settings.backlog_s)
    trust = replace(state.trust, not_before_ns=not_before_ns, reckoning=None, jumped=None)
    return replace(state, trust=trust)


def is_backlog(state: VehicleState, now_ns: int) -> bool:
    """Return whether a packet received now may have waited while the station did not run."""
    not_before_ns = state.trust.not_before_ns
    return not_before_ns is not None and now_ns < not_before_ns


def merged_trust(state: VehicleState, other: VehicleState) -> tuple[Trust, Stamped[bool]]:
    """Return trust and belief of a vehicle that another link, with newer telemetry, reports.

    A new link knows nothing of the flight: its report on the ground is no landing yet.
    """
    newest = {doubt.kind: doubt for doubt in (*state.trust.doubts, *other.trust.doubts)}
    trust = replace(other.trust, doubts=tuple(newest.values()))
    flown, stand = state.trust.evidence, other.trust.evidence.ground
    if stand is None or flown.flown_at_ns is None:
        return trust, other.is_flying
    battery = other.battery_fraction.value
    reports = GroundReports(stand.since_ns, stand.since_ns, stand.height_m, battery)
    evidence = replace(flown, reports=reports, slow_since_ns=None)
    return replace(trust, evidence=evidence), Stamped(None, other.is_flying.received_at_ns)


def _unchanged_since_ns(state: VehicleState, report: CoreReport, now_ns: int) -> int:
    """Return when this packet's values arrived first: now, unless they are those before it."""
    changed_ns = state.trust.changed_at_ns
    is_same = (
        report.attitude == state.attitude.value
        and report.position == state.position.value
        and report.height_above_takeoff_m == state.height_above_takeoff_m.value
        and report.velocity_ned == state.velocity_ned.value
    )
    return now_ns if changed_ns is None or not is_same else changed_ns


def _frozen(
    state: VehicleState, report: CoreReport, since_ns: int, now_ns: int, limits: TrustSettings
) -> str | None:
    """Return why the values are frozen, None while they may be measured."""
    if since_ns == now_ns or state.is_flying.value is False:
        return None
    if report.position is None and report.attitude is None and report.velocity_ned is None:
        return None  # it reports nothing that could change
    same_s, velocity = (now_ns - since_ns) / NS_PER_S, report.velocity_ned
    moves = velocity is not None and velocity.speed_mps >= limits.frozen_mps
    if same_s < (limits.frozen_moving_s if moves else limits.frozen_s):
        return None
    return "its telemetry is frozen: the same values arrive again and again. Restart its app"


def _as_old_as(state: VehicleState, since_ns: int) -> VehicleState:
    """Return the state with core telemetry as old as its last change."""
    if state.core_received_at_ns is None:
        return state
    at_ns = min(state.core_received_at_ns, since_ns)
    aged: dict[str, Any] = {
        name: Stamped(getattr(state, name).value, at_ns) for name in _CORE_FIELDS
    }
    return replace(state, **aged, core_received_at_ns=at_ns)


def _reckoning(
    trust: Trust, report: CoreReport, now_ns: int, limits: TrustSettings
) -> DeadReckoning | None:
    """Return the displacement by velocity since the position last moved; None while it rests."""
    position, velocity, before = report.position, report.velocity_ned, trust.reckoning
    if position is None or velocity is None:
        return None
    north_mps, east_mps = velocity.north_mps, velocity.east_mps
    if hypot(north_mps, east_mps) < limits.reckoned_mps:
        return None
    if before is None:
        return DeadReckoning(position, now_ns)
    seconds = (now_ns - before.at_ns) / NS_PER_S
    if seconds > limits.reckoned_gap_s:
        return DeadReckoning(position, now_ns)
    if horizontal_distance_m(before.position, position) > limits.stands_m:
        return DeadReckoning(position, now_ns)
    return DeadReckoning(
        before.position,
        now_ns,
        before.north_m + north_mps * seconds,
        before.east_m + east_mps * seconds,
    )


def _not_telemetry(
    state: VehicleState,
    since_ns: int,
    reckoning: DeadReckoning,
    now_ns: int,
    limits: TrustSettings,
) -> JudgedCore:
    text = (
        f"its velocity adds up to {hypot(reckoning.north_m, reckoning.east_m):.0f} m while its "
        "position stands still; not believed. Restart its app"
    )
    trust = with_doubt(state.trust, DoubtKind.STANDSTILL, text, now_ns, limits.lingers_s)
    trust = replace(trust, changed_at_ns=since_ns, reckoning=reckoning)
    return JudgedCore(replace(state, trust=trust), None)


def _place(before: KnownPlace, report: CoreReport, now_ns: int) -> KnownPlace:
    position, height_m = report.position, report.height_above_takeoff_m
    if position is not None and height_m is not None:
        return KnownPlace(position, now_ns, height_m, now_ns)
    return KnownPlace(
        before.position if position is None else position,
        before.position_at_ns if position is None else now_ns,
        before.height_m if height_m is None else height_m,
        before.height_at_ns if height_m is None else now_ns,
    )


def _jump(
    before: KnownPlace, report: CoreReport, now_ns: int, with_height: bool, limits: TrustSettings
) -> str | None:
    """Return how far a packet jumps, None when its place follows from the one before."""
    if before.position is not None and report.position is not None:
        moved_m = horizontal_distance_m(before.position, report.position)
        seconds = _between_s(before.position_at_ns, now_ns, limits)
        if moved_m > limits.jump_m + DJI.fastest_mps * seconds:
            return f"its position jumped by {moved_m:.0f} m"
    height_m = report.height_above_takeoff_m
    if with_height and before.height_m is not None and height_m is not None:
        climbed_m = abs(height_m - before.height_m)
        seconds = _between_s(before.height_at_ns, now_ns, limits)
        if climbed_m > limits.jump_vertical_m + DJI.fastest_vertical_mps * seconds:
            return f"its height jumped from {before.height_m:.0f} m to {height_m:.0f} m"
    return None


def _between_s(before_ns: int, now_ns: int, limits: TrustSettings) -> float:
    """Return the time that may lie between two packets: those of a burst arrive together."""
    seconds = (now_ns - before_ns) / NS_PER_S
    return seconds + limits.burst_s if seconds < limits.together_s else seconds


def _stays_off(trust: Trust, report: CoreReport) -> bool:
    """Return whether a packet continues a run of jumped ones, rather than the believed track.

    The allowance grows with time: without this question it would take in a jump without a word.
    """
    assert trust.jumped is not None
    off, track = trust.jumped.place, trust.place
    return _apart_m(off, report) < _apart_m(track, report)


def _apart_m(place: KnownPlace, report: CoreReport) -> float:
    """Return how far a packet is from a place, without what is unknown."""
    along_m = up_m = 0.0
    if place.position is not None and report.position is not None:
        along_m = horizontal_distance_m(place.position, report.position)
    if place.height_m is not None and report.height_above_takeoff_m is not None:
        up_m = report.height_above_takeoff_m - place.height_m
    return hypot(along_m, up_m)


def _run(
    before: JumpedPlace | None,
    place: KnownPlace,
    report: CoreReport,
    now_ns: int,
    limits: TrustSettings,
) -> JumpedPlace:
    """Return the run of jumped packets with this one; one that jumps again begins a new run."""
    if before is None or _jump(before.place, report, now_ns, True, limits) is not None:
        return JumpedPlace(place, now_ns)
    return JumpedPlace(place, before.since_ns, before.count + 1)


def _is_accepted(run: JumpedPlace, now_ns: int, limits: TrustSettings) -> bool:
    lasts_ns = now_ns - run.since_ns
    return lasts_ns >= seconds_to_ns(limits.accepted_s) and run.count >= limits.accepted_count


def _perhaps_flying(state: VehicleState, report: CoreReport) -> VehicleState:
    """A packet that is not believed may still be right that the vehicle took off."""
    if report.is_flying is False or state.is_flying.value is not False:
        return state
    return replace(state, is_flying=Stamped(None, state.is_flying.received_at_ns))


def _doubted(
    trust: Trust, belief: AirborneBelief, report: CoreReport, now_ns: int, limits: TrustSettings
) -> Trust:
    """Return the trust with the doubt of a report on the ground."""
    height_m = report.height_above_takeoff_m
    where = "at an unknown height" if height_m is None else f"at {height_m:.0f} m height"
    if belief.evidence.ground is not None or belief.takes_off:
        text = f"reports on the ground, but shows signs of flight {where}"
        kind = DoubtKind.FLIGHT_SIGNS
    else:
        text, kind = (
            f"reports on the ground {where}, and no landing was seen",
            DoubtKind.GROUND_REPORT,
        )
    state = "as flying" if belief.is_flying else "as possibly in flight"
    text = f"{text}; treated {state}. Check it, and restart its app"
    return with_doubt(trust, kind, text, now_ns, limits.lingers_s)
