"""A survey's life under whatever comes: what never happens, in any order of events."""

from dataclasses import dataclass

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from tests.examples import examples
from tests.guidance.survey.fields import planned, rectangle, survey_of

from recon.guidance.survey import (
    PositionSample,
    Surveyor,
    SurveyState,
    abort,
    create,
    observe,
    pause,
    refused,
    start,
    step,
)
from recon.model.command import Refusal
from recon.model.survey import MissionAssignment, SurveyBudget, SurveyPhase
from recon.model.units import seconds_to_ns

PLAN = planned(survey_of(rectangle(), budget=SurveyBudget(rounds=4)))
SERIALS = ("A", "B", "C")
OTHER = "X"


@dataclass(slots=True)
class Seat:
    """The state of one vehicle."""

    is_available: bool = True
    ended: int = 0
    time_left_s: float | None = None


class SurveyLife(RuleBasedStateMachine):
    """Vehicles come and go, missions end or are refused, operators start, pause and abort."""

    def __init__(self) -> None:
        super().__init__()
        created = create(PLAN)
        assert isinstance(created, SurveyState)
        self.state = created
        self.now_s = 100.0
        self.seats = {serial: Seat() for serial in (*SERIALS, OTHER)}
        self.given: list[MissionAssignment] = []
        self.given_back_m = 0.0
        self.imaged = created.progress.state

    def _now_ns(self) -> int:
        return seconds_to_ns(self.now_s)

    def _take(self, after: SurveyState | Refusal, may: bool) -> None:
        assert isinstance(after, SurveyState) == may
        if isinstance(after, SurveyState):
            self.state = after

    @rule(count=st.integers(1, 3))
    def start(self, count: int) -> None:
        may = self.state.phase in (SurveyPhase.CREATED, SurveyPhase.PAUSED)
        self._take(start(self.state, SERIALS[:count], self._now_ns()), may)

    @rule()
    def pause(self) -> None:
        if self.state.phase is SurveyPhase.RUNNING:
            self.given_back_m += sum(each.unflown_m for each in self.state.flights.values())
        self._take(pause(self.state, self._now_ns()), self.state.phase is SurveyPhase.RUNNING)

    @precondition(lambda self: self.now_s > 400.0)
    @rule()
    def abort(self) -> None:
        self._take(abort(self.state, self._now_ns()), not self.state.phase.is_final)

    @rule(
        serial=st.sampled_from(SERIALS),
        is_available=st.booleans(),
        left_s=st.none() | st.floats(0.0, 600.0),
    )
    def change(self, serial: str, is_available: bool, left_s: float | None) -> None:
        self.seats[serial].is_available = is_available
        self.seats[serial].time_left_s = left_s

    @rule(serial=st.sampled_from(SERIALS))
    def end(self, serial: str) -> None:
        flight = self.state.flights.get(serial)
        if flight is not None:
            self.seats[serial].ended = flight.number

    @rule(serial=st.sampled_from(SERIALS), may_end=st.booleans())
    def refuse(self, serial: str, may_end: bool) -> None:
        flight = self.state.flights.get(serial)
        number = 0 if flight is None else flight.number
        self.state = refused(self.state, serial, number, "no", self._now_ns(), may_end=may_end)
        self.given_back_m += 0.0 if flight is None else flight.length_m

    @rule(serial=st.sampled_from(SERIALS), row=st.integers(0, 9))
    def fly_a_row(self, serial: str, row: int) -> None:
        north_m = 10.0 + 20.0 * row
        seen = [
            PositionSample(self._now_ns() + seconds_to_ns(s), 8.0 * s, north_m, 60.0)
            for s in range(38)
        ]
        self.state = observe(self.state, serial, seen)
        self.now_s += 40.0

    @rule(seconds=st.sampled_from([1.0, 5.0, 30.0]))
    def step(self, seconds: float) -> None:
        self.now_s += seconds
        before = self.state
        positions = [
            Surveyor(serial, (0.0, 0.0), seat.is_available, seat.ended, seat.time_left_s)
            for serial, seat in self.seats.items()
        ]
        self.state, missions = step(before, positions, self._now_ns())
        again, missions_again = step(before, positions, self._now_ns())
        assert missions == missions_again
        assert again.reason == self.state.reason
        for mission in missions:
            self._check_given(before, mission)
        self.given += missions

    def _check_given(self, before: SurveyState, mission: MissionAssignment) -> None:
        seat = self.seats[mission.serial]
        earlier = before.flights.get(mission.serial)
        assert before.phase is SurveyPhase.RUNNING
        assert mission.serial in before.serials
        assert mission.serial not in before.barred
        assert seat.is_available
        assert earlier is None or seat.ended >= earlier.number
        assert seat.time_left_s is None or mission.length_m / 8.0 < seat.time_left_s
        assert len(mission.mission.waypoints) >= 2

    @invariant()
    def numbers_rise_and_lengths_add_up(self) -> None:
        assert [each.number for each in self.given] == list(range(1, len(self.given) + 1))
        path_m = sum(each.length_m for each in self.given) - self.given_back_m
        assert abs(path_m - self.state.flown_m) < 1e-3

    @invariant()
    def only_a_running_one_has_flights(self) -> None:
        if self.state.phase is not SurveyPhase.RUNNING:
            assert not self.state.flights
            assert not self.state.waiting
        assert set(self.state.flights) <= set(self.state.serials)
        assert (self.state.ended_at_ns is not None) == self.state.phase.is_final

    @invariant()
    def rounds_stay_in_the_budget_and_there_is_a_reason(self) -> None:
        assert 0 <= self.state.round <= 4
        assert self.state.reason

    @invariant()
    def what_is_imaged_stays_so(self) -> None:
        assert (self.state.progress.state >= self.imaged).all()
        self.imaged = self.state.progress.state


SurveyLife.TestCase.settings = settings(
    max_examples=examples(60), stateful_step_count=40, deadline=None
)
TestSurveyLife = SurveyLife.TestCase
