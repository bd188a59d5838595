"""Control of a vehicle changes hands: between holders, and from one person to another.

`authority` decides about holders, `operator_lease` about persons. What the person before steered
ends: neutral setpoint, then hold. A mission continues until the new person orders another thing, as
with every change of the holder; its next part is refused, and then the vehicle holds.
"""

from recon.model.command import Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken
from recon.station.control import authority, operator_lease, order_gateway
from recon.station.control.withdrawal import withdraw
from recon.station.state.station import Station
from recon.station.state.steps import Output, Stepped


def refusal(station: Station, event: AuthorityTaken, now_ns: int) -> Refusal | None:
    """Return why control cannot change like this, else None.

    A pilot is given the vehicle by any person. For everything else it must be free, or operated by
    that person already, or taken over explicitly.
    """
    refused = authority.refusal(station, event)
    if refused is not None or event.holder is AuthorityHolder.PILOT or event.takes_over:
        return refused
    return operator_lease.refusal(station, event.serial, event.person, now_ns)


def take(station: Station, event: AuthorityTaken, now_ns: int) -> Stepped:
    """Return the station with control transferred, unless that is refused."""
    if refusal(station, event, now_ns) is not None:
        return station, ()
    is_taken_over = operator_lease.is_another_persons(station, event.serial, event.person)
    withdrawn: tuple[Output, ...] = ()
    why = f"taken over by {event.by}"
    if is_taken_over:
        station, withdrawn = withdraw(station, event.serial, why, now_ns)
    station, outputs = authority.take(station, event, now_ns)
    if event.holder is AuthorityHolder.PILOT:
        station = operator_lease.release(station, event.serial, event.person, now_ns)
        return station, (*withdrawn, *outputs)
    station = operator_lease.assign(station, event.serial, event.person, now_ns)
    ended: tuple[Output, ...] = ()
    if is_taken_over:
        station, ended = order_gateway.end_streams(station, (event.serial,), why, now_ns)
    return station, (*withdrawn, *outputs, *ended)
