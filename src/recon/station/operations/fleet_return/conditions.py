"""The alarms of a fleet return."""

from collections.abc import Iterator

from recon.station.operations.fleet_return.planning import is_same_pad
from recon.station.operations.fleet_return.progress import is_still_left
from recon.station.operations.settings import RETURN_SETTINGS
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.fleet_return_record import UNDER_WAY, FleetReturn, ReturningVehicle, Stage
from recon.station.state.station import Station

RULE_LEFT_OUT = "fleet_return"
RULE_PAD = "pad_to_clear"


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what an operator must see to: vehicles excluded, pads to be cleared."""
    running = station.fleet_return
    if running is None:
        return
    for member in running.members.values():
        if is_still_left(station, member):
            text = (
                f"{member.name} is excluded from the fleet return: {member.reason}. Order its own "
                "return home (it climbs to the aircraft's go-home height first), land it, or let "
                "its pilot fly it back"
            )
            yield _about(member, RULE_LEFT_OUT, Severity.ERROR, text)
    yield from _pads_to_clear(running)


def _pads_to_clear(running: FleetReturn) -> Iterator[Condition]:
    """A vehicle that has landed where another one comes next must be carried away."""
    for member in running.at(Stage.LANDED):
        following = _next_at_its_pad(running, member)
        if following is not None:
            text = f"Carry {member.name} off its pad: {following.name} lands there next"
            yield _about(member, RULE_PAD, Severity.WARNING, text)


def _next_at_its_pad(running: FleetReturn, landed: ReturningVehicle) -> ReturningVehicle | None:
    """The next vehicle for the pad of the one that has landed there last."""
    if landed.flight is None:
        return None
    pad = landed.flight.pad
    there = [
        member
        for member in in_turn(running)
        if member.flight is not None and is_same_pad(member.flight.pad, pad, RETURN_SETTINGS)
    ]
    later = (m for m in there if m.stage is Stage.LANDED and m.since_ns > landed.since_ns)
    if any(later):
        return None
    coming = [m for m in there if m.stage in (Stage.WAITING, *UNDER_WAY)]
    return next((m for m in coming if m.stage in UNDER_WAY), coming[0] if coming else None)


def _about(member: ReturningVehicle, rule: str, severity: Severity, text: str) -> Condition:
    key = f"{rule}:{member.serial}"
    return Condition(key, severity, rule, member.name, text, member.serial, member.link_id)


def in_turn(running: FleetReturn) -> list[ReturningVehicle]:
    """Return the planned vehicles by wave and height, then the others."""

    def turn(member: ReturningVehicle) -> tuple[bool, int, float]:
        flight = member.flight
        return (True, 0, 0.0) if flight is None else (False, flight.wave, flight.layer_up_m)

    return sorted(running.members.values(), key=turn)
