"""Who may set each vehicle in motion. The only writer of `VehicleControl.authority`.

Taking over is explicit, and the pilot at the remote control always has priority. Nothing here
sends anything to a vehicle, and what waits unsent is withdrawn. What a vehicle was commanded to do
continues until its new holder orders another thing, but setpoint streams end at once (`stream_ends`
compares the holder at each packet).
"""

from dataclasses import replace

from recon.link.outbox import Lane, lane_of
from recon.model.command import Command, Phase, Refusal
from recon.model.control import AuthorityHolder, ControlAuthority, Intent
from recon.model.event import AuthorityTaken
from recon.station.control import intents
from recon.station.control.withdrawal import withdraw
from recon.station.state import orders
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.station import Station
from recon.station.state.steps import Output, Stepped, WithdrawMotion
from recon.station.steering import neutral_setpoint, stream_ends
from recon.station.steering.stream_ends import StreamUpdate

RULE = "authority"
PILOT = "pilot"


def refusal(station: Station, event: AuthorityTaken) -> Refusal | None:
    """Return why authority over a vehicle cannot change like this, else None."""
    vehicle = station.fleet.vehicles.get(event.serial)
    if vehicle is None:
        return Refusal(RULE, f"{event.serial} is unknown: no app has reported this serial")
    authority = station.control(event.serial).authority
    if event.holder is AuthorityHolder.GUIDANCE and authority.holder is AuthorityHolder.PILOT:
        return Refusal(
            RULE,
            f"{vehicle.display_name} is controlled by the pilot ({authority.reason}): take "
            "control first, then give it to guidance",
        )
    return None


def take(station: Station, event: AuthorityTaken, now_ns: int) -> Stepped:
    """Return the station with authority over a vehicle transferred, unless that is refused.

    A new holder gets nothing of the old one: what waits unsent is withdrawn; before a pilot gets
    the vehicle, stops that are still repeated too. A setpoint stream ends by `stream_ends`.
    """
    if refusal(station, event) is not None:
        return station, ()
    before = station.control(event.serial).authority
    given = "taken over by" if event.holder is AuthorityHolder.OPERATOR else "given by"
    authority = ControlAuthority(event.holder, event.by, now_ns, f"{given} {event.by}")
    station = _with_authority(station, event.serial, authority)
    if event.holder is before.holder:
        return station, ()
    is_pilots = event.holder is AuthorityHolder.PILOT
    why = f"control given to the {event.holder.value} by {event.by}"
    return withdraw(station, event.serial, why, now_ns, with_stops=is_pilots)


def after_stop(station: Station, command: Command, now_ns: int) -> Station:
    """Return the station after hold, land or return was ordered: guidance must not resume.

    The operator that stops a vehicle of guidance gets authority, also without telemetry.
    """
    target = station.target(command.serial, command.link_id)
    serial = None if target is None else target.serial
    if serial is None or not command.is_emergency or command.role is AuthorityHolder.GUIDANCE:
        return station
    if station.control(serial).authority.holder is not AuthorityHolder.GUIDANCE:
        return station
    authority = ControlAuthority(AuthorityHolder.OPERATOR, command.issued_by, now_ns, command.words)
    return _with_authority(station, serial, authority)


def give_to_pilot(
    station: Station, serial: str, now_ns: int, why: str = "the pilot has taken the sticks"
) -> tuple[Station, tuple[Output, ...]]:
    """Return the station after telemetry shows that a pilot flies a vehicle.

    Nothing is sent: its setpoint stream, its pending neutral setpoint and its queued packets end,
    and orders to move it end as superseded. Without effect when its pilot has authority already.
    """
    vehicle = station.fleet.vehicles.get(serial)
    if vehicle is None or station.control(serial).authority.holder is AuthorityHolder.PILOT:
        return station, ()
    authority = ControlAuthority(AuthorityHolder.PILOT, PILOT, now_ns, why)
    station = _with_authority(station, serial, authority)
    station = _without_setpoints(station, serial, why, now_ns)
    station = _superseded(station, serial, why, now_ns)
    station = intents.with_intent(station, serial, Intent(since_ns=now_ns))
    condition = Condition(
        key=f"pilot_took_over:{serial}",
        severity=Severity.WARNING,
        rule="pilot_took_over",
        vehicle_name=vehicle.display_name,
        text=f"{vehicle.display_name}: {why}; nothing is sent until an operator takes control",
        serial=serial,
        link_id=vehicle.link_id,
    )
    links = station.fleet.link_ids_claiming(serial)
    return station.with_alarm(condition, now_ns), (WithdrawMotion(links, why),)


def hand_back(station: Station, serial: str, to: str, why: str, now_ns: int) -> Station:
    """Return the station with authority passed from guidance to the operator."""
    if station.control(serial).authority.holder is not AuthorityHolder.GUIDANCE:
        return station
    authority = ControlAuthority(AuthorityHolder.OPERATOR, to, now_ns, why)
    return _with_authority(station, serial, authority)


def on_manual_flight(station: Station, serial: str, now_ns: int) -> Station:
    """Return the station after a vehicle moved in the air with nothing ordered.

    Its pilot has authority until it is taken. Authority that was taken stays: there the flight
    table shows the pilot.
    """
    if station.control(serial).is_taken:
        return station
    why = "in motion without an order: flown by its pilot"
    authority = ControlAuthority(AuthorityHolder.PILOT, PILOT, now_ns, why)
    return _with_authority(station, serial, authority)


def restore(
    station: Station, serial: str, holder: AuthorityHolder, holder_name: str, now_ns: int
) -> Station:
    """Return the station with the authority of the last run. Guidance does not get it back."""
    reason = f"the {holder.value} had control before the station was restarted"
    if holder is AuthorityHolder.GUIDANCE:
        holder, holder_name = AuthorityHolder.OPERATOR, ""
        reason = "guidance had control before the station was restarted"
    authority = ControlAuthority(holder, holder_name, now_ns, reason)
    return _with_authority(station, serial, authority)


def _with_authority(station: Station, serial: str, authority: ControlAuthority) -> Station:
    return station.with_control(serial, authority=authority)


def _without_setpoints(station: Station, serial: str, why: str, now_ns: int) -> Station:
    station = neutral_setpoint.cancel(station, serial)
    stream = station.control(serial).stream
    if stream is None:
        return station
    end = Phase.SUPERSEDED, why
    return stream_ends.end_silently(StreamUpdate(station), serial, stream, end, now_ns).station


def _superseded(station: Station, serial: str, why: str, now_ns: int) -> Station:
    """End the open orders to move a vehicle."""
    book = station.orders
    for record in book.tracked:
        if record.command.serial == serial and lane_of(record.command) is Lane.MOTION:
            ended = orders.ended(record, Phase.SUPERSEDED, now_ns, why)
            book = orders.put(book, ended, station.settings.orders_kept)
    return replace(station, orders=book)
