"""The end of a survey without sun, and its reason."""

from dataclasses import replace

import numpy as np
import pytest
from tests.examples import family
from tests.guidance.survey.fields import FRAME, rectangle, region, survey_of
from tests.guidance.survey.flyers import BoolArray, Flights, FloatArray, clear, fleet
from tests.guidance.survey.test_flown import begun

from recon.guidance.survey import SurveyState, figures, pause, plan_survey, start, step
from recon.model.command import Refusal
from recon.model.survey import SurveyBudget, SurveyPhase
from recon.model.units import seconds_to_ns


def closed(places_m: FloatArray, time_s: float) -> BoolArray:
    """An overcast day."""
    return np.zeros(len(places_m), dtype=np.bool_)


def flown(tells_shade: bool = True, sky=closed, **budget: object) -> Flights:  # type: ignore[no-untyped-def]
    flyers = fleet(2)
    survey = survey_of(
        rectangle(),
        planner="lawnmower_again",
        budget=SurveyBudget(**budget),  # type: ignore[arg-type]
    )
    flights = Flights(begun(survey, flyers), flyers, sky, tells_shade=tells_shade)
    flights.run()
    return flights


@pytest.mark.parametrize(("rounds", "words"), [(1, "The only round"), (3, "All 3 rounds")])
def test_under_a_closed_sky_its_rounds_end_it(rounds: int, words: str) -> None:
    end = flown(rounds=rounds).state
    assert (end.phase, end.round) == (SurveyPhase.DONE, rounds)
    assert end.reason == (
        f"{words} flown; of 6.00 ha, 6.00 ha imaged in shade only, 0.00 ha not imaged"
    )


def test_under_a_closed_sky_its_time_ends_it_and_who_flies_flies_to_the_end() -> None:
    flights = flown(time_s=300.0)
    end = flights.state
    assert end.phase is SurveyPhase.DONE
    assert end.reason.startswith("Time budget of 300 s spent; of 6.00 ha, ")
    assert 300.0 <= flights.time_s < 600.0
    assert all(not flyer.is_flying for flyer in flights.flyers)


def test_its_metres_end_it() -> None:
    end = flown(flown_m=100.0).state
    assert end.reason.startswith("Distance budget of 100 m flown; of 6.00 ha, ")
    assert end.round == 1


def test_without_shade_maps_nothing_is_flown_again_for_sun() -> None:
    end = flown(tells_shade=False).state
    assert (end.phase, end.round) == (SurveyPhase.DONE, 1)
    assert "light unknown" in end.reason
    assert figures(end).not_yet_m2 <= 0.01 * figures(end).region_m2


def test_in_sun_it_ends_after_one_round() -> None:
    end = flown(sky=clear).state
    assert (end.round, end.reason) == (1, "Complete: all reachable ground photographed in sun")


def west_of_260_m(places_m: FloatArray, time_s: float) -> BoolArray:
    return np.asarray(places_m[:, 0] < 260.0)


@pytest.mark.parametrize("planner", ["lawnmower_again", "sunlit_first"])
def test_ground_outside_the_imaging_drones_view_is_flown_once(planner: str) -> None:
    flyers = fleet(1)
    survey = survey_of(rectangle(), planner=planner)
    flights = Flights(begun(survey, flyers), flyers, clear, view=west_of_260_m)
    end = flights.run(3_000.0)
    assert end.phase is SurveyPhase.DONE
    not_shown_m2 = figures(end).not_shown_m2
    assert not_shown_m2 == pytest.approx(8_000.0, rel=0.02)
    assert figures(end).sun_unknown_m2 == pytest.approx(not_shown_m2, rel=0.02)
    assert end.reason == (
        "Complete: all reachable ground photographed in sun where shade maps show it; of 6.00 ha, "
        f"{not_shown_m2 / 10_000.0:.2f} ha are not shown by them: photographed, light unknown"
    )
    assert flights.shown is not None
    assert flights.shown[end.plan.cells.is_inside].mean() > 0.99
    alone = fleet(1)
    once = Flights(begun(survey_of(rectangle()), alone), alone, clear)
    once.run()
    assert flights.time_s < 1.3 * once.time_s


def test_what_the_imaging_drone_loses_from_view_for_a_while_is_flown_for_sun() -> None:
    """It side-steps for 90 s, while the last of the field is flown."""

    def aside(places_m: FloatArray, time_s: float) -> BoolArray:
        return np.full(len(places_m), not 60.0 <= time_s < 150.0)

    flyers = fleet(2)
    survey = survey_of(rectangle(), planner="lawnmower_again")
    flights = Flights(begun(survey, flyers), flyers, clear, view=aside)
    end = flights.run(3_000.0)
    assert end.reason == "Complete: all reachable ground photographed in sun"
    assert end.round == 2


