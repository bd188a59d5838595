"""Motions of an imaging drone under guidance: the newest of each kind, and what begins the next.

There are three kinds: side-steps, moves upwind and reliefs. One motion at most is under way. After
a restart none continues.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import ClassVar, Self, TypeVar

from recon.guidance.upwind_proposal import UpwindProposal
from recon.model.command import Refusal
from recon.model.geo import LatLon
from recon.model.units import seconds_to_ns


class MotionStage(Enum):
    """Life cycle of a motion; nothing resumes one that has stopped."""

    ASIDE = "aside"
    """Flying from its place for a side-step."""
    WAITING = "waiting"
    """Holding beside its place: the gate refuses the path back for now."""
    BACK = "back"
    """Flying back."""
    UPWIND = "upwind"
    """Flying to its place upwind."""
    TO_PLACE = "to_place"
    """Flying to the place of an imaging drone, in a layer of its own."""
    MAPS = "maps"
    """Waiting at that place for its own shade maps."""
    DONE = "done"
    """Holding at its destination."""
    STOPPED = "stopped"
    """Ended before that, holding or flown by its pilot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ImagerMotion:
    """One motion. It is to end at `place` and height; `command_id` is its newest order's."""

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
    command_id: int = 0
    stage: MotionStage
    since_ns: int
    reason: str = ""
    survey_id: int | None = None
    """The survey for which it began automatically; None: a person asked for it."""

    @property
    def is_over(self) -> bool:
        """Whether it is done or has stopped."""
        return self.stage in (MotionStage.DONE, MotionStage.STOPPED)

    def at(self, stage: MotionStage, now_ns: int, reason: str = "") -> Self:
        """Return it at another stage."""
        return replace(self, stage=stage, since_ns=now_ns, reason=reason)


@dataclass(frozen=True, slots=True, kw_only=True)
class SideStep(ImagerMotion):
    """One side-step; it ends where it began."""

    rule: ClassVar[str] = "side_step"
    words: ClassVar[str] = "side-step"
    doing: ClassVar[str] = "side-steps"

    bearing_deg: float
    judged_at_ns: int = 0
    """When the path back was last judged."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveUpwind(ImagerMotion):
    """One move upwind, and the proposal that it follows."""

    rule: ClassVar[str] = "move_upwind"
    words: ClassVar[str] = "move upwind"
    doing: ClassVar[str] = "moves upwind"

    proposal: UpwindProposal


@dataclass(frozen=True, slots=True, kw_only=True)
class ImagerRelief(ImagerMotion):
    """One relief: `serial` takes the place of `relieved`; the same one returns to its own place."""

    rule: ClassVar[str] = "imager_relief"
    words: ClassVar[str] = "relief"
    doing: ClassVar[str] = "takes an imaging drone's place"

    relieved: str
    relieved_name: str
    within_s: float
    link_id: int | None
    person: str = ""
    maps: int = 0
    """Shade maps in a row since it is at the place, the newest taken at `map_at_ns`."""
    map_at_ns: int = 0
    has_map: bool = False
    """Whether any shade map of its own came since then."""
    is_camera_ordered: bool = False
    home_refused: str = ""
    """Why the relieved one could not be recalled at the end."""

    @property
    def comes_back(self) -> bool:
        """Whether it returns to its own place."""
        return self.serial == self.relieved


AnyMotion = SideStep | MoveUpwind | ImagerRelief
MotionT = TypeVar("MotionT", bound=AnyMotion)


@dataclass(frozen=True, slots=True)
class AutomaticStart:
    """Earliest time of the next automatic motion of a kind, and why the last one was refused."""

    due_ns: int = 0
    refused: str | None = None

    def after_try(
        self, refusal: Refusal | None, every_s: float, again_s: float, now_ns: int
    ) -> "AutomaticStart":
        """Return it after a motion was begun automatically, or refused."""
        wait_ns = seconds_to_ns(every_s if refusal is None else again_s)
        return AutomaticStart(now_ns + wait_ns, None if refusal is None else refusal.reason)


@dataclass(frozen=True, slots=True)
class UpwindSearch:
    """The search for the next place upwind, while a survey allows a move there.

    `survey_id` is that survey, which runs since `allowed_since_ns`. A job of number `job_id` was
    asked for a proposal at `asked_at_ns`; `proposal` is the newest one, better than the present
    place since `better_since_ns`. Since the survey runs, a person has moved or stopped the imaging
    drones in `placed`.
    """

    survey_id: int | None = None
    allowed_since_ns: int = 0
    placed: frozenset[str] = frozenset()
    job_id: int | None = None
    next_job_id: int = 1
    asked_at_ns: int | None = None
    proposal: UpwindProposal | None = None
    better_since_ns: int | None = None


@dataclass(frozen=True, slots=True)
class ImagerMotions:
    """The newest motion of each kind and its automatic start, by the kind's rule.

    `unknown_since_ns` states since when light is mostly unknown below an imaging drone: by serial,
    and by the capture time of its own shade maps.
    """

    newest: Mapping[str, AnyMotion] = field(default_factory=dict)
    starts: Mapping[str, AutomaticStart] = field(default_factory=dict)
    unknown_since_ns: Mapping[str, int] = field(default_factory=dict)
    upwind: UpwindSearch = field(default_factory=UpwindSearch)

    def of(self, kind: type[MotionT]) -> MotionT | None:
        """Return the newest motion of a kind; None before the first."""
        newest = self.newest.get(kind.rule)
        assert newest is None or isinstance(newest, kind), "motions are kept by their rule"
        return newest

    def under_way(self) -> AnyMotion | None:
        """Return the motion that is under way, of whatever kind."""
        return next((each for each in self.newest.values() if not each.is_over), None)

    def put(self, motion: AnyMotion) -> "ImagerMotions":
        """Return them with the newest motion of its kind replaced."""
        return replace(self, newest={**self.newest, motion.rule: motion})

    def start(self, kind: type[AnyMotion]) -> AutomaticStart:
        """Return when a motion of a kind may begin automatically."""
        return self.starts.get(kind.rule, AutomaticStart())

    def with_start(self, kind: type[AnyMotion], start: AutomaticStart) -> "ImagerMotions":
        """Return them with another automatic start of a kind."""
        return replace(self, starts={**self.starts, kind.rule: start})

    def not_refused(self, kind: type[AnyMotion]) -> "ImagerMotions":
        """Return them without a refusal of a kind's automatic start."""
        start = self.start(kind)
        return (
            self if start.refused is None else self.with_start(kind, replace(start, refused=None))
        )
