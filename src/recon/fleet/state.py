"""State of the fleet: links and vehicles."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from recon.fleet.admission import ANY_APP, Admission
from recon.fleet.link_quality import Arrivals
from recon.fleet.settings import FleetSettings
from recon.model.units import NS_PER_S
from recon.model.vehicle import Staleness, VehicleProfile, VehicleState, staleness_at


@dataclass(frozen=True)
class LinkRecord:
    """One connection; `own_state` holds its telemetry while it is not bound to a vehicle."""

    id: int
    remote_address: str
    opened_at_ns: int
    own_state: VehicleState
    closed_at_ns: int | None = None
    closed_reason: str | None = None
    claimed_serial: str | None = None
    rejected_serial: str | None = None
    """The serial it reports while the limit of vehicles is reached."""
    waiting_serial: str | None = None
    """The serial it reports while the list of apps does not admit it (`fleet.pairing`)."""
    waits_since_ns: int | None = None
    last_packet_at_ns: int | None = None
    rival_since_ns: int | None = None
    """Time at which it reported a serial that another open link is bound to."""
    in_conflict: bool = False
    """Whether the bound link delivered a packet after that."""
    packets: int = 0
    images: int = 0
    ignored_reports: int = 0
    arrivals: Arrivals | None = None
    """Arrivals of its core telemetry; None before the first."""

    @property
    def is_open(self) -> bool:
        """Whether the connection is open."""
        return self.closed_at_ns is None

    @property
    def is_waiting(self) -> bool:
        """Whether it is open and waits to be admitted."""
        return self.is_open and self.waits_since_ns is not None

    @property
    def reported_serial(self) -> str | None:
        """The serial it claims, admitted or waiting."""
        return self.claimed_serial or self.waiting_serial


@dataclass(frozen=True)
class Fleet:
    """All links (open and lately closed) and all vehicles identified in this run.

    Beyond a limit, vehicles on the ground without a link are forgotten.
    """

    settings: FleetSettings = FleetSettings()
    profiles: Mapping[str, VehicleProfile] = field(default_factory=dict)
    links: Mapping[int, LinkRecord] = field(default_factory=dict)
    vehicles: Mapping[str, VehicleState] = field(default_factory=dict)
    admission: Admission = ANY_APP

    def vehicle_of_link(self, link_id: int) -> VehicleState | None:
        """Return the state that a link's reports update: its vehicle's, or its own if unbound."""
        link = self.links.get(link_id)
        if link is None:
            return None
        vehicle = self.vehicles.get(link.claimed_serial or "")
        return vehicle if vehicle is not None and vehicle.link_id == link_id else link.own_state

    def link_ids_claiming(self, serial: str) -> tuple[int, ...]:
        """Return every open link that claims `serial`, the vehicle's own link first."""
        vehicle = self.vehicles.get(serial)
        if vehicle is None:
            return ()
        own = () if vehicle.link_id is None else (vehicle.link_id,)
        return own + vehicle.rival_link_ids

    def link_ids_waiting(self, serial: str) -> tuple[int, ...]:
        """Return the open links that report `serial` and wait to be admitted."""
        if not self.admission.is_in_force:
            return ()
        return tuple(
            link.id
            for link in self.links.values()
            if link.is_waiting and link.waiting_serial == serial
        )

    def unbound_links(self) -> tuple[LinkRecord, ...]:
        """Return the open links not bound to a vehicle: unidentified or rivals."""
        return tuple(
            link
            for link in self.links.values()
            if link.closed_at_ns is None and not self._is_bound(link)
        )

    def _is_bound(self, link: LinkRecord) -> bool:
        vehicle = self.vehicles.get(link.claimed_serial or "")
        return vehicle is not None and vehicle.link_id == link.id


def staleness(vehicle: VehicleState, now_ns: int) -> Staleness:
    """Return the tier of the newest core telemetry's age; never received counts as silent."""
    received_at_ns = vehicle.core_received_at_ns
    return staleness_at(None if received_at_ns is None else (now_ns - received_at_ns) / NS_PER_S)
