"""Vehicle identity by serial: binds links to vehicles.

Theory of operation. A link is *unidentified* until its serial arrives in extended telemetry (1 to
2 Hz). The first link with a serial is *bound* to the vehicle. A second link with the same serial
is a *rival* (typically an app that reconnected while its old socket still looks alive):

- the bound link stays silent for `takeover_silence_s` after the rival's serial: the rival is
  bound, the old link is closed, and the vehicle keeps its history;
- the bound link delivers a packet: the two are in *conflict*. Only hold, land and return are sent,
  to both. The conflict ends when either link closes, or when the bound link has been silent for
  `conflict_silence_s` (longer than the telemetry gaps that video causes);
- the bound link closes: the oldest rival is bound, and the remaining ones start their wait again.

A link that reports another serial releases the old one first, and telemetry received under the old
serial stays with the old vehicle. Vehicles without a link are kept up to a limit; one that may be
flying is never forgotten, because it is a hazard until telemetry or an operator locates it.
"""

from collections.abc import Iterable
from dataclasses import replace

from recon.fleet.state import Fleet, LinkRecord
from recon.fleet.telemetry import with_newest_values
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState

SIMULATED_PREFIX = "SIM-"


def claim(fleet: Fleet, link_id: int, serial: str, now_ns: int) -> Fleet:
    """Return the fleet after a link reported its serial.

    At the limit of vehicles a new serial is rejected: the link stays unidentified, and its vehicle
    is an unidentified hazard.
    """
    link = fleet.links[link_id]
    if link.claimed_serial == serial:
        return fleet
    fleet = leave(fleet, link_id, now_ns)
    known = fleet.vehicles.get(serial)
    if known is None and is_full(fleet):
        unknown = replace(
            fleet.links[link_id],
            claimed_serial=None,
            rejected_serial=serial,
            waiting_serial=None,
            waits_since_ns=None,
        )
        return _put_link(fleet, unknown)
    is_bound = known is not None and known.link_id is not None
    fleet = _put_link(
        fleet,
        replace(
            fleet.links[link_id],
            claimed_serial=serial,
            rejected_serial=None,
            waiting_serial=None,
            waits_since_ns=None,
            rival_since_ns=now_ns if is_bound else None,
            in_conflict=False,
        ),
    )
    return _mark_rivals(fleet, serial) if is_bound else _bind(fleet, link_id, serial)


def leave(fleet: Fleet, link_id: int, now_ns: int) -> Fleet:
    """Return the fleet after a link ceased to claim a serial; nothing without one.

    Telemetry under the old serial belongs to the old vehicle.
    """
    link = fleet.links[link_id]
    if link.claimed_serial is None:
        return fleet
    return release(fleet, replace(link, own_state=_blank(link)), now_ns)


def packet_received(fleet: Fleet, link_id: int, received_at_ns: int) -> Fleet:
    """Return the fleet after a valid packet: from a bound link with rivals it is a conflict.

    A packet from before the rival reported the serial, withheld until now, does not count.
    """
    serial = fleet.links[link_id].claimed_serial
    vehicle = fleet.vehicles.get(serial or "")
    if vehicle is None or vehicle.link_id != link_id:
        return fleet
    rivals = [fleet.links[rival_id] for rival_id in vehicle.rival_link_ids]
    if vehicle.in_conflict and all(rival.in_conflict for rival in rivals):
        return fleet
    outlived = [rival for rival in rivals if (rival.rival_since_ns or 0) <= received_at_ns]
    for rival in outlived:
        fleet = _put_link(fleet, replace(rival, in_conflict=True))
    return _mark_rivals(fleet, vehicle.serial or "") if outlived else fleet


def release(fleet: Fleet, link: LinkRecord, now_ns: int) -> Fleet:
    """Return the fleet after a link closed or changed its serial."""
    serial = link.claimed_serial
    vehicle = fleet.vehicles.get(serial or "")
    if serial is None or vehicle is None:
        return fleet
    still = replace(link, claimed_serial=None, rival_since_ns=None, in_conflict=False)
    fleet = _put_link(fleet, still if link.is_open else replace(link, rival_since_ns=None))
    if vehicle.link_id != link.id:
        return _mark_rivals(fleet, serial)
    fleet = _put_vehicle(fleet, replace(vehicle, link_id=None))
    heirs = _rivals(fleet, serial)
    if not heirs:
        return _mark_rivals(fleet, serial)
    return _restart_rivals(_bind(fleet, heirs[0].id, serial), serial, now_ns)


def settle(fleet: Fleet, now_ns: int) -> tuple[Fleet, tuple[tuple[int, str], ...]]:
    """Return the fleet after due takeovers by rivals, and the links to close with reasons."""
    closing: list[tuple[int, str]] = []
    for vehicle in tuple(fleet.vehicles.values()):
        heir = _heir(fleet, vehicle, now_ns)
        if heir is None or vehicle.link_id is None or vehicle.serial is None:
            continue
        old = fleet.links[vehicle.link_id]
        closing.append((old.id, f"silent; {vehicle.serial} reconnected on link {heir.id}"))
        fleet = _put_link(fleet, replace(old, claimed_serial=None))
        fleet = _bind(fleet, heir.id, vehicle.serial)
        fleet = _restart_rivals(fleet, vehicle.serial, now_ns)
    return fleet, tuple(closing)


