"""What is told of a fleet return: its alarms, and its view for consoles and programs."""

from collections.abc import Iterator

from recon.api import schema
from recon.model.units import ns_to_seconds
from recon.station.operations.fleet_return.places import is_same_pad
from recon.station.operations.fleet_return.progress import is_still_left
from recon.station.operations.fleet_return.settings import SETTINGS
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.fleet_return_record import UNDER_WAY, FleetReturn, Member, Stage
from recon.station.state.station import Station

RULE_LEFT_OUT = "fleet_return"
RULE_PAD = "pad_to_clear"


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what somebody must see to: vehicles left out, pads to be cleared."""
    running = station.fleet_return
    if running is None:
        return
    for member in running.members.values():
        if is_still_left(station, member):
            text = (
                f"{member.name} is not flown home with the fleet: {member.reason}. Order its own "
                "return (it climbs to the aircraft's go-home height first), land it, or let its "
                "pilot bring it"
            )
            yield _about(member, RULE_LEFT_OUT, Severity.ERROR, text)
    yield from _pads_to_clear(running)


def view(station: Station, now_ns: int) -> schema.FleetReturnView | None:
    """Return the newest fleet return as the API says it, None before the first."""
    running = station.fleet_return
    if running is None:
        return None
    return schema.FleetReturnView(
        called_by=running.by,
        age_s=ns_to_seconds(now_ns - running.called_at_ns),
        is_over=running.is_over,
        vehicles=[_member(member, now_ns) for member in _in_turn(running)],
    )


def _pads_to_clear(running: FleetReturn) -> Iterator[Condition]:
    """A vehicle that has landed where another one comes must be carried away."""
    for member in running.at(Stage.LANDED):
        following = _next_at_its_pad(running, member)
        if following is not None:
            text = f"carry {member.name} off its pad: {following.name} lands there next"
            yield _about(member, RULE_PAD, Severity.WARNING, text)


def _next_at_its_pad(running: FleetReturn, landed: Member) -> Member | None:
    """Who comes next to the pad of the one that has landed there last."""
    if landed.flight is None:
        return None
    pad = landed.flight.pad
    there = [
        member
        for member in _in_turn(running)
        if member.flight is not None and is_same_pad(member.flight.pad, pad, SETTINGS)
    ]
    later = (m for m in there if m.stage is Stage.LANDED and m.since_ns > landed.since_ns)
    if any(later):
        return None
    coming = [m for m in there if m.stage in (Stage.WAITING, *UNDER_WAY)]
    return next((m for m in coming if m.stage in UNDER_WAY), coming[0] if coming else None)


def _about(member: Member, rule: str, severity: Severity, text: str) -> Condition:
    key = f"{rule}:{member.serial}"
    return Condition(key, severity, rule, member.name, text, member.serial, member.link_id)


def _in_turn(running: FleetReturn) -> list[Member]:
    """Those with a flight by wave and height, then the others."""

    def turn(member: Member) -> tuple[bool, int, float]:
        flight = member.flight
        return (True, 0, 0.0) if flight is None else (False, flight.wave, flight.layer_up_m)

    return sorted(running.members.values(), key=turn)


def _member(member: Member, now_ns: int) -> schema.ReturningView:
    flight = member.flight
    return schema.ReturningView(
        serial=member.serial,
        vehicle_name=member.name,
        stage=member.stage.value,
        since_age_s=ns_to_seconds(now_ns - member.since_ns),
        reason=member.reason or None,
        wave=None if flight is None else flight.wave,
        layer_height_m=None if flight is None else flight.layer_up_m,
        layer_height_above_takeoff_m=None
        if flight is None
        else flight.layer_up_m - flight.takeoff_up_m,
        pad=None if flight is None else flight.pad.name,
        hold_command_id=member.hold_id,
        mission_command_id=member.mission_id,
    )
