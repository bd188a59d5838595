"""The recovery snapshot: what must outlive the process, taken from a station, as checked JSON.

A snapshot file is untrusted input: every value has a range, every list a limit, and a snapshot
that violates one is rejected as a whole. Taking a snapshot therefore keeps within the same limits.
"""

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Annotated, Any

import msgspec

from recon.model.command import LIVING_PHASES, Phase, VirtualStick
from recon.model.control import AuthorityHolder
from recon.model.geo import LatLon
from recon.model.temporary_zone import (
    Circle,
    DrawnZone,
    Outline,
    TemporaryZone,
    TemporaryZoneKind,
)
from recon.model.vehicle import VehicleState
from recon.safety.temporary_zones import MOST_CORNERS, MOST_ZONES
from recon.station.state.orders import OrderRecord
from recon.station.state.station import Station
from recon.station.state.vehicle_control import (
    LARGEST_M,
    LARGEST_MPS,
    PositionSnapshot,
    VehicleSnapshot,
)
from recon.station.traffic import identity_grace
from recon.station.traffic.known_traffic import MANY_LOST, is_dismissed, lost_name

MAX_VEHICLES = 256
"""Four times what the fleet keeps of vehicles without a link."""
MAX_UNIDENTIFIED = 256
MAX_ORDERS = 200
MAX_ID = 2**52
"""Largest id: beyond it JavaScript, and so the console, could not tell two orders apart."""
MAX_TEXT = 200
"""Longest name typed by an operator; a serial is never cut."""

OrderId = Annotated[int, msgspec.Meta(ge=-MAX_ID, le=MAX_ID)]


class AuthoritySnapshot(msgspec.Struct, frozen=True):
    """The authority holder of one vehicle."""

    holder: AuthorityHolder
    holder_name: str = ""


class StopLatchSnapshot(msgspec.Struct, frozen=True):
    """The all stop in force."""

    by: str
    at_ns: int
    released: Annotated[list[str], msgspec.Meta(max_length=MAX_VEHICLES)] = msgspec.field(
        default_factory=list
    )


class PlaceSnapshot(msgspec.Struct, frozen=True):
    """A place on the globe."""

    latitude_deg: Annotated[float, msgspec.Meta(ge=-90.0, le=90.0)]
    longitude_deg: Annotated[float, msgspec.Meta(ge=-180.0, le=180.0)]


class TemporaryZoneSnapshot(msgspec.Struct, frozen=True, kw_only=True):
    """A temporary zone in force: a circle of `radius_m` round its one corner, or an outline."""

    id: Annotated[int, msgspec.Meta(ge=1, le=MAX_ID)]
    kind: TemporaryZoneKind
    corners: Annotated[list[PlaceSnapshot], msgspec.Meta(min_length=1, max_length=MOST_CORNERS)]
    radius_m: float | None = None
    floor_m: float | None = None
    ceiling_m: float | None = None
    reason: str
    by: str
    drawn_at_ns: int
    ends_at_ns: int | None = None


class OrderSnapshot(msgspec.Struct, frozen=True, kw_only=True):
    """An order that has not ended. `body` is the command body as JSON, typed by `order`."""

    id: OrderId
    order: str
    body: dict[str, Any]
    phase: Phase
    issued_by: str
    issued_at_ns: int
    serial: str | None
    vehicle_name: str
    takeoff: bool


