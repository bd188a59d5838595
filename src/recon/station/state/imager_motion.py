"""Motions of an imaging drone under guidance: the newest of each kind, and what begins the next.

There are three kinds, looks aside, moves upwind and reliefs (`imager_relief`). Of all together one
at most is under way. All of it is of this run: after a restart none continues.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import ClassVar, TypeVar

from recon.guidance.upwind_proposal import UpwindProposal
from recon.model.command import Refusal
from recon.model.geo import LatLon
from recon.model.units import seconds_to_ns

MotionT = TypeVar("MotionT", bound="ImagerMotion")
ByItselfT = TypeVar("ByItselfT", bound="ByItself")


class MotionStage(Enum):
    """Life cycle of a motion; nothing resumes one that has stopped."""

    ASIDE = "aside"
    """On the way from its place, to look aside."""
    WAITING = "waiting"
    """Holding beside its place: the gate refuses the way back for now."""
    BACK = "back"
    """On the way back."""
    UPWIND = "upwind"
    """On the way to its place upwind."""
    TO_PLACE = "to_place"
    """On the way to the place of an imaging drone, in a layer of its own."""
    MAPS = "maps"
    """At that place: waits for its own shade maps."""
    DONE = "done"
    """At the place where it was to end, holding."""
    STOPPED = "stopped"
    """Ended before that, holding or flown by its pilot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ImagerMotion:
    """One motion. It is to end at `place` and height; `command_id` is the newest way's."""

    rule: ClassVar[str]
    words: ClassVar[str]
    """What it is called."""
    doing: ClassVar[str]
    """What its vehicle does meanwhile."""

    serial: str
    name: str
    by: str
    begun_at_ns: int
    place: LatLon
    height_above_takeoff_m: float
    command_id: int
    stage: MotionStage
    since_ns: int
    reason: str = ""
    survey_id: int | None = None
    """The survey for which it began by itself; None: a person asked for it."""

    @property
    def is_over(self) -> bool:
        """Whether it is done or has stopped."""
        return self.stage in (MotionStage.DONE, MotionStage.STOPPED)

    def at(self: MotionT, stage: MotionStage, now_ns: int, reason: str = "") -> MotionT:
        """Return it at another stage."""
        return replace(self, stage=stage, since_ns=now_ns, reason=reason)


@dataclass(frozen=True, slots=True, kw_only=True)
class LookAside(ImagerMotion):
    """One look aside; it ends where it began."""

    rule: ClassVar[str] = "look_aside"
    words: ClassVar[str] = "look aside"
    doing: ClassVar[str] = "looks aside"

    bearing_deg: float
    judged_at_ns: int = 0
    """When the way back was last judged."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveUpwind(ImagerMotion):
    """One move upwind, and the proposal that it follows."""

    rule: ClassVar[str] = "move_upwind"
    words: ClassVar[str] = "move upwind"
    doing: ClassVar[str] = "moves upwind"

    proposal: UpwindProposal


@dataclass(frozen=True, slots=True)
class ByItself:
    """When a motion of a kind may begin by itself again, and why the last one could not."""

    due_ns: int = 0
    refused: str | None = None

    def after_try(
        self: ByItselfT, refusal: Refusal | None, every_s: float, again_s: float, now_ns: int
    ) -> ByItselfT:
        """Return it after a motion was begun by itself, or refused."""
        wait_ns = seconds_to_ns(every_s if refusal is None else again_s)
        reason = None if refusal is None else refusal.reason
        return replace(self, due_ns=now_ns + wait_ns, refused=reason)

    def not_refused(self: ByItselfT) -> ByItselfT:
        """Return it without a refusal."""
        return self if self.refused is None else replace(self, refused=None)


@dataclass(frozen=True, slots=True)
class LookAsides(ByItself):
    """The newest look aside; since when light is mostly unknown below each imaging drone.

    That is by serial, and by the capture time of its own shade maps.
    """

    newest: LookAside | None = None
    unknown_since_ns: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class UpwindMoves(ByItself):
    """The newest move upwind, and the search for the next place while a survey allows one.

    `survey_id` is that survey, which runs since `allowed_since_ns`. A job of number `job_id` was
    asked for a proposal at `asked_at_ns`; `proposal` is the newest one, better than the present
    place since `better_since_ns`. Since the survey runs, a person has moved or stopped the imaging
    drones in `placed`.
    """

    newest: MoveUpwind | None = None
    survey_id: int | None = None
    allowed_since_ns: int = 0
    placed: frozenset[str] = frozenset()
    job_id: int | None = None
    next_job_id: int = 1
    asked_at_ns: int | None = None
    proposal: UpwindProposal | None = None
    better_since_ns: int | None = None
