"""What is known of a fleet return: each vehicle of it and how far it has come."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

from recon.guidance.fleet_return import Flight
from recon.model.authority import AuthorityHolder
from recon.model.geo import LocalFrame


class Stage(Enum):
    """How far a vehicle has come."""

    STOPPING = "stopping"
    """Told to hold where it is."""
    WAITING = "waiting"
    """Hovers until its layer, its pad and its way are free."""
    ORDERED = "ordered"
    """Its mission is given; telemetry has not shown it yet."""
    FLYING = "flying"
    LANDED = "landed"
    RELEASED = "released"
    """Its pilot or a newer order has it: no longer the return's."""
    LEFT_OUT = "left_out"
    """It is not flown home: somebody must see to it."""


ENDED = (Stage.LANDED, Stage.RELEASED, Stage.LEFT_OUT)
UNDER_WAY = (Stage.ORDERED, Stage.FLYING)


@dataclass(frozen=True, slots=True)
class Member:
    """One vehicle that was called.

    `reason` says why it waits, was released or is left out. `link_id` is its link when it was
    called: what comes over another one is not known to be the same flight. `hold_id` and
    `mission_id` are the return's own orders to it. `clears` names the vehicle that must first be
    carried off its pad.
    """

    serial: str
    name: str
    link_id: int | None
    hold_id: int
    stage: Stage
    since_ns: int
    reason: str = ""
    flight: Flight | None = None
    mission_id: int | None = None
    judge_at_ns: int = 0
    refused_since_ns: int | None = None
    out_of_mission_since_ns: int | None = None
    clears: str | None = None
    by: str = ""
    """Who called it."""
    asked_as: AuthorityHolder = AuthorityHolder.OPERATOR
    """As whose its orders are given: it is the return's while that one leads it."""

    def at(self, stage: Stage, now_ns: int, reason: str = "") -> "Member":
        """Return the member at another stage."""
        return replace(self, stage=stage, since_ns=now_ns, reason=reason, clears=None)

    def waits_for(self, reason: str) -> "Member":
        """Return the member with the reason why it waits."""
        return self if self.reason == reason else replace(self, reason=reason)


@dataclass(frozen=True, slots=True)
class FleetReturn:
    """All vehicles called, by serial. `frame` is what the plan's places count from."""

    by: str
    called_at_ns: int
    frame: LocalFrame
    members: Mapping[str, Member] = field(default_factory=dict)
    turns: tuple[str, ...] = ()
    """The serials of those with a flight, in the order of their turn."""
    layers_up_m: tuple[float, ...] = ()
    look_at_ns: int = 0
    planning_since_ns: int | None = None
    """When the plan that the worker makes now was asked for; it is that work's number too."""

    def put(self, member: Member) -> "FleetReturn":
        """Return it with a member as it is now."""
        return replace(self, members={**self.members, member.serial: member})

    def at(self, *stages: Stage) -> tuple[Member, ...]:
        """Return the members at these stages."""
        return tuple(member for member in self.members.values() if member.stage in stages)

    @property
    def is_over(self) -> bool:
        """Whether nobody is stopping, waiting or under way any more."""
        return all(member.stage in ENDED for member in self.members.values())