def test_flat_light_does_not_make_known_shade_unknown() -> None:
    """A method that decides a corner of the field alone shows nothing about the rest."""

    def corner_from_200_to_600_s(places_m: FloatArray, time_s: float) -> BoolArray:
        in_corner = (places_m < 14.0).all(axis=1)
        return in_corner if 200.0 < time_s < 600.0 else np.ones_like(in_corner)

    def sun_from_700_s(places_m: FloatArray, time_s: float) -> BoolArray:
        return np.full(len(places_m), time_s > 700.0)

    flyers = fleet(1)
    survey = survey_of(rectangle(240.0, 120.0), bearing_deg=90.0, planner="sunlit_first")
    view = corner_from_200_to_600_s
    flights = Flights(begun(survey, flyers), flyers, sun_from_700_s, view=view)
    end = flights.run(3_000.0)
    assert end.reason == "Complete: all reachable ground photographed in sun"
    assert figures(end).in_sun_m2 > 0.98 * figures(end).reached_m2
    assert flights.time_s > 700.0


@pytest.mark.parametrize("rounds", family(1, 2))
def test_losing_the_light_uses_up_no_round_of_a_planner_that_has_none(rounds: int) -> None:
    def away_each_second_400_s(flights: Flights) -> None:
        flights.tells_shade = (flights.time_s // 400.0) % 2 == 0

    flyers = fleet(1)
    budget = SurveyBudget(rounds=rounds)
    survey = survey_of(
        rectangle(800.0, 300.0), bearing_deg=90.0, planner="sunlit_first", budget=budget
    )
    flights = Flights(begun(survey, flyers), flyers)
    end = flights.run(8_000.0, away_each_second_400_s)
    assert end.reason == "Complete: all reachable ground photographed in sun"
    assert figures(end).not_yet_m2 <= 0.01 * figures(end).reached_m2


def test_a_row_that_the_nearest_battery_does_not_last_for_is_another_vehicles() -> None:
    flyers = fleet(2)
    flyers[0] = replace(flyers[0], place_m=(0.0, -20.0), home_m=(0.0, -20.0), endurance_s=15.0)
    flyers[1] = replace(flyers[1], place_m=(300.0, -20.0), home_m=(300.0, -20.0))
    flyers[1].endurance_s = 6_000.0
    survey = survey_of(rectangle(45.0, 25.0), bearing_deg=90.0)
    flights = Flights(begun(survey, flyers), flyers)
    end = flights.run(600.0)
    assert end.phase is SurveyPhase.DONE
    assert {mission.serial for mission in flights.given} == {flyers[1].serial}


def test_a_region_without_a_cell_is_refused() -> None:
    """Between two columns of the cells' middles."""
    strip = region([(2.1, 0.0), (5.9, 0.0), (5.9, 300.0), (2.1, 300.0)])
    refusal = plan_survey(survey_of(strip), FRAME)
    assert isinstance(refusal, Refusal)
    assert "draw it larger" in refusal.reason


@pytest.mark.parametrize("planner", ["lawnmower_once", "lawnmower_again", "sunlit_first"])
@pytest.mark.parametrize("budget", [{"flown_m": 10.0}, {"time_s": 60.0}])
def test_photos_of_the_last_row_count_before_a_budget_ends_it(
    planner: str, budget: dict[str, float]
) -> None:
    def last_counted(**limits: float) -> float:
        flyers = fleet(1)
        survey = survey_of(
            rectangle(200.0, 20.0),
            bearing_deg=90.0,
            planner=planner,
            budget=SurveyBudget(**limits),  # type: ignore[arg-type]
        )
        end = Flights(begun(survey, flyers), flyers).run(600.0)
        return figures(end).not_yet_m2

    assert last_counted(**budget) == pytest.approx(last_counted(), abs=1.0)


@pytest.mark.parametrize("budget", [{"time_s": -1.0}, {"flown_m": 0.0}, {"time_s": float("nan")}])
def test_a_budget_of_nothing_is_refused(budget: dict[str, float]) -> None:
    survey = survey_of(rectangle(), budget=SurveyBudget(**budget))  # type: ignore[arg-type]
    refusal = plan_survey(survey, FRAME)
    assert isinstance(refusal, Refusal)
    assert "expected more than 0, or none" in refusal.reason


def test_a_pause_gives_back_the_metres_that_were_not_flown() -> None:
    flyers = fleet(1)
    state = begun(survey_of(rectangle()), flyers)
    for n in range(5):
        state, (mission,) = step(state, [flyers[0].surveyor()], seconds_to_ns(10.0 * n + 5.0))
        assert state.flown_m == pytest.approx(mission.length_m)
        paused = pause(state, seconds_to_ns(10.0 * n + 6.0))
        assert isinstance(paused, SurveyState)
        assert paused.flown_m == pytest.approx(0.0, abs=1e-6)
        again = start(paused, ["S-1"], seconds_to_ns(10.0 * n + 7.0))
        assert isinstance(again, SurveyState)
        state = again
