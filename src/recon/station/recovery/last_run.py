"""What the audit of the last run tells a new start. The file may be damaged, huge or made up: every
value is checked, everything is bounded, and what does not fit is left out."""

from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import msgspec

from recon.model.authority import AuthorityHolder
from recon.model.command import BODY_NAMES, Body, Phase
from recon.record.audit import STARTED_KIND, STOPPED_KIND, AuditLine
from recon.station.audit.unidentified_snapshots import UNIDENTIFIED_GONE_KIND, UNIDENTIFIED_KIND
from recon.station.audit.vehicle_snapshots import SIGHTING_KINDS
from recon.station.state.vehicle_snapshot import VehicleSnapshot
from recon.station.traffic.known_traffic import MANY_LOST

MOST_VEHICLES = 256
MOST_NAMELESS = 256
MOST_ORDERS = 200
LARGEST_ID = 2**52
"""Beyond it a JavaScript number, and so the console, could not tell two orders apart."""

_KINDS_WITH_IDS = ("order.", "sticks.", "fleet_return.", "vehicle.", STARTED_KIND)

_BODIES = {name: kind for kind, name in BODY_NAMES.items()}

Id = Annotated[int, msgspec.Meta(ge=-LARGEST_ID, le=LARGEST_ID)]


class _Order(msgspec.Struct):
    id: Id
    phase: Phase
    body: dict[str, Any] | None = None
    order: str = ""
    takeoff: bool = False
    link_id: int | None = None


class _Lead(msgspec.Struct):
    holder: AuthorityHolder
    holder_name: str = ""


class _Name(msgspec.Struct):
    name: Annotated[str, msgspec.Meta(min_length=1, max_length=80)]


class _Ids(msgspec.Struct):
    id: Id = 0
    first_id: Id = 0
    count: Annotated[int, msgspec.Meta(ge=0, le=1_000_000)] = 0
    last_command_id: Id = 0
    next_own_id: Id = 0


@dataclass(frozen=True, slots=True)
class OpenOrder:
    """An order whose life had not ended."""

    id: int
    body: Body
    phase: Phase
    by: str
    serial: str | None
    link_id: int | None
    vehicle: str
    takeoff: bool
    given_at_ns: int


@dataclass(slots=True)
class LastRun:
    """Collects what the lines tell, the oldest first."""

    sightings: dict[str, VehicleSnapshot] = field(default_factory=dict)
    unidentified: dict[str, VehicleSnapshot] = field(default_factory=dict)
    """What flew without a serial, by what its hazard area is dismissed by."""
    authorities: dict[str, tuple[AuthorityHolder, str]] = field(default_factory=dict)
    orders: dict[int, OpenOrder] = field(default_factory=dict)
    last_id: int = 0
    least_own_id: int = 0
    last_at_ns: int | None = None
    lines: int = 0
    was_stopped: bool = False

    def take(self, line: AuditLine) -> None:
        """Take a line; one whose values are not what they should be tells nothing."""
        self.lines += 1
        self.last_at_ns = line.t_ns
        self.was_stopped = line.kind == STOPPED_KIND
        try:
            self._take_ids(line)
            self._take_kind(line)
        except msgspec.ValidationError:
            return

    def _take_kind(self, line: AuditLine) -> None:
        serial = line.serial
        if line.kind == STARTED_KIND:
            # What was open before has been told as ended by that start.
            self.orders.clear()
        elif line.kind.startswith("order."):
            self._take_order(line)
        elif line.kind in (UNIDENTIFIED_KIND, UNIDENTIFIED_GONE_KIND):
            self._take_unidentified(line)
        elif serial is None:
            return
        elif line.kind in SIGHTING_KINDS:
            self._take_sighting(serial, msgspec.convert(line.details, VehicleSnapshot))
        elif line.kind == "authority.taken":
            authority = msgspec.convert(line.details, _Lead)
            self._take_authority(serial, authority.holder, authority.holder_name)
        elif line.kind == "hazard.dismissed":
            self.sightings.pop(serial, None)
            self.unidentified.pop(serial, None)

    def _take_sighting(self, serial: str, sighting: VehicleSnapshot) -> None:
        """Beyond the limit those on the ground make room; when all may fly, nothing is silent."""
        if serial not in self.sightings and len(self.sightings) >= MOST_VEHICLES:
            landed = (key for key, seen in self.sightings.items() if seen.is_flying is False)
            self.sightings.pop(next(landed, ""), None)
        if serial in self.sightings or len(self.sightings) < MOST_VEHICLES:
            self.sightings[serial] = sighting
            self._take_authority(serial, sighting.holder, sighting.holder_name)
        elif sighting.is_flying is not False:
            self.unidentified[MANY_LOST] = sighting

    def _take_unidentified(self, line: AuditLine) -> None:
        name = msgspec.convert(line.details, _Name).name
        if line.kind == UNIDENTIFIED_GONE_KIND:
            self.unidentified.pop(name, None)
            return
        sighting = msgspec.convert(line.details, VehicleSnapshot)
        is_known = name in self.unidentified or len(self.unidentified) < MOST_NAMELESS
        self.unidentified[name if is_known else MANY_LOST] = sighting

    def _take_authority(self, serial: str, holder: AuthorityHolder, holder_name: str) -> None:
        if serial in self.authorities or len(self.authorities) < MOST_VEHICLES:
            self.authorities[serial] = (holder, holder_name)

    def _take_order(self, line: AuditLine) -> None:
        order = msgspec.convert(line.details, _Order)
        if order.body is not None and order.order in _BODIES:
            body: Body = msgspec.convert(order.body, _BODIES[order.order])
            self.orders[order.id] = OpenOrder(
                id=order.id,
                body=body,
                phase=order.phase,
                by=line.by,
                serial=line.serial,
                link_id=order.link_id,
                vehicle=line.vehicle,
                takeoff=order.takeoff,
                given_at_ns=line.t_ns,
            )
        elif order.id in self.orders:
            self.orders[order.id] = replace(self.orders[order.id], phase=order.phase)
        if order.phase.is_final:
            self.orders.pop(order.id, None)
        while len(self.orders) > MOST_ORDERS:
            del self.orders[next(iter(self.orders))]

    def _take_ids(self, line: AuditLine) -> None:
        if not line.kind.startswith(_KINDS_WITH_IDS):
            return
        ids = msgspec.convert(line.details, _Ids)
        self.last_id = max(self.last_id, ids.id, ids.first_id + ids.count, ids.last_command_id)
        self.least_own_id = min(self.least_own_id, ids.id, ids.next_own_id)
