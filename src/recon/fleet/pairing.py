"""Pairing: links whose app no entry of the list admits, and what an operator decides about them.

Theory of operation.

    link --serial that the list admits--> identified (`fleet.identity`)
         --another serial, or an address from which none is admitted--> waiting
    waiting --admitted, or its serial is admitted now--> identified
            --refused--> closed, and again for `refusal_s` whenever it waits

A waiting link is no vehicle and never becomes a rival of one, so that a false serial takes nothing
from the real aircraft. Its telemetry stays with the link: it is traffic that others keep clear of,
because an aircraft turned away would be in the air all the same. Beyond `waiting_links_kept` the
newest waiting link is closed, one that does not report flight first.
"""

from dataclasses import replace

from recon.fleet import identity
from recon.fleet.admission import (
    MAX_ENTRIES,
    NOT_LISTED,
    AllowedApp,
    address_of,
    host_of,
    network_of_one,
)
from recon.fleet.state import Fleet, LinkRecord
from recon.model.command import Refusal
from recon.model.event import AppAdmitted, AppRefused
from recon.model.units import seconds_to_ns

RULE = "pairing"

Closing = tuple[tuple[int, str], ...]


def opened(link: LinkRecord, fleet: Fleet, now_ns: int) -> LinkRecord:
    """Return a new link; it waits already when no serial is admitted from its address."""
    if fleet.admission.may_admit(address_of(link.remote_address)):
        return link
    return replace(link, waits_since_ns=now_ns)


def report_serial(fleet: Fleet, link_id: int, serial: str, now_ns: int) -> Fleet:
    """Return the fleet after a link reported a serial: its vehicle's link, or a waiting one."""
    link = fleet.links[link_id]
    if link.claimed_serial == serial:
        return fleet
    if fleet.admission.objection(serial, address_of(link.remote_address)) is None:
        return identity.claim(fleet, link_id, serial, now_ns)
    if link.waiting_serial == serial:
        return fleet
    fleet = identity.leave(fleet, link_id, now_ns)
    link = fleet.links[link_id]
    since_ns = now_ns if link.waits_since_ns is None else link.waits_since_ns
    waiting = replace(link, waiting_serial=serial, waits_since_ns=since_ns, rejected_serial=None)
    return replace(fleet, links={**fleet.links, link_id: waiting})


def objection(fleet: Fleet, link: LinkRecord) -> str:
    """Return why a waiting link is not admitted."""
    if link.waiting_serial is None:
        return "its address is not on the list"
    address = address_of(link.remote_address)
    return fleet.admission.objection(link.waiting_serial, address) or NOT_LISTED


def refusal_to_admit(fleet: Fleet, event: AppAdmitted) -> Refusal | None:
    """Return why an app cannot be admitted like this, else None."""
    link = fleet.links.get(event.link_id)
    if link is None or not link.is_waiting:
        return _not_waiting(event.link_id)
    if link.waiting_serial is None:
        return Refusal(
            RULE, f"The app on link {link.id} has not reported a serial; wait until it does"
        )
    if link.waiting_serial != event.serial:
        return Refusal(
            RULE,
            f"The app on link {link.id} now reports serial {link.waiting_serial}, not "
            f"{event.serial}; check which aircraft it is",
        )
    if not (event.serial.isascii() and event.serial.isprintable()) or " " in event.serial:
        return Refusal(RULE, f"Serial {event.serial!a} must be printable ASCII without spaces")
    if not event.any_address and address_of(link.remote_address) is None:
        return Refusal(
            RULE, f"{link.remote_address} is no IP address; admit the serial from any address"
        )
    kept = (fleet.admission.listed or ()) if event.is_for_good else fleet.admission.session
    if len(kept) >= MAX_ENTRIES:
        return Refusal(RULE, f"The list has {MAX_ENTRIES} entries, limit {MAX_ENTRIES}")
    return None


