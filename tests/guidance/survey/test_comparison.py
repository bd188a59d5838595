"""Planners that others are compared with."""

from dataclasses import replace

import numpy as np
from tests.guidance.survey.decisions import PLAN, SURVEY, decided, flown_rows, forecast
from tests.guidance.survey.fields import planned
from tests.guidance.survey.flyers import (
    BoolArray,
    Flights,
    FloatArray,
    begun,
    fleet,
)

from recon.guidance.survey import Surveyor, SurveyState, create, start
from recon.model.survey import CellState, SurveyBudget, SurveyPhase

HERE = Surveyor("S-1", (0.0, 0.0)), Surveyor("S-2", (0.0, 240.0))


def started(planner: str) -> SurveyState:
    made = create(planned(replace(SURVEY, planner=planner)))
    assert isinstance(made, SurveyState)
    running = start(made, ["S-1", "S-2"], 0)
    assert isinstance(running, SurveyState)
    return running


def opens_after_60_s(places_m: FloatArray, time_s: float) -> BoolArray:
    return np.full(len(places_m), time_s > 60.0)


class TestLawnmowerWaits:
    def test_a_round_begins_once_most_is_in_sun(self) -> None:
        state = started("lawnmower_waits")
        shaded = forecast(lambda _east, north, _lead: north < 100.0)
        state, missions = decided(shaded, *HERE, state=state)
        assert (missions, state.reason) == (
            (),
            "waiting: most of what is missing lies in shade",
        )
        lit = forecast(lambda _east, north, _lead: north < 200.0, 4.0)
        state, missions = decided(lit, *HERE, state=state, now_s=4.0)
        assert {each.serial for each in missions} == {"S-1", "S-2"}
        rows = {row for each in HERE for row in flown_rows(state, each.serial)}
        assert rows == {piece.row for piece in PLAN.pieces}

    def test_it_ends_when_all_is_in_sun_or_the_budget_is_spent(self) -> None:
        for budget, reason in (
            (SurveyBudget(rounds=5), "Complete: all reachable ground photographed in sun"),
            (SurveyBudget(time_s=30.0), "Time budget of 30 s spent"),
        ):
            flyers = fleet(2)
            survey = replace(SURVEY, planner="lawnmower_waits", budget=budget)
            flights = Flights(begun(survey, flyers), flyers, sky=opens_after_60_s)
            state = flights.run()
            assert state.phase is SurveyPhase.DONE
            assert state.reason.startswith(reason)
            assert bool(flights.given) == (budget.time_s is None)

    def test_its_last_round_ends_it_in_shade_too(self) -> None:
        def shade_after_20_s(places_m: FloatArray, time_s: float) -> BoolArray:
            return np.full(len(places_m), time_s < 20.0)

        flyers = fleet(1)
        survey = replace(SURVEY, planner="lawnmower_waits", budget=SurveyBudget(rounds=1))
        state = Flights(begun(survey, flyers), flyers, sky=shade_after_20_s).run(3_000.0)
        assert (state.phase, state.round) == (SurveyPhase.DONE, 1)
        assert state.reason.startswith("The only round flown")


class TestNearestSunlit:
    def test_each_flies_the_nearest_row_in_sun_one_at_a_time(self) -> None:
        state = started("nearest_sunlit")
        sun = forecast(lambda _east, north, _lead: (north > 60.0) & (north < 180.0))
        state, missions = decided(sun, *HERE, state=state)
        assert len(missions) == 2
        norths = []
        for each in HERE:
            (row,) = flown_rows(state, each.serial)
            across_m = PLAN.lattice.row_across_m(row)
            ((_east_m, north_m),) = PLAN.lattice.east_north_m([(0.0, across_m)]).tolist()
            norths.append(north_m)
        assert 50.0 < norths[0] < 100.0
        assert 140.0 < norths[1] < 190.0

    def test_without_a_row_in_sun_it_waits(self) -> None:
        shade = forecast(lambda _east, _north, _lead: False)
        state, missions = decided(shade, *HERE, state=started("nearest_sunlit"))
        assert missions == ()
        texts = {each.text for each in state.decisions.values()}
        assert texts == {"waits: no free row is in sun"}

    def test_a_whole_survey_ends_in_sun(self) -> None:
        flyers = fleet(2)
        survey = replace(SURVEY, planner="nearest_sunlit", budget=SurveyBudget(rounds=5))
        flights = Flights(begun(survey, flyers), flyers, sky=opens_after_60_s)
        state = flights.run()
        assert state.phase is SurveyPhase.DONE
        assert (state.progress.state[state.plan.cells.is_reached] == CellState.IN_SUN).mean() > 0.98
