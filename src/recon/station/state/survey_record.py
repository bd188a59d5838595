"""The surveys of this run, and the observations that wait for their next step."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Generic, Literal, TypeVar

from recon.guidance.survey import PhotoSample, PositionSample, SurveyState
from recon.model.command import Refusal
from recon.model.replacing import replace
from recon.model.shade import ShadeMap
from recon.model.survey import Survey, SurveyPhase, unknown_survey

T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class NumberedBuffer(Generic[T]):
    """`items` are those kept; the first of them has the number `first` of all that ever came."""

    items: tuple[T, ...] = ()
    first: int = 0

    @property
    def end(self) -> int:
        """The number of the next item."""
        return self.first + len(self.items)

    def with_one(self, item: T, kept: int) -> "NumberedBuffer[T]":
        """Return it with one more; beyond `kept` items the oldest are dropped."""
        items = (*self.items, item)
        dropped = max(0, len(items) - kept)
        return NumberedBuffer(items[dropped:], self.first + dropped)

    def from_number(self, number: int) -> "NumberedBuffer[T]":
        """Return it without the items before a number."""
        dropped = min(max(0, number - self.first), len(self.items))
        return NumberedBuffer(self.items[dropped:], self.first + dropped)


SURVEYS_KEPT = 16
"""Most surveys: each has up to a few MB of cells; the oldest ended one is dropped for a new one."""

PhaseWord = Literal["planning", "refused", "created", "running", "paused", "aborted", "done"]

EastNorth = tuple[float, float]
"""East-north metres of the site."""


@dataclass(frozen=True, slots=True)
class SurveyMember:
    """One vehicle of a survey, since it was started for it.

    `number` and `command_id` are its newest mission's, as the survey and the station count;
    `ordered_id` stays when `command_id` is forgotten, after a mission that does not count any more.
    `may_take_off` is the operator's permission, for one takeoff. `stop_reason`: why it gets no
    mission until it is started again. `return_reason`: why it was recalled. `unsent_since_ns`:
    since when no mission could be sent to it, for reasons that time may end.
    """

    serial: str
    may_take_off: bool = False
    number: int = 0
    command_id: int | None = None
    stop_reason: str | None = None
    return_reason: str | None = None
    unsent_since_ns: int | None = None
    ordered_id: int | None = None


@dataclass(frozen=True, slots=True)
class PhotoWatch:
    """What is known of a vehicle's camera timer: whether photos come while it flies a row.

    `sample` is its newest position that was looked at, `on_row_since_ns` since when it has flown
    along a row without a break, None when it does not.
    """

    sample: PositionSample | None = None
    on_row_since_ns: int | None = None
    newest_photo_ns: int | None = None
    silent_s: float | None = None
    """How long no photo came on a row when that was too long; until the next one comes."""


@dataclass(frozen=True, eq=False)
class SurveyRecord:
    """One survey. `state` is None while its rows are being planned, and if it is refused.

    `positions` and `shade_maps` came since the last step and are not counted in `state` yet.
    `flown` holds the path of each mission, by serial and mission number, for showing. It changes
    with every position, so it has no slots: see `model.replacing`.
    """

    survey: Survey
    by: str
    asked_at_ns: int
    state: SurveyState | None = None
    refusal: Refusal | None = None
    started_by: str = ""
    person: str = ""
    """Name of the person who started it."""
    members: Mapping[str, SurveyMember] = field(default_factory=lambda: MappingProxyType({}))
    spare_may_take_off: bool = False
    """The operator's permission for the spare imaging drone, for one relief automatically."""
    step_due_ns: int = 0
    trouble: str | None = None
    """Why the newest step failed."""
    failed_steps: int = 0
    """How many steps have failed in a row."""
    positions: NumberedBuffer[tuple[str, PositionSample | PhotoSample]] = field(
        default_factory=NumberedBuffer
    )
    """Of a vehicle whose app reports its photos, these instead."""
    shade_maps: NumberedBuffer[ShadeMap] = field(default_factory=NumberedBuffer)
    zone_changes: int = 0
    """`TemporaryZones.changes` when its rows were planned."""
    flown: Mapping[tuple[str, int], tuple[EastNorth, ...]] = field(
        default_factory=lambda: MappingProxyType({})
    )
    photo_watches: Mapping[str, PhotoWatch] = field(default_factory=lambda: MappingProxyType({}))
    """By serial, of the vehicles whose apps report their photos."""

    @property
    def issuer(self) -> str:
        """The `issued_by` of its orders."""
        return f"{self.started_by}: survey {self.survey.name}"

    @property
    def phase(self) -> tuple[PhaseWord, str]:
        """Return its phase, and the reason for it in words."""
        if self.refusal is not None:
            return "refused", self.refusal.reason
        if self.state is None:
            return "planning", "its rows are being planned"
        return self.state.phase.value, self.state.reason

    @property
    def is_over(self) -> bool:
        """Whether it is refused, done or aborted."""
        return self.refusal is not None or (self.state is not None and self.state.phase.is_final)

    @property
    def is_open(self) -> bool:
        """Whether it is running or paused: positions and photos count."""
        phases = (SurveyPhase.RUNNING, SurveyPhase.PAUSED)
        return self.state is not None and self.state.phase in phases

    @property
    def is_running(self) -> bool:
        """Whether its vehicles get missions."""
        return self.state is not None and self.state.phase is SurveyPhase.RUNNING

    def put(self, member: SurveyMember) -> "SurveyRecord":
        """Return it with one vehicle replaced."""
        members = MappingProxyType({**self.members, member.serial: member})
        return replace(self, members=members)


@dataclass(frozen=True, slots=True)
class PendingStep:
    """The step that the worker takes for one survey now, and up to which observations it counts.

    `is_replan`: it plans the rows anew, and counts none.
    """

    job_id: int
    survey_id: int
    asked_at_ns: int
    positions_end: int
    shade_maps_end: int
    is_replan: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Surveys:
    """All recent surveys by id, in the order they were requested."""

    records: Mapping[int, SurveyRecord] = field(default_factory=lambda: MappingProxyType({}))
    pending: PendingStep | None = None
    next_job_id: int = 1

    def put(self, record: SurveyRecord) -> "Surveys":
        """Return them with one replaced; if there are too many, drop the oldest that is over."""
        records = {**self.records, record.survey.id: record}
        over = [key for key, each in records.items() if each.is_over and each is not record]
        for key in over[: max(0, len(records) - SURVEYS_KEPT)]:
            del records[key]
        return replace(self, records=MappingProxyType(records))

    def unknown_survey(self, survey_id: int) -> str:
        """Return the sentence for an unknown survey: it names those there are."""
        known = ((key, each.survey.name, each.phase[0]) for key, each in self.records.items())
        return unknown_survey(survey_id, known)

    def without_pending(self, survey_id: int) -> "Surveys":
        """Return them without a survey's pending step: a command has changed the survey."""
        is_of_it = self.pending is not None and self.pending.survey_id == survey_id
        return replace(self, pending=None) if is_of_it else self

    def running_with(self, serial: str) -> SurveyRecord | None:
        """Return the running survey that a vehicle belongs to."""
        running = (each for each in self.records.values() if each.is_running)
        return next((each for each in running if serial in each.members), None)
