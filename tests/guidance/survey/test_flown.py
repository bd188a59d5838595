"""Surveys flown to their ends by vehicles with camera timers of unknown phase."""

from dataclasses import replace

import numpy as np
import pytest
from tests.guidance.survey.fields import FRAME, holed, l_shape, planned, rectangle, survey_of
from tests.guidance.survey.flyers import (
    BoolArray,
    Flights,
    FloatArray,
    begun,
    clear,
    fleet,
)

from recon.guidance.survey import (
    Surveyor,
    SurveyPlan,
    SurveyState,
    SurveySurroundings,
    abort,
    create,
    figures,
    pause,
    plan_survey,
    refused,
    start,
    step,
)
from recon.guidance.survey.settings import DEFAULT
from recon.model.airspace import Region
from recon.model.command import Refusal
from recon.model.survey import CellState, SurveyBudget, SurveyPhase
from recon.model.units import seconds_to_ns


def half_shaded(places_m: FloatArray, time_s: float) -> BoolArray:
    """A shadow over the west of the field that leaves it at 3 m/s, 30 s after the start."""
    return np.asarray(places_m[:, 0] > 200.0 - 3.0 * (time_s - 30.0))


def dark(places_m: FloatArray, time_s: float) -> BoolArray:
    return np.zeros(len(places_m), dtype=np.bool_)


class TestOnce:
    @pytest.mark.parametrize("count", [1, 3, 8])
    @pytest.mark.parametrize("field", [l_shape(), holed(), rectangle()], ids="LHR")
    def test_a_field_is_imaged_in_one_round(self, field: Region, count: int) -> None:
        flyers = fleet(count)
        flights = Flights(begun(survey_of(field), flyers), flyers)
        end = flights.run()
        assert (end.phase, end.round) == (SurveyPhase.DONE, 1), end.reason
        assert figures(end).not_yet_m2 <= 0.01 * figures(end).region_m2
        assert len(flights.given) <= count

    def test_cells_counted_as_imaged_or_in_sun_are_so_on_a_photo(self) -> None:
        wrong = counted = 0
        for seed in range(6):
            flyers = fleet(2, seed)
            flights = Flights(begun(survey_of(holed()), flyers), flyers, half_shaded)
            end = flights.run()
            assert flights.shown is not None
            assert flights.shown_in_sun is not None
            imaged = end.progress.state >= CellState.IN_SHADE
            assert imaged.sum() > 5000
            assert not (imaged & ~flights.shown).any()
            in_sun = end.progress.state == CellState.IN_SUN
            wrong += int((in_sun & ~flights.shown_in_sun).sum())
            counted += int(in_sun.sum())
        assert counted > 10_000
        assert wrong < 0.002 * counted

    def test_three_take_about_a_third_of_the_time(self) -> None:
        times_s = []
        for count in (1, 3):
            flyers = fleet(count)
            end = Flights(begun(survey_of(rectangle(600, 400)), flyers), flyers).run()
            time_s = figures(end).time_to_95_imaged_s
            assert time_s is not None
            times_s.append(time_s)
        assert times_s[1] < 0.45 * times_s[0]

    def test_without_shade_maps_nothing_is_in_sun_and_the_light_is_unknown(self) -> None:
        flyers = fleet(1)
        end = Flights(begun(survey_of(rectangle()), flyers), flyers, tells_shade=False).run()
        found = figures(end)
        assert found.in_sun_m2 == 0.0
        assert found.in_shade_m2 == 0.0
        assert found.sun_unknown_m2 > 0.99 * found.region_m2
        assert found.time_to_95_in_sun_s is None

    def test_slow_and_late_positions_serve_too(self) -> None:
        flyers = fleet(1, every=10, late_s=0.6)
        end = Flights(begun(survey_of(rectangle()), flyers), flyers).run()
        assert (end.phase, end.round) == (SurveyPhase.DONE, 1)

    def test_at_another_height_nothing_counts(self) -> None:
        flyers = fleet(1, height_m=70.0)
        budget = SurveyBudget(rounds=1)
        end = Flights(begun(survey_of(rectangle(), budget=budget), flyers), flyers).run()
        assert end.reason == "The only round flown; of 6.00 ha, 6.00 ha not imaged"
        assert figures(end).not_yet_m2 == figures(end).region_m2