def forget_vehicles(fleet: Fleet) -> Fleet:
    """Return the fleet without the longest-silent unlinked vehicles beyond its limit.

    A vehicle that may be flying is never forgotten: it is a hazard until it is located.
    """
    excess = len(fleet.vehicles) - fleet.settings.vehicles_kept
    if excess <= 0:
        return fleet
    absent = sorted(
        (v for v in fleet.vehicles.values() if v.link_id is None and not may_fly(v)),
        key=lambda v: (v.serial in fleet.profiles, v.core_received_at_ns or 0),
    )
    return without(fleet, (vehicle.serial for vehicle in absent[:excess]))


def without(fleet: Fleet, serials: Iterable[str | None]) -> Fleet:
    """Return the fleet without some of its vehicles."""
    forgotten = set(serials)
    kept = {key: v for key, v in fleet.vehicles.items() if key not in forgotten}
    return replace(fleet, vehicles=kept)


def may_fly(vehicle: VehicleState) -> bool:
    """Return whether a vehicle reported flying, or telemetry without its flying state."""
    is_flying = vehicle.is_flying.value
    return is_flying is True or (is_flying is None and vehicle.core_received_at_ns is not None)


def is_full(fleet: Fleet) -> bool:
    """Return whether the limit of unlinked vehicles that may be flying is reached."""
    hazards = sum(v.link_id is None and may_fly(v) for v in fleet.vehicles.values())
    return hazards >= fleet.settings.vehicles_kept


def _heir(fleet: Fleet, vehicle: VehicleState, now_ns: int) -> LinkRecord | None:
    """The rival that takes over now, if any."""
    if vehicle.link_id is None or not vehicle.rival_link_ids:
        return None
    last_packet_ns = fleet.links[vehicle.link_id].last_packet_at_ns or 0
    settings = fleet.settings
    for rival in _rivals(fleet, vehicle.serial or ""):
        limit_s = settings.conflict_silence_s if rival.in_conflict else settings.takeover_silence_s
        quiet_since_ns = max(last_packet_ns, rival.rival_since_ns or 0)
        if now_ns - quiet_since_ns >= seconds_to_ns(limit_s):
            return rival
    return None


def _rivals(fleet: Fleet, serial: str) -> tuple[LinkRecord, ...]:
    """Open links that claim a serial without being bound to its vehicle, the oldest first."""
    vehicle = fleet.vehicles[serial]
    claiming: Iterable[LinkRecord] = (
        link
        for link in fleet.links.values()
        if link.is_open and link.claimed_serial == serial and link.id != vehicle.link_id
    )
    return tuple(sorted(claiming, key=lambda link: link.rival_since_ns or 0))


def _bind(fleet: Fleet, link_id: int, serial: str) -> Fleet:
    """Bind a link to its vehicle, which keeps its history."""
    link = fleet.links[link_id]
    known = fleet.vehicles.get(serial) or VehicleState(serial=serial)
    profile = fleet.profiles.get(serial)
    vehicle = replace(
        with_newest_values(known, link.own_state, fleet.settings),
        link_id=link_id,
        profile=profile,
        is_simulated=link.own_state.is_simulated or serial.startswith(SIMULATED_PREFIX),
    )
    bound = replace(link, own_state=_blank(link), rival_since_ns=None, in_conflict=False)
    fleet = _put_link(fleet, bound)
    return _mark_rivals(_put_vehicle(fleet, vehicle), serial)


def _restart_rivals(fleet: Fleet, serial: str, now_ns: int) -> Fleet:
    """The remaining rivals wait again, against the newly bound link."""
    for rival in _rivals(fleet, serial):
        fleet = _put_link(fleet, replace(rival, rival_since_ns=now_ns, in_conflict=False))
    return _mark_rivals(fleet, serial)


def _mark_rivals(fleet: Fleet, serial: str) -> Fleet:
    rivals = _rivals(fleet, serial)
    marked = replace(
        fleet.vehicles[serial],
        rival_link_ids=tuple(link.id for link in rivals),
        in_conflict=any(link.in_conflict for link in rivals),
    )
    return _put_vehicle(fleet, marked)


def _blank(link: LinkRecord) -> VehicleState:
    """An empty state for a link; only the mark of a simulated app is kept."""
    is_simulated = link.own_state.is_simulated
    return VehicleState(serial=None, link_id=link.id, is_simulated=is_simulated)


def _put_link(fleet: Fleet, link: LinkRecord) -> Fleet:
    return replace(fleet, links={**fleet.links, link.id: link})


def _put_vehicle(fleet: Fleet, vehicle: VehicleState) -> Fleet:
    return replace(fleet, vehicles={**fleet.vehicles, vehicle.serial or "": vehicle})