class RecoverySnapshot(msgspec.Struct, frozen=True, kw_only=True):
    """What a restart restores. Times are station time in nanoseconds.

    `vehicles` holds by serial those that fly or may; `unidentified` those without a serial, by the
    name that dismisses their hazard area.
    """

    taken_at_ns: int
    last_order_id: Annotated[int, msgspec.Meta(ge=0, le=MAX_ID)] = 0
    next_own_id: Annotated[int, msgspec.Meta(ge=-MAX_ID, le=-1)] = -1
    stop_latch: StopLatchSnapshot | None = None
    """Absent in files of version 1."""
    temporary_zones: Annotated[list[TemporaryZoneSnapshot], msgspec.Meta(max_length=MOST_ZONES)] = (
        msgspec.field(default_factory=list)
    )
    next_zone_id: Annotated[int, msgspec.Meta(ge=1, le=MAX_ID)] = 1
    authorities: Annotated[dict[str, AuthoritySnapshot], msgspec.Meta(max_length=MAX_VEHICLES)] = (
        msgspec.field(default_factory=dict)
    )
    vehicles: Annotated[dict[str, VehicleSnapshot], msgspec.Meta(max_length=MAX_VEHICLES)] = (
        msgspec.field(default_factory=dict)
    )
    unidentified: Annotated[
        dict[str, VehicleSnapshot], msgspec.Meta(max_length=MAX_UNIDENTIFIED)
    ] = msgspec.field(default_factory=dict)
    orders: Annotated[list[OrderSnapshot], msgspec.Meta(max_length=MAX_ORDERS)] = msgspec.field(
        default_factory=list
    )


def encode_snapshot(snapshot: RecoverySnapshot) -> bytes:
    """Return a snapshot as JSON."""
    return msgspec.json.encode(snapshot)


def decode_snapshot(data: bytes) -> RecoverySnapshot:
    """Return the snapshot; raises ValueError when a value is missing or out of range."""
    try:
        return msgspec.json.decode(data, type=RecoverySnapshot)
    except (msgspec.DecodeError, UnicodeError, RecursionError, OverflowError) as problem:
        raise ValueError(str(problem)) from problem


def take_snapshot(station: Station, now_ns: int, last_order_id: int = 0) -> RecoverySnapshot:
    """Return what must outlive the process; `last_order_id` as in the snapshot before."""
    flying = [
        (serial, vehicle)
        for serial, vehicle in station.fleet.vehicles.items()
        if vehicle.is_flying.value is not False and not is_dismissed(station, vehicle)
    ]
    unidentified = list(_unidentified(station, now_ns))
    excess = flying[MAX_VEHICLES:] + unidentified[MAX_UNIDENTIFIED - 1 :]
    kept = dict(unidentified[: MAX_UNIDENTIFIED - 1])
    if excess:
        # Too many to tell apart: one vehicle that may be anywhere stands for the rest.
        kept[MANY_LOST] = excess[0][1]
    return RecoverySnapshot(
        taken_at_ns=now_ns,
        last_order_id=max(last_order_id, *station.orders.records, *station.surveys.records, 0),
        next_own_id=station.next_own_id,
        stop_latch=_stop_latch(station),
        temporary_zones=[zone_snapshot(zone) for zone in station.temporary_zones.in_force.values()],
        next_zone_id=station.temporary_zones.next_id,
        authorities=dict(islice(_authorities(station), MAX_VEHICLES)),
        vehicles={serial: vehicle_snapshot(vehicle) for serial, vehicle in flying[:MAX_VEHICLES]},
        unidentified={name: vehicle_snapshot(vehicle) for name, vehicle in kept.items()},
        orders=[_order(record) for record in open_orders(station)][-MAX_ORDERS:],
    )


def open_orders(station: Station) -> Iterator[OrderRecord]:
    """Yield the orders that have not ended, without single setpoints of a stick stream."""
    for record in station.orders.tracked:
        if record.phase in LIVING_PHASES and not isinstance(record.command.body, VirtualStick):
            yield record


def vehicle_snapshot(vehicle: VehicleState) -> VehicleSnapshot:
    """Return a vehicle's last telemetry; a value outside the snapshot's range as unknown."""
    velocity = vehicle.velocity_ned.value
    return VehicleSnapshot(
        received_at_ns=vehicle.core_received_at_ns or 0,
        is_flying=vehicle.is_flying.value,
        is_simulated=vehicle.is_simulated,
        position=_position(vehicle.position.value),
        height_above_takeoff_m=_metres(vehicle.height_above_takeoff_m.value),
        velocity_north_mps=None if velocity is None else _speed(velocity.north_mps),
        velocity_east_mps=None if velocity is None else _speed(velocity.east_mps),
        velocity_down_mps=None if velocity is None else _speed(velocity.down_mps),
        battery_fraction=_within(vehicle.battery_fraction.value, 0.0, 1.0),
        altitude_offset_m=_metres(vehicle.altitude_offset_m.value),
        takeoff_point=_position(vehicle.takeoff_point),
        altitude_offset_at_takeoff_m=_metres(vehicle.altitude_offset_at_takeoff_m),
    )


