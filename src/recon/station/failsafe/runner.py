"""The failsafe matrix's runner: which conditions hold for which vehicle, and what is due.

Theory of operation. Ten times a second each row is asked about each vehicle in the air. What holds
is an occurrence:

    absent -> pending --held for the cell's delay--> ordered   --+
       ^         |                                   refused: tried again, a few times
       |         +-- an operator ordered something newer: left --+
       |         +-- a return with time, another in the way of its climb: asked for each second
       +-- absent again (pending: at once; else after 3 s, batteries: at the landing)

The reaction is an order like any other, placed by the kernel: judged by the gate, repeated,
confirmed, audited. It is given once per occurrence, so an operator's later order prevails. It is
not given to a pilot's vehicle, on the ground or where that is uncertain, under an all stop, or
where something at least as strong is under way. While the link is lost nothing can be sent: that
row orders when telemetry is back. What a vehicle shows right after a restart is from before it.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from dataclasses import replace as exact_replace

from recon.model.command import Hover, LandNow, ReturnHome
from recon.model.control import AuthorityHolder
from recon.model.failsafe_matrix import Activity, FailsafeCell, FailsafeCondition, Reaction
from recon.model.replacing import replace
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.safety.failsafe import ROWS, FailsafeRow
from recon.station.failsafe.activity import activity_of, with_remaining
from recon.station.failsafe.facts import RunFacts, flight_facts, run_facts, with_times
from recon.station.state.failsafe_state import (
    NO_OCCURRENCES,
    Occurrence,
    Occurrences,
    ReactionOutcome,
)
from recon.station.state.settings import FailsafeSettings
from recon.station.state.station import Station

_FOUND_ROWS = tuple((row, row.find) for row in ROWS.values() if row.find is not None)

_STREAMS_OWN = frozenset({FailsafeCondition.TELEMETRY_LOST, FailsafeCondition.OPERATOR_GONE})
"""A setpoint stream ends automatically for these, with a hold."""

_SHOWN_BY_THE_STATION = frozenset({FailsafeCondition.LINK_LOST, FailsafeCondition.TELEMETRY_LOST})
"""Conditions that cannot predate a restart: they begin with telemetry of this run."""

ORDERED_BODIES: Mapping[Reaction, Hover | ReturnHome | LandNow] = {
    Reaction.HOLD: Hover(),
    Reaction.RETURN: ReturnHome(),
    Reaction.LAND: LandNow(),
}
_RANKS: Mapping[type, int] = {
    type(body): reaction.rank for reaction, body in ORDERED_BODIES.items()
}
_PENDING = (ReactionOutcome.PENDING, ReactionOutcome.REFUSED)


@dataclass(frozen=True, slots=True)
class ReactionRequest:
    """A reaction that is due for one vehicle."""

    serial: str
    condition: FailsafeCondition
    reaction: Reaction


Requests = tuple[ReactionRequest, ...]


def begin(station: Station, now_ns: int) -> tuple[Station, RunFacts | None]:
    """Return the station with its own times noted, and the facts of a run if one is due."""
    state = with_times(station.failsafe_state, station, now_ns)
    period_ns = seconds_to_ns(station.settings.failsafe.period_s)
    if state.run_at_ns is not None and now_ns - state.run_at_ns < period_ns:
        return replace(station, failsafe_state=state), None
    awaited = _awaited(station, now_ns)
    if awaited != state.awaited_ns:
        state = replace(state, awaited_ns=awaited)
    station = replace(station, failsafe_state=replace(state, run_at_ns=now_ns))
    return station, run_facts(station, now_ns)


def advance(
    station: Station, serial: str, run: RunFacts, now_ns: int
) -> tuple[Station, ReactionRequest | None]:
    """Return the station after one vehicle was looked at, and the strongest reaction due."""
    vehicle = station.fleet.vehicles.get(serial)
    known = station.failsafe_state.occurrences.get(serial, NO_OCCURRENCES)
    if vehicle is None or vehicle.is_flying.value is False:
        return _with(station, serial, NO_OCCURRENCES, None), None
    if station.control(serial).restored is not None:
        return station, None
    station = with_remaining(station, vehicle)
    facts = flight_facts(station, vehicle, run, now_ns)
    found = [(row, since_ns) for row, find in _FOUND_ROWS if (since_ns := find(facts)) is not None]
    if not found and not known:
        return station, None
    activity = activity_of(station, vehicle)
    flight = _Flight(station, vehicle, activity, now_ns)
    occurrences = dict(_absent(known, {row.condition for row, _ in found}, flight))
    for row, since_ns in found:
        occurrences[row.condition] = _present(row, known.get(row.condition), since_ns, flight)
    station = _with(station, serial, occurrences, activity)
    return station, _strongest_due(occurrences, flight)


def forget_others(station: Station) -> Station:
    """Return the station without what is remembered of forgotten vehicles."""
    state, vehicles = station.failsafe_state, station.fleet.vehicles
    gone = (state.occurrences.keys() | state.remaining.keys()) - vehicles.keys()
    if not gone:
        return station
    for serial in gone:
        station = _with(station, serial, NO_OCCURRENCES, None)
    state = station.failsafe_state
    remaining = {key: value for key, value in state.remaining.items() if key not in gone}
    return replace(station, failsafe_state=replace(state, remaining=remaining))


def after_order(
    station: Station,
    request: ReactionRequest,
    why_not: str | None,
    now_ns: int,
    *,
    counts: bool = True,
) -> Station:
    """Return the station after a requested reaction was ordered, or not and why.

    One that does not count as a try is asked for until it is given.
    """
    state, settings = station.failsafe_state, station.settings.failsafe
    known = state.occurrences[request.serial]
    last = known[request.condition]
    if why_not is None:
        now = exact_replace(
            last,
            outcome=ReactionOutcome.ORDERED,
            outcome_text=f"was ordered to {request.reaction.value}",
        )
    else:
        now = exact_replace(
            last,
            outcome=ReactionOutcome.REFUSED,
            outcome_text=f"could not be ordered to {request.reaction.value} ({why_not})",
            tries=last.tries + counts,
            retry_at_ns=now_ns + seconds_to_ns(settings.retry_s),
        )
    occurrences = {**known, request.condition: now}
    activity = state.activities[request.serial]
    return _with(station, request.serial, occurrences, activity)


def cell_of(station: Station, occurrence: Occurrence, activity: Activity) -> FailsafeCell:
    """Return the cell that an occurrence asks for while the vehicle does this now.

    A link that was lost while it was steered leaves it hovering: the activity of then counts.
    """
    was_steered = occurrence.activity is Activity.STEERED and activity is Activity.HOLDING
    if was_steered and ROWS[occurrence.condition].is_ordered_on_return:
        activity = Activity.STEERED
    return station.settings.failsafe_matrix.cell(occurrence.condition, activity)


def may_react(station: Station, vehicle: VehicleState) -> bool:
    """Return whether the station may order a reaction: certainly in flight, and not the pilot's."""
    if vehicle.is_flying.value is not True or vehicle.serial is None:
        return False
    if station.is_stopped(vehicle.serial):
        return False  # a person stopped all, and decides what moves again
    return station.control(vehicle.serial).authority.holder is not AuthorityHolder.PILOT