class TestAgain:
    def test_what_was_in_shade_is_flown_again(self) -> None:
        flyers = fleet(3)
        survey = survey_of(rectangle(), planner="lawnmower_again")
        flights = Flights(begun(survey, flyers), flyers, half_shaded)
        end = flights.run()
        assert (end.phase, end.reason) == (
            SurveyPhase.DONE,
            "Complete: all reachable ground photographed in sun",
        )
        assert end.round > 1
        first, later = flights.given[:3], flights.given[3:]
        assert sum(m.length_m for m in later) < sum(m.length_m for m in first)
        assert flights.shown_in_sun is not None
        seen_in_sun = flights.shown_in_sun[end.plan.cells.is_inside].mean()
        assert seen_in_sun >= 0.99

    def test_under_a_clear_sky_nothing_is_flown_again(self) -> None:
        flyers = fleet(3)
        survey = survey_of(rectangle(), planner="lawnmower_again")
        end = Flights(begun(survey, flyers), flyers, clear).run()
        assert (end.phase, end.round) == (SurveyPhase.DONE, 1)

    @pytest.mark.parametrize(
        ("budget", "words"),
        [
            (SurveyBudget(rounds=3), "3 rounds"),
            (SurveyBudget(rounds=99, time_s=400.0), "400 s"),
            (SurveyBudget(rounds=99, flown_m=4_000.0), "4000 m"),
        ],
    )
    def test_under_a_closed_sky_the_budget_ends_it(self, budget: SurveyBudget, words: str) -> None:
        flyers = fleet(2)
        survey = survey_of(rectangle(), planner="lawnmower_again", budget=budget)
        flights = Flights(begun(survey, flyers), flyers, dark)
        end = flights.run(most_s=2_000.0)
        assert end.phase is SurveyPhase.DONE
        assert words in end.reason
        assert figures(end).in_sun_m2 == 0.0
        assert sum(m.length_m for m in flights.given) == pytest.approx(end.flown_m)


