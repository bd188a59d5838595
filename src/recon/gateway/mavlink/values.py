"""The gateway's state: frozen values."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from recon.client.telemetry import Telemetry
from recon.model.mission import Mission

MAX_PENDING = 64
"""Requests to the station under way; further ones are refused, stops excepted."""
MAX_ANSWERS = 256
MAX_FENCES = 64
"""Answers and fences kept for repeated requests; the oldest is dropped."""


@dataclass(frozen=True, slots=True)
class GatewaySettings:
    """What the gateway may do, and how it converts heights."""

    allow_orders: bool = False
    ground_above_sea_level_m: float = 0.0
    """Altitude above sea level of every takeoff point, as far as clients are told."""
    speed_mps: float = 5.0
    """Speed of missions and gotos that state none."""


@dataclass(frozen=True, slots=True)
class Sender:
    """Who sent a message: the peer's number, and the ids that an answer is addressed to."""

    peer: int
    system: int
    component: int


@dataclass(frozen=True, slots=True)
class StoredMission:
    """A mission that a client has uploaded: its items as they came, and what is flown."""

    items: tuple[Any, ...]
    mission: Mission


@dataclass(frozen=True, slots=True)
class GatewayVehicle:
    """One vehicle: what was last sent of it, and what clients have asked for. Times: monotonic."""

    system_id: int
    telemetry: Telemetry
    position_ns: int = 0
    attitude_ns: int = 0
    """Station times of the samples that were sent last."""
    slow_due_ns: int = 0
    ground_place: tuple[float, float] | None = None
    """Where it was last seen on the ground, latitude and longitude: it takes off from there."""
    mission: StoredMission | None = None
    order_id: int | None = None
    """The station's number of the order that flies the mission."""
    is_done: bool = False
    takeoff_until_ns: int = 0
    """A client has armed it: until then the next mission start may take off."""

    @property
    def serial(self) -> str:
        """The serial number; only identified vehicles are shown."""
        assert self.telemetry.serial is not None
        return self.telemetry.serial


@dataclass(frozen=True, slots=True)
class Upload:
    """A mission that is being received, item by item."""

    sender: Sender
    count: int
    items: tuple[Any, ...]
    asked_ns: int
    tries: int = 1


@dataclass(frozen=True, slots=True)
class CommandAsked:
    """A command whose order is under way. `key` is its content, to recognise repetitions."""

    sender: Sender
    command: int
    key: tuple[Any, ...]
    starts_mission: bool = False


@dataclass(frozen=True, slots=True)
class MissionAsked:
    """An uploaded mission that the station's gate is judging."""

    sender: Sender
    stored: StoredMission


@dataclass(frozen=True, slots=True)
class FenceAsked:
    """A client that asked for the fence."""

    sender: Sender


@dataclass(frozen=True, slots=True)
class Pending:
    """A request to the station, and what it is for."""

    system_id: int
    purpose: CommandAsked | MissionAsked | FenceAsked


@dataclass(frozen=True, slots=True)
class GatewayState:
    """All of the gateway's state. Vehicles and uploads are by system id, requests by token."""

    settings: GatewaySettings = field(default_factory=GatewaySettings)
    vehicles: Mapping[int, GatewayVehicle] = field(default_factory=dict)
    seen_ns: int = 0
    """When the newest state of the station was created, by the gateway's own clock."""
    uploads: Mapping[int, Upload] = field(default_factory=dict)
    pending: Mapping[int, Pending] = field(default_factory=dict)
    answers: Mapping[tuple[Any, ...], tuple[Any, int]] = field(default_factory=dict)
    """Answers to commands and until when they are repeated, by peer, system id and content."""
    fences: Mapping[tuple[int, int], tuple[Any, ...]] = field(default_factory=dict)
    """Fences that are being read, by peer and system id."""
    next_token: int = 1
    next_text_id: int = 1

    def with_vehicle(self, vehicle: GatewayVehicle) -> "GatewayState":
        """Return the state with a vehicle replaced."""
        return replace(self, vehicles={**self.vehicles, vehicle.system_id: vehicle})

    def asking(self, system_id: int, purpose: Any) -> tuple["GatewayState", int]:
        """Return the state with one more request to the station, and its token."""
        token = self.next_token
        pending = {**self.pending, token: Pending(system_id, purpose)}
        return replace(self, pending=pending, next_token=token + 1), token

    @property
    def is_busy(self) -> bool:
        """Whether too many requests are under way for another one."""
        return len(self.pending) >= MAX_PENDING


def newest(mapping: Mapping[Any, Any], key: Any, value: Any, limit: int) -> dict[Any, Any]:
    """Return a mapping with one more entry, and without the oldest ones beyond a limit."""
    kept = {**{k: v for k, v in mapping.items() if k != key}, key: value}
    return dict(list(kept.items())[-limit:])