@dataclass(frozen=True, slots=True)
class _Flight:
    station: Station
    vehicle: VehicleState
    activity: Activity
    now_ns: int

    @property
    def settings(self) -> FailsafeSettings:
        return self.station.settings.failsafe


def _present(
    row: FailsafeRow, known: Occurrence | None, since_ns: int, flight: _Flight
) -> Occurrence:
    if known is None:
        begun = Occurrence(row.condition, since_ns, flight.now_ns, flight.activity)
        if _is_from_before(row, flight):
            return exact_replace(
                begun, outcome=ReactionOutcome.LEFT, outcome_text="so before the restart"
            )
        return begun
    begins_anew = row.is_ordered_on_return and known.outcome is ReactionOutcome.PENDING
    begun_ns = since_ns if begins_anew else known.since_ns
    seen = exact_replace(known, seen_ns=flight.now_ns, since_ns=begun_ns)
    if seen.outcome in _PENDING and _has_newer_order(flight, seen.since_ns):
        return exact_replace(
            seen, outcome=ReactionOutcome.LEFT, outcome_text="an operator's order stands"
        )
    return seen


def _absent(
    known: Occurrences, found: set[FailsafeCondition], flight: _Flight
) -> Iterable[tuple[FailsafeCondition, Occurrence]]:
    """Yield the occurrences that do not hold now and are not over yet."""
    lingers_ns = seconds_to_ns(flight.settings.lingers_s)
    for condition, occurrence in known.items():
        if condition in found:
            continue
        row, absent_ns = ROWS[condition], flight.now_ns - occurrence.seen_ns
        if occurrence.outcome is ReactionOutcome.PENDING and not row.is_ordered_on_return:
            continue
        if absent_ns <= lingers_ns or (row.lasts_to_landing and _is_settled(occurrence)):
            yield condition, occurrence


