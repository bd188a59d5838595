"""The newest fleet return: its vehicles and the stage of each."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

from recon.guidance.fleet_return import ReturnFlight
from recon.model.control import AuthorityHolder
from recon.model.geo import LocalFrame


class Stage(Enum):
    """The stage of one vehicle: stopping, waiting, ordered, flying, and then one of three ends."""

    STOPPING = "stopping"
    """Commanded to hold where it is."""
    WAITING = "waiting"
    """Hovers until its layer, its pad and its path are free."""
    ORDERED = "ordered"
    """Its mission is ordered; telemetry does not show it yet."""
    FLYING = "flying"
    LANDED = "landed"
    RELEASED = "released"
    """Its pilot or a newer order controls it now."""
    EXCLUDED = "excluded"
    """It is not flown home: the operator must see to it."""


ENDED = (Stage.LANDED, Stage.RELEASED, Stage.EXCLUDED)
UNDER_WAY = (Stage.ORDERED, Stage.FLYING)


@dataclass(frozen=True, slots=True)
class ReturningVehicle:
    """One vehicle that was recalled.

    `reason`: why it waits, was released or is excluded. `link_id` is its link when it was
    called: telemetry on another link may be of another flight. `hold_id` and `mission_id`
    are the return's own orders to it. `clears` names the vehicle that must first be carried off
    its pad.
    """

    serial: str
    name: str
    link_id: int | None
    hold_id: int
    stage: Stage
    since_ns: int
    reason: str = ""
    flight: ReturnFlight | None = None
    mission_id: int | None = None
    judge_at_ns: int = 0
    refused_since_ns: int | None = None
    out_of_mission_since_ns: int | None = None
    clears: str | None = None
    by: str = ""
    """The user that called it."""
    role: AuthorityHolder = AuthorityHolder.OPERATOR
    """The authority its orders are given under; when that changes, the return releases it."""
    person: str = ""
    """The name of the person whose orders they are; empty for guidance."""

    def at(self, stage: Stage, now_ns: int, reason: str = "") -> "ReturningVehicle":
        """Return the vehicle at another stage."""
        return replace(self, stage=stage, since_ns=now_ns, reason=reason, clears=None)

    def waits_for(self, reason: str) -> "ReturningVehicle":
        """Return the vehicle with the reason why it waits."""
        return self if self.reason == reason else replace(self, reason=reason)


@dataclass(frozen=True, slots=True)
class FleetReturn:
    """All vehicles recalled, by serial. `frame` is the frame of the plan's positions."""

    by: str
    called_at_ns: int
    frame: LocalFrame
    members: Mapping[str, ReturningVehicle] = field(default_factory=dict)
    turns: tuple[str, ...] = ()
    """The serials of the planned vehicles, in the order of their turn."""
    layers_up_m: tuple[float, ...] = ()
    step_due_ns: int = 0
    planning_since_ns: int | None = None
    """Time at which the worker's present plan was requested; also the job's id."""
    zone_changes: int = 0
    """`TemporaryZones.changes` when it was planned."""

    def put(self, member: ReturningVehicle) -> "FleetReturn":
        """Return it with one vehicle replaced."""
        return replace(self, members={**self.members, member.serial: member})

    def at(self, *stages: Stage) -> tuple[ReturningVehicle, ...]:
        """Return the vehicles at these stages."""
        return tuple(member for member in self.members.values() if member.stage in stages)

    @property
    def is_over(self) -> bool:
        """Whether no vehicle is stopping, waiting or under way."""
        return all(member.stage in ENDED for member in self.members.values())
