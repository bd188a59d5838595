"""How an order comes on record: refused, waiting, queued; and what it ends of older ones."""

from recon.link.outbox import Lane, lane_of
from recon.model.command import Command, Hover, Phase, Refusal
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.safety import ApprovedCommand
from recon.station.control import return_home_note
from recon.station.control.order_targets import name_of, target_of
from recon.station.state import orders
from recon.station.state.orders import OrderRecord, PhaseChange
from recon.station.state.station import Station
from recon.vehicles.packets import describe_altitudes


def put(station: Station, record: OrderRecord) -> Station:
    """Return the station with an order's record as it is now."""
    book = orders.put(station.orders, record, station.settings.orders_kept)
    return replace(station, orders=book)


def refused_record(
    station: Station, command: Command, refusal: Refusal, now_ns: int
) -> OrderRecord:
    """Return the record of an order that ends where it began."""
    change = PhaseChange(Phase.REFUSED_BY_STATION, now_ns, refusal.reason)
    return OrderRecord(command, name_of(station, command), (change,), refusal=refusal)


def may_wait(command: Command, refusal: Refusal) -> bool:
    """Return whether a stop is refused only for a vehicle, last known to fly, that is not heard."""
    return isinstance(command.body, Hover) and not command.takeoff and refusal.is_stale


def waiting_record(
    station: Station, command: Command, refusal: Refusal, now_ns: int
) -> OrderRecord:
    """Return the record of a stop that goes as soon as its vehicle is heard again."""
    expires_at_ns = now_ns + seconds_to_ns(station.settings.stop_waits_s)
    note = f"waits until it is heard again: {refusal.reason}"
    return OrderRecord(
        command=replace(command, expires_at_ns=expires_at_ns),
        vehicle_name=name_of(station, command),
        history=(PhaseChange(Phase.QUEUED, now_ns, note),),
        next_repeat_ns=now_ns,
        repeats_left=station.settings.emergency_repeats,
        waits_to_be_heard=True,
    )


def queued_record(
    station: Station, command: Command, approved: ApprovedCommand, now_ns: int
) -> OrderRecord:
    """Return the record of an order that the gate has approved."""
    settings = station.settings
    repeat_ns = now_ns + seconds_to_ns(settings.emergency_repeat_s)
    note = return_home_note.said_of(command.body, target_of(station, command))
    return OrderRecord(
        command=command,
        vehicle_name=name_of(station, command),
        history=(PhaseChange(Phase.QUEUED, now_ns, note),),
        altitudes=describe_altitudes(command.body, approved.altitude_offset_m),
        next_repeat_ns=repeat_ns if command.is_emergency else None,
        repeats_left=settings.emergency_repeats if command.is_emergency else 0,
        waiting_link_ids=approved.link_ids,
    )


def supersede_older(station: Station, command: Command, now_ns: int) -> Station:
    """A newer order to move ends the life of older ones to the same target, repeats included.

    Camera orders end older camera orders only: looking must never end the repeats of a stop. Of
    older ones that have ended already it ends the alarm.
    """
    target = target_of(station, command)
    is_camera = lane_of(command) is Lane.CAMERA
    for record in station.orders.tracked:
        older = record.command
        if (lane_of(older) is Lane.CAMERA) is is_camera and target_of(station, older) is target:
            note = f"by order {command.id}"
            station = put(station, orders.ended(record, Phase.SUPERSEDED, now_ns, note))
    return station