def _unidentified(station: Station, now_ns: int) -> Iterable[tuple[str, VehicleState]]:
    """Lost vehicles without a serial, and open links whose grace for reporting one is over."""
    yield from station.watchdog_state.lost.items()
    for link in station.fleet.unbound_links():
        state = link.own_state
        if link.claimed_serial is not None or state.is_flying.value is not True:
            continue
        if link.id not in station.watchdog_state.unidentified_since_ns:
            continue
        if not identity_grace.may_yet_report_serial(station, state, now_ns):
            yield lost_name(link.id), state


def _stop_latch(station: Station) -> StopLatchSnapshot | None:
    """A release beyond the limit is excluded: that vehicle is latched again."""
    latch = station.stop_latch
    if latch is None:
        return None
    released = sorted(latch.released)[:MAX_VEHICLES]
    return StopLatchSnapshot(latch.by[:MAX_TEXT], latch.at_ns, released)


def zone_snapshot(zone: TemporaryZone) -> TemporaryZoneSnapshot:
    """Return a temporary zone for the snapshot."""
    drawn, shape = zone.drawn, zone.drawn.shape
    corners = (shape.centre,) if isinstance(shape, Circle) else shape.corners
    return TemporaryZoneSnapshot(
        id=zone.id,
        kind=drawn.kind,
        corners=[PlaceSnapshot(each.latitude_deg, each.longitude_deg) for each in corners],
        radius_m=shape.radius_m if isinstance(shape, Circle) else None,
        floor_m=drawn.floor_m,
        ceiling_m=drawn.ceiling_m,
        reason=drawn.reason,
        by=zone.by[:MAX_TEXT],
        drawn_at_ns=zone.drawn_at_ns,
        ends_at_ns=zone.ends_at_ns,
    )


def restored_zone(saved: TemporaryZoneSnapshot) -> TemporaryZone:
    """Return the temporary zone of a snapshot; whether it can be used is for `restore` to judge."""
    corners = tuple(LatLon(each.latitude_deg, each.longitude_deg) for each in saved.corners)
    shape = Outline(corners) if saved.radius_m is None else Circle(corners[0], saved.radius_m)
    drawn = DrawnZone(saved.kind, shape, saved.reason, saved.floor_m, saved.ceiling_m)
    return TemporaryZone(saved.id, drawn, saved.by, saved.drawn_at_ns, saved.ends_at_ns)


def _authorities(station: Station) -> Iterator[tuple[str, AuthoritySnapshot]]:
    """Pilots first: they are kept when the limit is reached."""
    taken = (item for item in station.controls.items() if item[1].is_taken)
    held = sorted(
        ((serial, control.authority) for serial, control in taken),
        key=lambda item: item[1].holder is not AuthorityHolder.PILOT,
    )
    for serial, authority in held:
        yield serial, AuthoritySnapshot(authority.holder, authority.holder_name[:MAX_TEXT])


def _order(record: OrderRecord) -> OrderSnapshot:
    command = record.command
    return OrderSnapshot(
        id=command.id,
        order=command.name,
        body=msgspec.to_builtins(command.body),
        phase=record.phase,
        issued_by=command.issued_by[:MAX_TEXT],
        issued_at_ns=command.issued_at_ns,
        serial=command.serial,
        vehicle_name=record.vehicle_name,
        takeoff=command.takeoff,
    )


def _position(point: LatLon | None) -> PositionSnapshot | None:
    if point is None or not point.is_valid():
        return None
    return PositionSnapshot(point.latitude_deg, point.longitude_deg)


def _metres(value: float | None) -> float | None:
    return _within(value, -LARGEST_M, LARGEST_M)


def _speed(value: float | None) -> float | None:
    return _within(value, -LARGEST_MPS, LARGEST_MPS)


def _within(value: float | None, least: float, most: float) -> float | None:
    """Return the value, or None when it is unknown, NaN or out of range."""
    return value if value is not None and least <= value <= most else None
