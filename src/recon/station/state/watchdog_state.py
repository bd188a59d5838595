"""What the watch remembers from one look to the next."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from recon.model.vehicle import VehicleState
from recon.safety.watchdogs import CommandedHold, Finding, PreviousPosition


@dataclass(frozen=True, slots=True)
class Kept:
    """A finding, since when it has been made, and when last."""

    finding: Finding
    since_ns: int
    seen_ns: int


@dataclass(frozen=True, slots=True)
class HoldRefused:
    """A hold that the watchdogs wanted and that did not go to its vehicle: when, and why."""

    at_ns: int
    why: str


@dataclass(frozen=True, slots=True)
class StickCount:
    """How many sticks a lease has sent, and when that number last changed."""

    started_at_ns: int
    sent: int
    changed_at_ns: int


@dataclass(frozen=True)
class WatchdogState:
    """The watch's memory; everything by serial, or by finding's key.

    `dismissed` has for each hazard area that somebody took out of the air the time of its last
    telemetry: anything newer brings the vehicle back. `lost` are vehicles that flew without ever
    saying a serial when their links ended, by the name their hazard areas are dismissed by.
    """

    looked_at_ns: int | None = None
    findings: Mapping[str, Kept] = field(default_factory=dict)
    held: Mapping[str, CommandedHold] = field(default_factory=dict)
    holds_refused: Mapping[str, HoldRefused] = field(default_factory=dict)
    before: Mapping[str, PreviousPosition] = field(default_factory=dict)
    sticks: Mapping[str, StickCount] = field(default_factory=dict)
    dismissed: Mapping[str, int | None] = field(default_factory=dict)
    unidentified_since_ns: Mapping[int, int] = field(default_factory=dict)
    """Since when each link has flown without a serial, by link id."""
    lost: Mapping[str, VehicleState] = field(default_factory=dict)
    is_hold_on: bool = True
    """Whether the watchdogs' findings hold vehicles; switched by a person."""
    switched_by: str = ""