def admit(fleet: Fleet, event: AppAdmitted, now_ns: int) -> Fleet:
    """Return the fleet with an app admitted, unless that is refused.

    For good: the new entry replaces the entries of this serial.
    """
    if refusal_to_admit(fleet, event) is not None:
        return fleet
    link = fleet.links[event.link_id]
    address = address_of(link.remote_address)
    network = None if event.any_address or address is None else network_of_one(address)
    entry = AllowedApp(event.serial, network)
    admission = fleet.admission
    if event.is_for_good:
        others = tuple(e for e in admission.listed or () if e.serial != event.serial)
        admission = replace(admission, listed=(*others, entry))
    else:
        admission = replace(admission, session=(*admission.session, entry))
    return report_serial(replace(fleet, admission=admission), link.id, event.serial, now_ns)


def refusal_to_refuse(fleet: Fleet, event: AppRefused) -> Refusal | None:
    """Return why an app cannot be refused, else None."""
    link = fleet.links.get(event.link_id)
    return None if link is not None and link.is_waiting else _not_waiting(event.link_id)


def refuse(fleet: Fleet, event: AppRefused, now_ns: int) -> tuple[Fleet, Closing]:
    """Return the fleet with a waiting app refused for a while, and its link to close."""
    if refusal_to_refuse(fleet, event) is not None:
        return fleet, ()
    link, kept = fleet.links[event.link_id], dict(fleet.admission.refused_until_ns)
    kept[_key(link)] = now_ns + seconds_to_ns(fleet.settings.refusal_s)
    newest = dict(list(kept.items())[-fleet.settings.refusals_kept :])
    fleet = replace(fleet, admission=replace(fleet.admission, refused_until_ns=newest))
    return fleet, ((link.id, f"refused by {event.by}"),)


def is_refused(fleet: Fleet, link: LinkRecord) -> bool:
    """Return whether an operator has refused what waits on this link."""
    return link.is_waiting and _key(link) in fleet.admission.refused_until_ns


def settle(fleet: Fleet, now_ns: int) -> tuple[Fleet, Closing]:
    """Return the fleet without refusals that are over, and the waiting links to close."""
    if not fleet.admission.is_in_force:
        return fleet, ()
    fleet = _without_old_refusals(fleet, now_ns)
    waiting = [link for link in fleet.links.values() if link.is_waiting]
    closing = [
        (link.id, "refused by an operator a moment ago")
        for link in waiting
        if is_refused(fleet, link) and _has_had_time(fleet, link, now_ns)
    ]
    limit = fleet.settings.waiting_links_kept
    if len(waiting) - len(closing) > limit:
        waiting.sort(key=lambda link: (link.own_state.is_flying.value is not True, link.id))
        reason = f"more than {limit} apps wait to be admitted"
        closing += [(link.id, reason) for link in waiting[limit:]]
    return fleet, tuple(dict(closing).items())


def _has_had_time(fleet: Fleet, link: LinkRecord, now_ns: int) -> bool:
    """Whether a link without a serial has had the time to report one."""
    wait_ns = seconds_to_ns(fleet.settings.refused_serial_wait_s)
    return link.waiting_serial is not None or now_ns - link.opened_at_ns >= wait_ns


def _without_old_refusals(fleet: Fleet, now_ns: int) -> Fleet:
    refused = fleet.admission.refused_until_ns
    if all(until_ns > now_ns for until_ns in refused.values()):
        return fleet
    left = {key: until_ns for key, until_ns in refused.items() if until_ns > now_ns}
    return replace(fleet, admission=replace(fleet.admission, refused_until_ns=left))


def _key(link: LinkRecord) -> tuple[str, str]:
    return host_of(link.remote_address), link.waiting_serial or ""


def _not_waiting(link_id: int) -> Refusal:
    return Refusal(RULE, f"Link {link_id} does not wait: it is closed, admitted or unknown")