def _is_settled(occurrence: Occurrence) -> bool:
    return occurrence.outcome in (ReactionOutcome.ORDERED, ReactionOutcome.LEFT)


def _strongest_due(occurrences: Occurrences, flight: _Flight) -> ReactionRequest | None:
    """Return the strongest reaction due; the weaker ones are found under way at the next run."""
    if not may_react(flight.station, flight.vehicle):
        return None
    due = [
        (cell.reaction, occurrence.condition)
        for occurrence in occurrences.values()
        if _is_due(occurrence, cell := cell_of(flight.station, occurrence, flight.activity), flight)
    ]
    if not due:
        return None
    reaction, condition = max(due, key=lambda pair: pair[0].rank)
    serial = flight.vehicle.serial or ""
    if _is_under_way(flight.station, serial, reaction):
        return None
    return ReactionRequest(serial, condition, reaction)


def _is_due(occurrence: Occurrence, cell: FailsafeCell, flight: _Flight) -> bool:
    if not cell.reaction.is_order or occurrence.outcome not in _PENDING:
        return False
    if occurrence.tries >= flight.settings.tries or flight.now_ns < occurrence.retry_at_ns:
        return False
    serial = flight.vehicle.serial
    if occurrence.condition in _STREAMS_OWN and flight.station.control(serial).stream is not None:
        return False
    if not ROWS[occurrence.condition].is_ordered_on_return:
        is_now = occurrence.seen_ns == flight.now_ns
        return is_now and flight.now_ns - occurrence.since_ns >= cell.after_s * NS_PER_S
    return _is_back(flight, occurrence) and (
        occurrence.seen_ns - occurrence.since_ns >= cell.after_s * NS_PER_S
    )


def _is_back(flight: _Flight, occurrence: Occurrence) -> bool:
    """Whether telemetry of both kinds has come since: an old flight mode may hide a route home."""
    mode_at_ns = flight.vehicle.extended_received_at_ns
    is_new = mode_at_ns is not None and mode_at_ns > occurrence.since_ns
    return occurrence.seen_ns != flight.now_ns and is_new


def _is_under_way(station: Station, serial: str, reaction: Reaction) -> bool:
    """Whether an order at least as strong is on its way to the vehicle already."""
    return any(
        record.command.serial == serial
        and not record.phase.is_final
        and record.command.is_emergency
        and _RANKS[type(record.command.body)] >= reaction.rank
        for record in station.orders.tracked
    )


def _has_newer_order(flight: _Flight, since_ns: int) -> bool:
    """Whether a person has ordered what the vehicle does now, since the condition began."""
    intent = flight.station.control(flight.vehicle.serial).intent
    if intent.since_ns <= since_ns or intent.command_id is None or intent.command_id <= 0:
        return False
    record = flight.station.orders.records.get(intent.command_id)
    if record is None or record.command.role is AuthorityHolder.GUIDANCE:
        return False
    return record.command.issued_at_ns > since_ns


def _is_from_before(row: FailsafeRow, flight: _Flight) -> bool:
    seen_ns = flight.station.failsafe_state.awaited_ns.get(flight.vehicle.serial or "")
    return seen_ns is not None and row.condition not in _SHOWN_BY_THE_STATION


def _awaited(station: Station, now_ns: int) -> dict[str, int]:
    """Return when each vehicle of the last run was last missing, until its telemetry settles."""
    if station.restored_at_ns is None:
        return {}
    settles_ns = seconds_to_ns(station.settings.failsafe.restart_settles_s)
    before = station.failsafe_state.awaited_ns.items()
    awaited = {key: at_ns for key, at_ns in before if now_ns - at_ns <= settles_ns}
    missing = (key for key, control in station.controls.items() if control.restored is not None)
    return {**awaited, **dict.fromkeys(missing, now_ns)}


def _with(
    station: Station, serial: str, occurrences: Occurrences, activity: Activity | None
) -> Station:
    state = station.failsafe_state
    if serial not in state.occurrences and not occurrences:
        return station
    others = {key: value for key, value in state.occurrences.items() if key != serial}
    activities = {key: value for key, value in state.activities.items() if key != serial}
    if occurrences and activity is not None:
        others[serial], activities[serial] = occurrences, activity
    state = replace(state, occurrences=others, activities=activities)
    return replace(station, failsafe_state=state)
