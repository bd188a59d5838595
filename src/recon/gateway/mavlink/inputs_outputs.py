"""What comes into the gateway's step, and what goes out: frozen values."""

from dataclasses import dataclass
from typing import Any

from recon.client.messages import StateMessage
from recon.gateway.mavlink.values import GatewayState, Sender
from recon.model.command import Body, Refusal
from recon.model.mission import Mission


@dataclass(frozen=True, slots=True)
class StationSeen:
    """A state of the station, `age_s` after it was created."""

    message: StateMessage
    age_s: float = 0.0


@dataclass(frozen=True, slots=True)
class MessageReceived:
    """A checked message of a client."""

    sender: Sender
    message: Any


@dataclass(frozen=True, slots=True)
class PeerGone:
    """A client whose connection has closed, or that has been silent for too long."""

    peer: int


@dataclass(frozen=True, slots=True)
class StationAnswered:
    """The station's answer to an order or a check; `problem` when there is none."""

    token: int
    refusal: Refusal | None = None
    command_id: int | None = None
    problem: str | None = None


@dataclass(frozen=True, slots=True)
class FenceRead:
    """The site's fence as mission items; `problem` when it could not be read."""

    token: int
    items: tuple[Any, ...] = ()
    problem: str | None = None


@dataclass(frozen=True, slots=True)
class TimePassed:
    """Time has passed."""


Input = StationSeen | MessageReceived | PeerGone | StationAnswered | FenceRead | TimePassed


@dataclass(frozen=True, slots=True)
class Send:
    """Messages of a vehicle, to one peer or to all (None)."""

    system_id: int
    messages: tuple[Any, ...]
    peer: int | None = None


@dataclass(frozen=True, slots=True)
class PlaceOrder:
    """An order for the station's gate."""

    token: int
    serial: str
    body: Body
    takeoff: bool = False


@dataclass(frozen=True, slots=True)
class CheckMission:
    """A mission that the station's gate is to judge; nothing is sent to the vehicle."""

    token: int
    serial: str
    mission: Mission


@dataclass(frozen=True, slots=True)
class ReadFence:
    """Read the site's boundary and zones."""

    token: int


Output = Send | PlaceOrder | CheckMission | ReadFence
Outputs = tuple[Output, ...]
Stepped = tuple[GatewayState, Outputs]
"""The next state, and what to send, ask and order."""
