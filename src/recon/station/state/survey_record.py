"""What is known of the surveys of this run."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Literal

from recon.guidance.survey import PositionSample, SurveyState
from recon.model.command import Refusal
from recon.model.shade import ShadeMap
from recon.model.survey import Survey, SurveyPhase, none_such
from recon.station.state.numbered_buffer import Tail

SURVEYS_KEPT = 16
"""Each has its cells, up to a few MB; the oldest that has ended is forgotten for a new one."""

PhaseWord = Literal["planning", "refused", "created", "running", "paused", "aborted", "done"]

Place = tuple[float, float]
"""East-north metres of the site."""


@dataclass(frozen=True, slots=True)
class Member:
    """One vehicle of a survey, since somebody started it.

    `number` and `command_id` are its newest mission's, as the survey and the station count.
    `may_take_off` is the operator's word, good for one takeoff. `stopped` says why it is given
    nothing more until somebody starts it again; `homeward` why it was called home.
    """

    serial: str
    may_take_off: bool = False
    number: int = 0
    command_id: int | None = None
    stopped: str | None = None
    homeward: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SurveyRecord:
    """One survey. `state` is None while its rows are being planned; for good when it is refused.

    `seen` and `shade` came since the last look and are not counted in `state` yet. `flown` holds
    the way of each mission, by vehicle and number, for showing.
    """

    survey: Survey
    by: str
    asked_at_ns: int
    state: SurveyState | None = None
    refusal: Refusal | None = None
    started_by: str = ""
    members: Mapping[str, Member] = field(default_factory=lambda: MappingProxyType({}))
    look_at_ns: int = 0
    trouble: str | None = None
    """Why the newest look came to nothing."""
    seen: Tail[tuple[str, PositionSample]] = field(default_factory=Tail)
    shade: Tail[ShadeMap] = field(default_factory=Tail)
    flown: Mapping[tuple[str, int], tuple[Place, ...]] = field(
        default_factory=lambda: MappingProxyType({})
    )

    @property
    def phase(self) -> tuple[PhaseWord, str]:
        """How far it has come, and why, in words."""
        if self.refusal is not None:
            return "refused", self.refusal.reason
        if self.state is None:
            return "planning", "its rows are being worked out"
        return self.state.phase.value, self.state.reason

    @property
    def is_over(self) -> bool:
        """Whether it will never fly (again)."""
        return self.refusal is not None or (self.state is not None and self.state.phase.is_final)

    @property
    def is_running(self) -> bool:
        """Whether it gives its vehicles missions."""
        return self.state is not None and self.state.phase is SurveyPhase.RUNNING

    def put(self, member: Member) -> "SurveyRecord":
        """Return it with a member as it is now."""
        members = MappingProxyType({**self.members, member.serial: member})
        return replace(self, members=members)


@dataclass(frozen=True, slots=True)
class Look:
    """The work under way for one survey, and up to which of its observations it counts them."""

    job_id: int
    survey_id: int
    asked_at_ns: int
    seen_end: int
    shade_end: int


@dataclass(frozen=True, slots=True, eq=False)
class Surveys:
    """All surveys lately asked for, by id, in the order they came."""

    records: Mapping[int, SurveyRecord] = field(default_factory=lambda: MappingProxyType({}))
    look: Look | None = None
    next_job_id: int = 1

    def put(self, record: SurveyRecord) -> "Surveys":
        """Return them with one as it is now; too many forget the oldest that is over."""
        records = {**self.records, record.survey.id: record}
        over = [key for key, each in records.items() if each.is_over and each is not record]
        for key in over[: max(0, len(records) - SURVEYS_KEPT)]:
            del records[key]
        return replace(self, records=MappingProxyType(records))

    def none_such(self, survey_id: int) -> str:
        """Return the sentence for a survey that is not there: it names those there are."""
        known = ((key, each.survey.name, each.phase[0]) for key, each in self.records.items())
        return none_such(survey_id, known)

    def without_look(self, survey_id: int) -> "Surveys":
        """Return them with a look at one survey counted as never asked for: a word changed it."""
        is_of_it = self.look is not None and self.look.survey_id == survey_id
        return replace(self, look=None) if is_of_it else self

    def running_with(self, serial: str) -> SurveyRecord | None:
        """Return the running survey that a vehicle is of."""
        running = (each for each in self.records.values() if each.is_running)
        return next((each for each in running if serial in each.members), None)
