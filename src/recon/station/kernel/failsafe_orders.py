"""The reactions of the failsafe matrix, placed as orders through the gateway like any other."""

from functools import partial

from recon.model.command import Phase, issued_by_station
from recon.model.event import OperatorOrder
from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.safety.rules.separation import in_way_of_climb_home
from recon.station.control import order_gateway
from recon.station.control.situation_builder import command_of, situation
from recon.station.failsafe import runner
from recon.station.failsafe.facts import RunFacts
from recon.station.failsafe.runner import ORDERED_BODIES, ReactionRequest
from recon.station.kernel import fault_isolation
from recon.station.state.station import Station, take_id
from recon.station.state.steps import Output, Stepped

_WITHOUT_TIME = FailsafeCondition.BATTERY_CRITICAL
"""A return for any other reason can wait until nothing is in the way of its climb."""


def run_failsafes(station: Station, now_ns: int) -> Stepped:
    """Look at every vehicle if it is time, and order what is due."""
    station, run = runner.begin(station, now_ns)
    outputs: tuple[Output, ...] = ()
    if run is None:
        return station, outputs
    for serial in station.fleet.vehicles:
        station, sent = _advance(serial, run, station, now_ns)
        outputs += sent
    return runner.forget_others(station), outputs


def run_failsafes_isolated(station: Station, now_ns: int) -> Stepped:
    """Look at each vehicle separately."""
    station, run = runner.begin(station, now_ns)
    outputs: tuple[Output, ...] = ()
    if run is None:
        return station, outputs
    for serial in station.fleet.vehicles:
        part = partial(_advance, serial, run)
        where = f"reacting to the conditions of {serial}"
        station, sent = fault_isolation.attempt(where, part, station, now_ns)
        outputs += sent
    return runner.forget_others(station), outputs


def _advance(serial: str, run: RunFacts, station: Station, now_ns: int) -> Stepped:
    station, request = runner.advance(station, serial, run, now_ns)
    return (station, ()) if request is None else _order(station, request, now_ns)


def _order(station: Station, request: ReactionRequest, now_ns: int) -> Stepped:
    """Place one reaction; a hold that waits for telemetry counts as ordered."""
    station, number = take_id(station)
    issued_by = issued_by_station(request.condition.words)
    body = ORDERED_BODIES[request.reaction]
    order = OperatorOrder(number, body, issued_by, request.serial)
    if request.reaction is Reaction.RETURN and request.condition is not _WITHOUT_TIME:
        in_way = _in_way(station, order, now_ns)
        if in_way is not None:
            why = f"{in_way} is in the way of its climb: lead one of the two aside"
            return runner.after_order(station, request, why, now_ns, counts=False), ()
    station, sent = order_gateway.submit(station, order, now_ns)
    record = station.orders.records[number]
    is_refused = record.phase is Phase.REFUSED_BY_STATION
    why_not = record.note if is_refused else None
    return runner.after_order(station, request, why_not, now_ns), sent


def _in_way(station: Station, order: OperatorOrder, now_ns: int) -> str | None:
    """Return who hovers or flies where a return would climb: an aircraft climbs where it is."""
    command = command_of(station, order, now_ns)
    seen = situation(station, command, now_ns, with_traffic=True)
    return None if seen.vehicle is None else in_way_of_climb_home(seen.vehicle, seen)
