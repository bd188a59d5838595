"""Who leads each vehicle. Taking over is explicit; the pilot's sticks always win.

Nothing here sends anything to a vehicle. A new holder's word is needed for every order to move;
what a vehicle was told before goes on until then, but streams of sticks end at once (`stream_ends`
sees that their giver leads no longer).
"""

from dataclasses import replace

from recon.link.outbox import Lane, lane_of
from recon.model.authority import AuthorityHolder, ControlAuthority
from recon.model.command import Command, Phase, Refusal
from recon.model.event import AuthorityTaken
from recon.model.intent import Intent
from recon.station.state import alarm_book, orders
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.outputs import Output, WithdrawMotion
from recon.station.state.station import Station
from recon.station.steering import stream_ends
from recon.station.steering.stream_ends import Driven

RULE = "authority"
NOBODY_YET = ControlAuthority()
PILOT = "pilot"


def authority_of(station: Station, serial: str) -> ControlAuthority:
    """Return who leads a vehicle; the operator, until somebody takes it."""
    return station.authorities.get(serial, NOBODY_YET)


def refusal(station: Station, event: AuthorityTaken) -> Refusal | None:
    """Return why somebody cannot take a vehicle over, or give it away, else None."""
    vehicle = station.fleet.vehicles.get(event.serial)
    if vehicle is None:
        return Refusal(RULE, f"{event.serial} is not known: no app has said this serial")
    authority = authority_of(station, event.serial)
    if event.holder is AuthorityHolder.GUIDANCE and authority.holder is AuthorityHolder.PILOT:
        return Refusal(
            RULE,
            f"{vehicle.display_name} is controlled by the pilot ({authority.reason}): take "
            "control first, then give it to guidance",
        )
    return None


def take(station: Station, event: AuthorityTaken, now_ns: int) -> Station:
    """Return the station after somebody took a vehicle over, or gave it away; or as it was."""
    if refusal(station, event) is not None:
        return station
    given = "taken over by" if event.holder is AuthorityHolder.OPERATOR else "given to it by"
    return _led(
        station,
        event.serial,
        ControlAuthority(event.holder, event.by, now_ns, f"{given} {event.by}"),
    )


def after_stop(station: Station, command: Command, now_ns: int) -> Station:
    """Return the station after hold, land or return was ordered: guidance must not fly on at once.

    Whoever stops a vehicle that guidance leads takes it from guidance, heard or not.
    """
    target = station.target(command.serial, command.link_id)
    serial = None if target is None else target.serial
    if serial is None or not command.is_emergency or command.asked_as is AuthorityHolder.GUIDANCE:
        return station
    if authority_of(station, serial).holder is not AuthorityHolder.GUIDANCE:
        return station
    reason = f"{command.name.replace('_', ' ')}, ordered by {command.issued_by}"
    return _led(
        station,
        serial,
        ControlAuthority(AuthorityHolder.OPERATOR, command.issued_by, now_ns, reason),
    )


def pilot_has_it(
    station: Station, serial: str, now_ns: int, why: str = "the pilot has taken the sticks"
) -> tuple[Station, tuple[Output, ...]]:
    """Return the station after telemetry shows that a pilot flies the vehicle: it lets go.

    The pilot leads it from now on. Nothing is sent: streams of sticks, their zeros and what waits
    in queues end, and orders to move it end as superseded. Called once for each takeover seen; of
    a vehicle that the pilot leads already nothing changes.
    """
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is None or authority_of(station, serial).holder is AuthorityHolder.PILOT:
        return station, ()
    station = _led(station, serial, ControlAuthority(AuthorityHolder.PILOT, PILOT, now_ns, why))
    station = _without_sticks(station, serial, why, now_ns)
    station = _superseded(station, serial, why, now_ns)
    station = replace(station, intents={**station.intents, serial: Intent(since_ns=now_ns)})
    condition = Condition(
        key=f"pilot_took_over:{serial}",
        severity=Severity.WARNING,
        rule="pilot_took_over",
        vehicle_name=vehicle.display_name,
        text=f"{vehicle.display_name}: {why}; the station lets go until somebody takes it over",
        serial=serial,
        link_id=vehicle.link_id,
    )
    book = alarm_book.note(station.alarms, condition, now_ns, station.settings.alarms_kept)
    links = station.fleet.link_ids_claiming(serial)
    return replace(station, alarms=book), (WithdrawMotion(links, why),)


def hand_back(station: Station, serial: str, to: str, why: str, now_ns: int) -> Station:
    """Return the station with a vehicle led by the operator that guidance leads no longer."""
    if authority_of(station, serial).holder is not AuthorityHolder.GUIDANCE:
        return station
    return _led(station, serial, ControlAuthority(AuthorityHolder.OPERATOR, to, now_ns, why))


def flies_unbidden(station: Station, serial: str, now_ns: int) -> Station:
    """Return the station after a vehicle was seen to move in the air with nothing ordered here.

    It is flown by hand: its pilot leads it until somebody takes it over. Whom somebody has taken
    over stays as it is; there the pilot shows by the flight table.
    """
    if serial in station.authorities:
        return station
    why = "it moves, and nothing has been ordered here: its pilot flies it"
    return _led(station, serial, ControlAuthority(AuthorityHolder.PILOT, PILOT, now_ns, why))


def _led(station: Station, serial: str, authority: ControlAuthority) -> Station:
    return replace(station, authorities={**station.authorities, serial: authority})


def _without_sticks(station: Station, serial: str, why: str, now_ns: int) -> Station:
    sticks = {key: pending for key, pending in station.sticks.items() if key != serial}
    station = replace(station, sticks=sticks)
    lease = station.streams.get(serial)
    if lease is None:
        return station
    ended = Phase.SUPERSEDED, why
    return stream_ends.let_go(Driven(station), serial, lease, ended, now_ns).station


def _superseded(station: Station, serial: str, why: str, now_ns: int) -> Station:
    """End the lives of the orders to move it that are not over."""
    book = station.orders
    for record in book.tracked:
        if record.command.serial == serial and lane_of(record.command) is Lane.MOTION:
            ended = orders.ended(record, Phase.SUPERSEDED, now_ns, why)
            book = orders.put(book, ended, station.settings.orders_kept)
    return replace(station, orders=book)
