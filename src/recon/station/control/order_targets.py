"""Whom an order is for, and what telemetry has shown of it there."""

from recon.fleet.confirmation import Progress, SentContext, progress
from recon.model.command import Command, Phase
from recon.model.vehicle import VehicleState
from recon.station.control import missions
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station


def target_of(station: Station, command: Command) -> VehicleState | None:
    """Return the state of whom a command is for, None while it is not there."""
    return station.target(command.serial, command.link_id)


def name_of(station: Station, command: Command) -> str:
    """Return what people call whom a command is for."""
    target = station.target(command.serial, command.link_id)
    if target is not None:
        return target.display_name
    profile = station.fleet.profiles.get(command.serial or "")
    return profile.display_name if profile is not None else command.serial or "nobody"


def sent_context(station: Station, record: OrderRecord, now_ns: int) -> SentContext:
    """What is known as a command leaves; an old mode is no knowledge of the mode now."""
    target = target_of(station, record.command)
    if target is None:
        return SentContext(now_ns, None, None)
    age_s = target.flight_mode.age_s(now_ns)
    is_fresh = age_s is not None and age_s <= station.settings.safety.fresh_telemetry_s
    mode = target.flight_mode.value if is_fresh else None
    return SentContext(now_ns, mode, target.is_flying.value)


def progress_of(
    station: Station, record: OrderRecord, target: VehicleState, now_ns: int
) -> Progress:
    """Return how much of an order telemetry shows, on every link it is for."""
    if record.sent is None:
        return Progress.UNSEEN
    body, sent = missions.present_part(record.command, record.plan).body, record.sent
    states = (target, *flying_rivals(station, record, target))
    return min(progress(body, sent, state, now_ns) for state in states)


def is_shown(record: OrderRecord) -> bool:
    """Return whether telemetry has shown that an order is carried out."""
    return record.phase in (Phase.CONFIRMED, Phase.STARTED)


def flying_rivals(
    station: Station, record: OrderRecord, target: VehicleState
) -> tuple[VehicleState, ...]:
    """What other links say that claim the serial and fly: an emergency order is for them too."""
    if not record.command.is_emergency:
        return ()
    links = (station.fleet.links[link_id] for link_id in target.rival_link_ids)
    return tuple(link.own_state for link in links if link.own_state.is_flying.value is True)
