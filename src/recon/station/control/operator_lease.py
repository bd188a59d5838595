"""Which person operates each vehicle. The only writer of `VehicleControl.lease`.

Theory of operation.

    free --a person moves it, takes control, starts a survey or fleet return--> that person's
    that person's --released to its pilot--> free
                  --no stream of that person and no order for `lease_absent_s`--> free
                  --another person takes over, explicitly--> that one's, with an alarm for both

Orders of the station itself and of programs without a person operate nothing. A stop needs no lease
and takes none. The lease is not restored after a restart: the next order to move takes it.
"""

from collections.abc import Mapping

from recon.model.command import Command, Refusal
from recon.model.control import AuthorityHolder, OperatorLease
from recon.model.event import PersonConnected, PersonDisconnected
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.safety.rules.operator_lease import held_by_another
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.station import Presence, Station
from recon.station.state.steps import Stepped

PERSONS_KEPT = 256
"""Persons whose absence is remembered; the API has fewer streams than this."""


def refusal(station: Station, serial: str, person: str, now_ns: int) -> Refusal | None:
    """Return why a person cannot operate a vehicle now, else None: another one does."""
    lease = station.control(serial).lease
    if lease is None or lease.person == person:
        return None
    vehicle = station.fleet.vehicles.get(serial)
    return held_by_another(serial if vehicle is None else vehicle.display_name, lease, now_ns)


def is_another_persons(station: Station, serial: str, person: str) -> bool:
    """Return whether someone else than this person operates a vehicle."""
    lease = station.control(serial).lease
    return lease is not None and lease.person != person


def after_order(station: Station, command: Command, now_ns: int) -> Station:
    """Return the station after an order was accepted: one to move gives its person the vehicle."""
    if command.serial is None or not command.moves:
        return station
    if command.role is not AuthorityHolder.OPERATOR:
        return station
    return assign(station, command.serial, command.person, now_ns)


def assign(station: Station, serial: str, person: str, now_ns: int) -> Station:
    """Return the station with a vehicle assigned to a person: newly, still, or from another."""
    if not person:
        return station
    lease = station.control(serial).lease
    if lease is not None and lease.person == person:
        return station.with_control(serial, lease=replace(lease, ordered_at_ns=now_ns))
    if lease is not None:
        station = _with_alarm(
            station, serial, lease, f"taken over by {person} from {lease.person}", now_ns
        )
    return station.with_control(serial, lease=OperatorLease(person, now_ns, now_ns))


def release(station: Station, serial: str, person: str, now_ns: int) -> Station:
    """Return the station without a lease; with an alarm if another person ended it."""
    lease = station.control(serial).lease
    if lease is None:
        return station
    if lease.person != person:
        why = f"given to its pilot by {person}; {lease.person} no longer operates it"
        station = _with_alarm(station, serial, lease, why, now_ns)
    return station.with_control(serial, lease=None)


def connected(station: Station, event: PersonConnected, _now_ns: int) -> Station:
    """Count a stream that a person opened."""
    streams = station.persons.get(event.person, Presence()).streams + 1
    return _with_person(station, event.person, Presence(streams))


def disconnected(station: Station, event: PersonDisconnected, now_ns: int) -> Station:
    """Count a stream of a person that closed."""
    streams = station.persons.get(event.person, Presence()).streams - 1
    left = Presence(max(0, streams), None if streams > 0 else now_ns)
    return _with_person(station, event.person, left)


def settle(station: Station, now_ns: int) -> Stepped:
    """End the leases of persons that are gone for too long."""
    absent_ns = seconds_to_ns(station.settings.lease_absent_s)
    for serial, control in station.controls.items():
        lease = control.lease
        if lease is None:
            continue
        since_ns = absent_since_ns(station, lease)
        if since_ns is not None and now_ns - since_ns >= absent_ns:
            station = station.with_control(serial, lease=None)
    return station, ()


def absent_since_ns(station: Station, lease: OperatorLease) -> int | None:
    """Return since when a lease's person is absent: the last stream closed, or the last order.

    None while a stream of that person is open.
    """
    presence = station.persons.get(lease.person, Presence())
    if presence.streams > 0:
        return None
    return max(lease.ordered_at_ns, presence.left_at_ns or 0)


def _with_person(station: Station, person: str, presence: Presence) -> Station:
    others = {name: p for name, p in station.persons.items() if name != person}
    persons: Mapping[str, Presence] = {**others, person: presence}
    if len(persons) > PERSONS_KEPT:
        holders = {c.lease.person for c in station.controls.values() if c.lease is not None}
        persons = {n: p for n, p in persons.items() if p.streams > 0 or n in holders}
    return replace(station, persons=persons)


def _with_alarm(
    station: Station, serial: str, lease: OperatorLease, what: str, now_ns: int
) -> Station:
    """Both consoles show it until it is acknowledged."""
    vehicle = station.fleet.vehicles.get(serial)
    name = serial if vehicle is None else vehicle.display_name
    condition = Condition(
        key=f"lease_ended:{serial}:{lease.person}",
        severity=Severity.WARNING,
        rule="lease_ended",
        vehicle_name=name,
        text=f"{name}: {what}",
        serial=serial,
    )
    return station.with_alarm(condition, now_ns)