class TestTroubles:
    def test_the_rows_of_one_who_drops_out_go_to_the_others(self) -> None:
        flyers = fleet(3)

        def lose(flights: Flights) -> None:
            if flights.time_s > 60.0 and flyers[1].is_available:
                flyers[1].is_available = False
                flyers[1].stop()

        flights = Flights(begun(survey_of(rectangle()), flyers), flyers)
        end = flights.run(each_second=lose)
        assert (end.phase, end.round) == (SurveyPhase.DONE, 2)
        assert {m.serial for m in flights.given[3:]} == {"S-1", "S-3"}

    def test_a_pilot_who_takes_over_gives_the_rows_to_the_others(self) -> None:
        flyers = fleet(2)

        def take(flights: Flights) -> None:
            if flights.time_s == pytest.approx(60.0, abs=0.5):
                flyers[0].stop()

        end = Flights(begun(survey_of(rectangle()), flyers), flyers).run(each_second=take)
        assert (end.phase, end.round) == (SurveyPhase.DONE, 2)

    def test_a_battery_flies_its_share_in_several_missions(self) -> None:
        flyers = fleet(1, endurance_s=200.0, home_m=(0.0, -40.0))

        def swap(flights: Flights) -> None:
            if not flyers[0].is_flying:
                flyers[0].flown_s = 0.0

        survey = survey_of(rectangle(500, 300), bearing_deg=90.0)
        flights = Flights(begun(survey, flyers), flyers)
        end = flights.run(each_second=swap)
        assert (end.phase, end.round) == (SurveyPhase.DONE, 1)
        assert len(flights.given) > 3
        assert all(m.length_m < 8.0 * 160.0 for m in flights.given)

    def test_the_ways_there_and_home_are_of_the_battery(self) -> None:
        for place_m, home_m, is_given in (
            ((0.0, 0.0), (0.0, 0.0), True),
            ((0.0, -1500.0), (0.0, 0.0), False),
            ((0.0, 0.0), (0.0, -1500.0), False),
        ):
            state = begun(survey_of(rectangle()), fleet(1))
            surveyor = Surveyor("S-1", place_m, time_left_s=200.0, home_m=home_m)
            assert bool(step(state, [surveyor], 10**10)[1]) == is_given

    def test_the_next_round_waits_until_the_last_positions_count(self) -> None:
        state = begun(survey_of(rectangle()), fleet(1))
        state, (first,) = step(state, [Surveyor("S-1", (0.0, 0.0))], seconds_to_ns(10.0))
        flown = Surveyor("S-1", (0.0, 0.0), ended_mission=first.number)
        given = []
        for second in (20.0, 21.0, 22.0, 23.0):
            state, missions = step(state, [flown], seconds_to_ns(second))
            given.append(len(missions))
        assert given == [0, 0, 0, 1]
        assert state.round == 2

    def test_an_empty_battery_waits(self) -> None:
        flyers = fleet(1, endurance_s=10.0)
        flights = Flights(begun(survey_of(rectangle()), flyers), flyers)
        waiting = flights.run(most_s=20.0)
        assert waiting.phase is SurveyPhase.RUNNING
        assert waiting.round == 0
        assert "no battery lasts" in waiting.reason
        assert not flights.given

    def test_without_an_able_vehicle_it_waits(self) -> None:
        flyers = fleet(1, is_available=False)
        waiting = Flights(begun(survey_of(rectangle()), flyers), flyers).run(most_s=20.0)
        assert "no vehicle can fly now" in waiting.reason

    def test_when_all_missions_are_refused_it_pauses_with_the_reason(self) -> None:
        flyers = fleet(2)

        def refuse(flights: Flights) -> None:
            for given in flights.given:
                next(f for f in flyers if f.serial == given.serial).stop()
                flights.state = refused(
                    flights.state,
                    given.serial,
                    given.number,
                    "it crosses the pond",
                    seconds_to_ns(flights.time_s),
                )

        flights = Flights(begun(survey_of(rectangle()), flyers), flyers)
        end = flights.run(most_s=60.0, each_second=refuse)
        assert end.phase is SurveyPhase.PAUSED
        assert "it crosses the pond" in end.reason
        assert end.flown_m == pytest.approx(0.0)

    def test_one_refused_for_good_leaves_its_rows_to_the_other(self) -> None:
        flyers = fleet(2)

        def refuse(flights: Flights) -> None:
            flight = flights.state.flights.get("S-1")
            if flight is not None:
                flyers[0].stop()
                now_ns = seconds_to_ns(flights.time_s)
                flights.state = refused(flights.state, "S-1", flight.number, "no", now_ns)

        flights = Flights(begun(survey_of(rectangle()), flyers), flyers)
        end = flights.run(each_second=refuse)
        assert (end.phase, end.round) == (SurveyPhase.DONE, 1)
        assert end.barred == {"S-1"}
        assert sum(m.length_m for m in flights.given if m.serial == "S-2") > 1_500.0

    def test_one_refused_while_others_fly_is_asked_for_again(self) -> None:
        flyers = fleet(2)

        def refuse(flights: Flights) -> None:
            flight = flights.state.flights.get("S-1")
            if flight is not None and flights.time_s < 20.0:
                flyers[0].stop()
                now_ns = seconds_to_ns(flights.time_s)
                flights.state = refused(flights.state, "S-1", flight.number, "near", now_ns)

        flights = Flights(begun(survey_of(rectangle()), flyers), flyers)
        end = flights.run(each_second=refuse)
        assert (end.phase, end.round) == (SurveyPhase.DONE, 1)
        asked = [m.length_m for m in flights.given if m.serial == "S-1"]
        assert len(asked) == 3
        assert asked[0] == asked[1] == asked[2]

    def test_one_refused_for_what_may_end_is_asked_for_again_also_alone(self) -> None:
        flyers = fleet(1)
        asked_s = []

        def refuse(flights: Flights) -> None:
            flight = flights.state.flights.get("S-1")
            if flight is not None and len(asked_s) < 2:
                asked_s.append(flights.time_s)
                flyers[0].stop()
                now_ns = seconds_to_ns(flights.time_s)
                number = flight.number
                flights.state = refused(flights.state, "S-1", number, "late", now_ns, may_end=True)

        flights = Flights(begun(survey_of(rectangle()), flyers), flyers)
        end = flights.run(each_second=refuse)
        assert (end.phase, end.round, end.barred) == (SurveyPhase.DONE, 1, frozenset())
        assert asked_s[1] - asked_s[0] == pytest.approx(DEFAULT.retry_soon_s)

    def test_a_field_in_two_parts_is_flown_in_two_missions(self) -> None:
        across = Region(np.array([(130.0, -50.0), (160.0, -50.0), (160.0, 250.0), (130.0, 250.0)]))
        plan = plan_survey(survey_of(rectangle()), FRAME, SurveySurroundings(keep_out=(across,)))
        assert isinstance(plan, SurveyPlan)
        created = create(plan)
        assert isinstance(created, SurveyState)
        state = start(created, ["S-1"], 0)
        assert isinstance(state, SurveyState)
        flights = Flights(state, fleet(1))
        end = flights.run()
        assert (end.phase, end.round, len(flights.given)) == (SurveyPhase.DONE, 1, 2)
        found = figures(end)
        assert 0.75 * found.region_m2 < found.reached_m2 < 0.95 * found.region_m2
        assert found.not_yet_m2 < found.region_m2 - found.reached_m2 + 500.0


