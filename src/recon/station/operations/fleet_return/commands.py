"""Calling vehicles home: each is commanded to hold, so that the plan begins with them at rest."""

from collections.abc import Iterator
from dataclasses import replace

from recon.model.command import Hover, Phase, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import Event, FleetReturnOrdered, OperatorOrder
from recon.record.audit.audit import AuditEntry
from recon.safety.datum import frame_for
from recon.safety.rules.not_expired import given_refusal
from recon.station.control import operator_lease, order_gateway
from recon.station.control.stop_latch import RULE as STOP_RULE
from recon.station.operations.fleet_return.progress import is_still_left
from recon.station.state.fleet_return_record import ENDED, FleetReturn, ReturningVehicle, Stage
from recon.station.state.station import Station
from recon.station.state.steps import Output, Stepped

RULE = "fleet_return"


def recall(station: Station, event: FleetReturnOrdered, now_ns: int) -> Stepped:
    """Begin a fleet return, or let more vehicles join the one under way.

    Each serial gets one order, with a number of its own: the hold that it begins with, or a
    refusal. Missions come later, each judged by the gate when its turn comes.
    """
    outputs: list[Output] = []
    for command_id, serial in enumerate(event.serials, event.first_command_id):
        by, person = f"{event.by}: fleet return", event.person
        order = OperatorOrder(command_id, Hover(), by, serial=serial, person=person)
        why = given_refusal(event.given_at_ns, now_ns, station.settings.safety)
        why = why or refusal(station, serial)
        why = why or operator_lease.refusal(station, serial, person, now_ns)
        if why is not None:
            station = order_gateway.record_refusal(station, order, why, now_ns)
            continue
        station, sent = join(station, order, event.by, now_ns)
        outputs += sent
    return station, tuple(outputs)


def join(station: Station, hold: OperatorOrder, by: str, now_ns: int) -> Stepped:
    """Hold a vehicle, and let it join the return unless its hold is refused.

    The mission that follows is ordered under the same authority as the hold.
    """
    station, sent = order_gateway.submit(station, hold, now_ns)
    if station.orders.records[hold.command_id].phase is not Phase.REFUSED_BY_STATION:
        station = _joined(station, hold, by, now_ns)
        if hold.role is AuthorityHolder.OPERATOR:
            station = operator_lease.assign(station, hold.serial or "", hold.person, now_ns)
    return station, sent


def refusal(station: Station, serial: str) -> Refusal | None:
    """Return why a vehicle cannot be recalled, else None; the gate judges its hold.

    One controlled by guidance is taken from it by the hold, as by any other order.
    """
    name, vehicle = _name(station, serial), station.fleet.vehicles.get(serial)
    if vehicle is not None and frame_for(station.airspace, vehicle) is None:
        return Refusal(RULE, f"{name}: no position received; hold it, or land it")
    if station.is_stopped(serial):
        return Refusal(STOP_RULE, f"{name} is held by an all stop; release its stop first")
    authority = station.control(serial).authority
    if authority.holder is AuthorityHolder.PILOT:
        return Refusal(
            RULE,
            f"{name} is controlled by the pilot ({authority.reason}); ask the pilot, take control, "
            "then recall it",
        )
    running = station.fleet_return
    member = None if running is None else running.members.get(serial)
    if member is not None and member.stage not in ENDED:
        return Refusal(RULE, f"{name} is already returning home, or waits for its turn")
    return None


def audit_entries(
    _before: Station, event: Event, _after: Station, _now_ns: int
) -> Iterator[AuditEntry]:
    """Yield an entry for the command; what follows is orders, which have their own."""
    if isinstance(event, FleetReturnOrdered):
        text = f"{len(event.serials)} vehicles are recalled in layers"
        details = {"first_id": event.first_command_id, "serials": list(event.serials)}
        yield AuditEntry("fleet_return.ordered", text, event.by, details=details)


def _joined(station: Station, order: OperatorOrder, by: str, now_ns: int) -> Station:
    serial = order.serial or ""
    vehicle = station.fleet.vehicles[serial]
    running = station.fleet_return
    if running is None or running.is_over:
        frame = frame_for(station.airspace, vehicle)
        assert frame is not None  # or it was refused
        left = () if running is None else running.members.values()
        still = {member.serial: member for member in left if is_still_left(station, member)}
        running = FleetReturn(by, now_ns, frame, still)
    hold_id = order.command_id
    name = vehicle.display_name
    member = ReturningVehicle(
        serial,
        name,
        vehicle.link_id,
        hold_id,
        Stage.STOPPING,
        now_ns,
        by=by,
        role=order.role,
        person=order.person,
    )
    return replace(station, fleet_return=running.put(member))


def _name(station: Station, serial: str) -> str:
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is not None:
        return vehicle.display_name
    profile = station.fleet.profiles.get(serial)
    return serial if profile is None else profile.display_name
