"""The fleet's step: opens and closes links, applies reports, resolves identities."""

from dataclasses import dataclass

from recon.fleet import identity, pairing
from recon.fleet.app_facts import fold_facts, fold_photos
from recon.fleet.link_quality import after_arrival
from recon.fleet.state import Fleet, LinkRecord
from recon.fleet.telemetry import fold_core, fold_extended
from recon.fleet.trust import after_gap
from recon.model.app_report import AppFacts, PhotosReport
from recon.model.event import (
    AppAdmitted,
    AppRefused,
    ClockGap,
    Event,
    LinkClosed,
    LinkOpened,
    PacketReceived,
    Tick,
)
from recon.model.replacing import replace
from recon.model.report import (
    CoreReport,
    ExtendedReport,
    IgnoredReport,
    ImageReport,
    MessageReport,
    Report,
)
from recon.model.vehicle import VehicleState

SIMULATOR_GREETING = "recon-sim simulated vehicle"
"""First message of a simulated app; its serial's prefix marks it too."""


@dataclass(frozen=True, slots=True)
class CloseLink:
    """Output: close a connection, with the reason."""

    link_id: int
    reason: str


def step(fleet: Fleet, event: Event, now_ns: int) -> tuple[Fleet, tuple[CloseLink, ...]]:
    """Return the fleet after an event, and the links to close. Pure."""
    match event:
        case LinkOpened(link_id, remote_address):
            return _opened(fleet, link_id, remote_address, now_ns), ()
        case LinkClosed(link_id, reason):
            return _closed(fleet, link_id, reason, now_ns), ()
        case PacketReceived(link_id, report) if _is_open(fleet, link_id):
            return _received(fleet, link_id, report, event.received_at_ns(now_ns), now_ns), ()
        case ClockGap():
            return _after_gap(fleet, now_ns), ()
        case Tick():
            fleet, silent = identity.settle(fleet, now_ns)
            fleet, waiting = pairing.settle(fleet, now_ns)
            return fleet, tuple(CloseLink(*item) for item in (*silent, *waiting))
        case AppAdmitted():
            return identity.forget_vehicles(pairing.admit(fleet, event, now_ns)), ()
        case AppRefused():
            fleet, refused = pairing.refuse(fleet, event, now_ns)
            return fleet, tuple(CloseLink(*item) for item in refused)
    return fleet, ()


def _after_gap(fleet: Fleet, now_ns: int) -> Fleet:
    settings = fleet.settings.trust
    vehicles = {
        serial: after_gap(vehicle, now_ns, settings) for serial, vehicle in fleet.vehicles.items()
    }
    links = {
        link_id: replace(link, own_state=after_gap(link.own_state, now_ns, settings))
        for link_id, link in fleet.links.items()
    }
    return replace(fleet, vehicles=vehicles, links=links)


def _is_open(fleet: Fleet, link_id: int) -> bool:
    link = fleet.links.get(link_id)
    return link is not None and link.is_open


def _opened(fleet: Fleet, link_id: int, remote_address: str, now_ns: int) -> Fleet:
    if _is_open(fleet, link_id):
        return fleet  # ids are unique: opening one again must not unbind its vehicle
    link = LinkRecord(
        id=link_id,
        remote_address=remote_address,
        opened_at_ns=now_ns,
        own_state=VehicleState(serial=None, link_id=link_id),
    )
    link = pairing.opened(link, fleet, now_ns)
    return replace(fleet, links={**fleet.links, link_id: link})


def _closed(fleet: Fleet, link_id: int, reason: str, now_ns: int) -> Fleet:
    link = fleet.links.get(link_id)
    if link is None or not link.is_open:
        return fleet
    gone = replace(link, closed_at_ns=now_ns, closed_reason=reason)
    links = _forget_oldest({**fleet.links, link_id: gone}, fleet.settings.closed_links_kept)
    return identity.release(replace(fleet, links=links), gone, now_ns)


def _forget_oldest(links: dict[int, LinkRecord], kept: int) -> dict[int, LinkRecord]:
    closed = sorted(
        (link for link in links.values() if link.closed_at_ns is not None),
        key=lambda link: link.closed_at_ns or 0,
    )
    forgotten = {link.id for link in closed[: max(0, len(closed) - kept)]}
    return {key: link for key, link in links.items() if key not in forgotten}


def _received(
    fleet: Fleet, link_id: int, report: Report, received_at_ns: int, now_ns: int
) -> Fleet:
    fleet = _count(fleet, link_id, report, received_at_ns)
    fleet = identity.packet_received(fleet, link_id, received_at_ns)
    if isinstance(report, ExtendedReport) and report.serial is not None:
        fleet = pairing.report_serial(fleet, link_id, report.serial, now_ns)
        fleet = identity.forget_vehicles(fleet)
    return _fold(fleet, link_id, report, received_at_ns)


def _count(fleet: Fleet, link_id: int, report: Report, received_at_ns: int) -> Fleet:
    link = fleet.links[link_id]
    counted = replace(
        link,
        last_packet_at_ns=received_at_ns,
        packets=link.packets + 1,
        images=link.images + isinstance(report, ImageReport),
        ignored_reports=link.ignored_reports + isinstance(report, IgnoredReport),
        arrivals=after_arrival(link.arrivals, received_at_ns)
        if isinstance(report, CoreReport)
        else link.arrivals,
    )
    return replace(fleet, links={**fleet.links, link_id: counted})


def _fold(fleet: Fleet, link_id: int, report: Report, received_at_ns: int) -> Fleet:
    state = fleet.vehicle_of_link(link_id)
    if state is None or _has_newer(state, report, received_at_ns):
        return fleet
    match report:
        case CoreReport():
            return _put(fleet, link_id, fold_core(state, report, received_at_ns, fleet.settings))
        case ExtendedReport():
            extended = fold_extended(state, report, received_at_ns, fleet.settings)
            return _put(fleet, link_id, extended)
        case ImageReport():
            counted = replace(
                state, image_received_at_ns=received_at_ns, image_count=state.image_count + 1
            )
            return _put(fleet, link_id, counted)
        case AppFacts():
            return _put(fleet, link_id, fold_facts(state, report, received_at_ns))
        case PhotosReport():
            return _put(fleet, link_id, fold_photos(state, report, received_at_ns))
        case MessageReport(_, text) if text == SIMULATOR_GREETING:
            fleet = _put(fleet, link_id, replace(state, is_simulated=True))
            return _remember_simulated(fleet, link_id)
    return fleet


def _has_newer(state: VehicleState, report: Report, received_at_ns: int) -> bool:
    """Whether another link has brought newer telemetry than a packet withheld on this one."""
    match report:
        case CoreReport():
            known_ns = state.core_received_at_ns
        case ExtendedReport():
            known_ns = state.extended_received_at_ns
        case ImageReport():
            known_ns = state.image_received_at_ns
        case AppFacts():
            known_ns = state.app_facts.received_at_ns
        case _:
            return False
    return known_ns is not None and received_at_ns < known_ns


def _remember_simulated(fleet: Fleet, link_id: int) -> Fleet:
    """The greeting concerns the app, not the vehicle: the link keeps it."""
    link = fleet.links[link_id]
    own_state = replace(link.own_state, is_simulated=True)
    return replace(fleet, links={**fleet.links, link_id: replace(link, own_state=own_state)})


def _put(fleet: Fleet, link_id: int, state: VehicleState) -> Fleet:
    if state.serial is not None:
        return replace(fleet, vehicles={**fleet.vehicles, state.serial: state})
    link = replace(fleet.links[link_id], own_state=state)
    return replace(fleet, links={**fleet.links, link_id: link})