class TestLife:
    def test_after_a_pause_only_the_rest_is_flown(self) -> None:
        flyers = fleet(1)
        flights = Flights(begun(survey_of(rectangle()), flyers), flyers)
        flights.run(most_s=120.0)
        paused = pause(flights.state, 0)
        assert isinstance(paused, SurveyState)
        assert (paused.phase, paused.round, dict(paused.flights)) == (SurveyPhase.PAUSED, 0, {})
        flyers[0].stop()
        again = start(paused, ["S-1"], 0)
        assert isinstance(again, SurveyState)
        flights.state = again
        end = flights.run()
        assert (end.phase, end.round) == (SurveyPhase.DONE, 1)
        first, second = flights.given
        assert second.length_m < 0.75 * first.length_m

    def test_an_aborted_one_never_flies_again(self) -> None:
        flyers = fleet(1)
        flights = Flights(begun(survey_of(rectangle()), flyers), flyers)
        flights.run(most_s=60.0)
        aborted = abort(flights.state, 60 * 10**9)
        assert isinstance(aborted, SurveyState)
        assert aborted.phase is SurveyPhase.ABORTED
        assert aborted.ended_at_ns == 60 * 10**9
        flights.state = aborted
        flights._second()
        assert flights.state is aborted
        assert figures(aborted).in_sun_m2 > 0.0
        for again in (start(aborted, ["S-1"], 0), pause(aborted, 0), abort(aborted, 0)):
            assert isinstance(again, Refusal)
            assert "is aborted and cannot be" in again.reason

    def test_what_cannot_be_created_or_started_is_refused(self) -> None:
        unknown = create(planned(replace(survey_of(rectangle()), planner="zigzag")))
        assert isinstance(unknown, Refusal)
        assert "choose lawnmower_once or lawnmower_again" in unknown.reason
        created = create(planned(survey_of(rectangle())))
        assert isinstance(created, SurveyState)
        assert isinstance(start(created, [], 0), Refusal)
        assert isinstance(pause(created, 0), Refusal)

    def test_the_state_before_is_never_changed(self) -> None:
        flyers = fleet(1)
        flights = Flights(begun(survey_of(rectangle()), flyers), flyers)
        flights.run(most_s=30.0)
        before = flights.state
        kept = before.progress.state.copy()
        flights.run(most_s=60.0)
        assert np.array_equal(before.progress.state, kept)
        assert (flights.state.progress.state > kept).any()
