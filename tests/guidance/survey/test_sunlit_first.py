"""The planner that flies what is in sun first: whole surveys, and single decisions."""

from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from tests.examples import family
from tests.guidance.survey.decisions import (
    GRID,
    PLAN,
    SURVEY,
    decided,
    flown_rows,
    forecast,
    still,
)
from tests.guidance.survey.fields import planned
from tests.guidance.survey.flyers import (
    BoolArray,
    Flights,
    FloatArray,
    Flyer,
    begun,
    clear,
    east_north,
    fleet,
    middles_m,
)

from recon.guidance.survey import (
    ClosedArea,
    Surveyor,
    SurveyPlan,
    SurveyState,
    create,
    figures,
    observe_shade,
    refused,
    returning,
    start,
    step,
)
from recon.guidance.survey.closed_areas import closed_ground
from recon.guidance.survey.own_share import finished_together_s
from recon.guidance.survey.route import RowLeg
from recon.guidance.survey.segments import NONE, expected_sun, segments_of
from recon.guidance.survey.vehicle_choice import named
from recon.model.shade import ShadeMap, SunForecast
from recon.model.survey import CellState, MissionAssignment, SurveyBudget, SurveyPhase, WhenDone
from recon.model.units import seconds_to_ns

CHANGES = "returns to change its battery: little sun is expected for 5 min"
WAITS_BELOW = "returns to wait on the ground: little sun is expected for 2.5 min"


def started(flyers: list[Flyer], planner: str = "sunlit_first") -> SurveyState:
    return begun(replace(SURVEY, planner=planner, budget=SurveyBudget(rounds=20)), flyers)


def leaves_eastwards(places_m: FloatArray, time_s: float) -> BoolArray:
    """Shade over all but the western rim at first; its edge moves east at 1 m/s."""
    return np.asarray(places_m[:, 0] < 60.0 + 1.0 * time_s)


def in_bands(places_m: FloatArray, time_s: float) -> BoolArray:
    """Bands of shade, 150 m wide and as far apart, move north-east at 2 m/s."""
    along_m = (places_m[:, 0] + places_m[:, 1]) / np.sqrt(2.0) - 2.0 * time_s
    return np.asarray(np.mod(along_m, 300.0) < 150.0)


def lit_west(now_s: float) -> SunForecast:
    """Sun over the western third."""
    return forecast(lambda east, _north, _lead: east < 120.0, now_s)


def clear_sky(_east: FloatArray, _north: FloatArray, _lead_s: float) -> bool:
    return True


class TestSurveys:
    @pytest.mark.parametrize("sky", [*family(leaves_eastwards, in_bands), clear])
    def test_all_is_imaged_in_sun_as_photos_truly_show(self, sky: object) -> None:
        flights = Flights(started(fleet(3)), fleet(3), sky=sky)  # type: ignore[arg-type]
        state = flights.run()
        assert state.phase is SurveyPhase.DONE
        assert state.reason == "Complete: all reachable ground photographed in sun"
        counted = state.progress.state == CellState.IN_SUN
        assert flights.shown_in_sun is not None
        assert not (counted & ~flights.shown_in_sun).any()
        assert figures(state).in_sun_m2 > 0.98 * figures(state).reached_m2

    @pytest.mark.flight
    def test_under_broken_shade_it_is_sooner_done_than_flying_all_again(self) -> None:
        ratios = []
        for phase_m in (0.0, 100.0, 200.0):

            def sky(places_m: FloatArray, time_s: float, phase_m: float = phase_m) -> BoolArray:
                return in_bands(places_m - phase_m, time_s)

            took_s = []
            for planner in ("sunlit_first", "lawnmower_again"):
                flights = Flights(started(fleet(3), planner), fleet(3), sky=sky, foresees=True)
                took_s.append(figures(flights.run()).time_to_95_in_sun_s)
            assert took_s[0] is not None
            assert took_s[1] is not None
            ratios.append(np.log(took_s[0] / took_s[1]))
        assert np.mean(ratios) < np.log(0.95)

    def test_under_a_clear_sky_it_costs_little_over_one_round(self) -> None:
        took_s = []
        for planner in ("sunlit_first", "lawnmower_once"):
            flights = Flights(started(fleet(3), planner), fleet(3), foresees=True)
            took_s.append(figures(flights.run()).time_to_95_imaged_s)
        assert took_s[0] is not None
        assert took_s[1] is not None
        assert took_s[0] < 1.05 * took_s[1]

    @pytest.mark.flight
    def test_two_vehicles_never_fly_the_same_ground_at_once(self) -> None:
        segments = segments_of(PLAN)
        flights = Flights(started(fleet(3)), fleet(3), sky=in_bands)

        def check(now: Flights) -> None:
            under = [segments.under(flight.route) for flight in now.state.flights.values()]
            assert not any((a & b).any() for a, b in combinations(under, 2))

        flights.run(each_second=check)
        assert len(flights.given) > 3

    @pytest.mark.flight
    def test_the_rest_is_flown_without_a_vehicle_that_drops_out(self) -> None:
        flyers = fleet(3)
        flights = Flights(started(flyers), flyers, sky=in_bands)
        flights.run(60.0)
        flyers[1].stop()
        flyers[1].is_available = False
        state = flights.run()
        assert state.phase is SurveyPhase.DONE
        assert figures(state).in_sun_m2 > 0.98 * figures(state).reached_m2

    def test_without_any_light_it_is_flown_once(self) -> None:
        flights = Flights(started(fleet(2)), fleet(2), tells_shade=False)
        state = flights.run()
        assert state.phase is SurveyPhase.DONE
        assert "light unknown" in state.reason
        assert state.round == 1

    def test_a_low_battery_gets_what_it_lasts_for(self) -> None:
        flyers = fleet(1, endurance_s=160.0, home_m=(0.0, -40.0))
        flights = Flights(started(flyers), flyers)
        flights.run(400.0)
        assert flights.state.phase is SurveyPhase.RUNNING
        assert flyers[0].flown_s < 160.0
        assert flights.state.decisions["S-1"].text == (
            "waits: its battery lasts for no row, the path there and the return"
        )
        assert 0.0 < figures(flights.state).in_sun_m2 < figures(flights.state).region_m2

    @pytest.mark.parametrize("left_s", [None, 200.0, 300.0])
    def test_the_decision_names_the_rows_that_the_battery_lasts_for(
        self, left_s: float | None
    ) -> None:
        sun = forecast(clear_sky)
        state, missions = decided(sun, Surveyor("S-1", (0.0, 0.0), time_left_s=left_s))
        assert len(missions) == 1
        rows = [row + 1 for row in flown_rows(state, "S-1")]
        assert (len(rows) == 8) is (left_s is None)
        what = f"rows {min(rows)} to {max(rows)}"
        assert state.decisions["S-1"].text == f"flies {what}: probability of sun 1.0"

    def test_when_all_missions_are_refused_it_pauses_with_the_reason(self) -> None:
        def refuse(flights: Flights) -> None:
            for serial, flight in flights.state.flights.items():
                next(each for each in flights.flyers if each.serial == serial).stop()
                now_ns = seconds_to_ns(flights.time_s)
                why = "it crosses the pond"
                flights.state = refused(flights.state, serial, flight.number, why, now_ns)

        flyers = fleet(2)
        end = Flights(started(flyers), flyers).run(most_s=60.0, each_second=refuse)
        assert end.phase is SurveyPhase.PAUSED
        assert "it crosses the pond" in end.reason

    def test_ground_where_a_lost_vehicle_may_be_waits_and_all_other_is_flown(self) -> None:
        """It is lost over the middle of the field for as long as all the rest takes."""
        flyers = fleet(2)
        lost = ClosedArea("Drone 3", "S-3", (180.0, 120.0), 60.0, (180.0, -100.0), 20.0)
        ground = closed_ground([lost])
        flights = Flights(started(flyers), flyers, closed=(lost,))
        flights.run(most_s=400.0)
        state, plan = flights.state, flights.plan
        assert state.phase is SurveyPhase.RUNNING
        assert {each.text for each in state.decisions.values()} == {
            "waits: Drone 3, without telemetry, may be where rows are left"
        }
        paths = [shapely.linestrings(east_north(m.mission, plan)) for m in flights.given]
        assert not shapely.intersects(ground, paths).any()
        far = shapely.buffer(ground, 90.0)
        middles = shapely.points(middles_m(plan.cells.grid)).reshape(state.progress.state.shape)
        is_far = plan.cells.is_reached & ~shapely.covers(far, middles)
        assert is_far.sum() > 0.2 * plan.cells.is_reached.sum()
        assert (state.progress.state[is_far] == CellState.IN_SUN).all()
        flights.closed = ()
        assert flights.run().phase is SurveyPhase.DONE

    def test_rows_that_a_lost_vehicle_may_still_fly_are_left_to_it(self) -> None:
        sun = forecast(lambda _east, _north, _lead: True)
        here = Surveyor("S-1", (0.0, 60.0)), Surveyor("S-2", (0.0, 180.0))
        state, _missions = decided(sun, *here)
        rows = set(flown_rows(state, "S-2"))
        lost = ClosedArea("Drone 2", "S-2", (-500.0, 180.0), 60.0, None, 20.0)
        gone = replace(here[0], ended_mission=1), replace(here[1], is_available=False)

        def after(
            state: SurveyState, now_s: float, ended: int, *closed: ClosedArea
        ) -> tuple[SurveyState, tuple[MissionAssignment, ...]]:
            lit = forecast(lambda _east, _north, _lead: True, now_s)
            vehicles = replace(gone[0], ended_mission=ended), gone[1]
            return decided(lit, *vehicles, state=state, now_s=now_s, closed=closed)

        state, _none = after(state, 60.0, 1, lost)
        state, missions = after(state, 300.0, 1, lost)
        assert [mission.serial for mission in missions] == ["S-1"]
        assert not rows & set(flown_rows(state, "S-1"))
        state, _none = after(state, 400.0, missions[0].number)
        state, _missions = after(state, 410.0, missions[0].number)
        assert rows <= set(flown_rows(state, "S-1"))

    def test_before_motion_is_known_sunlit_rows_are_begun_and_decided_on_again(self) -> None:
        """The climb loses no time; where it goes is decided when the motion is known, at the latest
        after 9 s."""

        def west(east_m: np.ndarray, _north_m: np.ndarray, _lead_s: float) -> np.ndarray:
            return east_m < 180.0

        def moved(east_m: np.ndarray, _north_m: np.ndarray, lead_s: float) -> np.ndarray:
            return (east_m < 180.0) == (lead_s < 10.0)

        here = Surveyor("S-1", (-100.0, 60.0)), Surveyor("S-2", (-100.0, 180.0))
        state, missions = decided(still(west), *here, now_s=1.0)
        assert [each.serial for each in missions] == ["S-1", "S-2"]
        assert decided(still(west, 3.0), *here, state=state, now_s=3.0)[1] == ()
        known = decided(forecast(moved, 3.0), *here, state=state, now_s=3.0)
        assert {each.text for each in known[0].decisions.values()} != {
            each.text for each in state.decisions.values()
        }
        assert decided(forecast(moved, 4.0), *here, state=known[0], now_s=4.0)[1] == ()
        late, _missions = decided(still(moved, 16.0), *here, state=state, now_s=16.0)
        assert not any(flight.is_in_any_light for flight in late.flights.values())

    def test_where_shade_is_flown_first_the_first_missions_wait_for_the_motion(self) -> None:
        def far(east_m: np.ndarray, _north_m: np.ndarray, _lead_s: float) -> np.ndarray:
            return east_m > 1_000.0

        here = Surveyor("S-1", (0.0, 60.0)), Surveyor("S-2", (0.0, 180.0))
        state, missions = decided(still(far), *here, now_s=1.0)
        assert (missions, state.reason) == ((), "waiting: how shadows move is not known yet")
        # Where no motion is found it does not wait for ever.
        state, _missions = decided(still(far, 16.0), *here, state=state, now_s=16.0)
        assert state.reason == "under way"

    def test_a_forecast_that_sees_nothing_now_shows_no_motion_to_wait_for(self) -> None:
        """What a shade map showed before still counts."""
        here = Surveyor("S-1", (0.0, 60.0)), Surveyor("S-2", (0.0, 180.0))
        flights = Flights(started(fleet(2)), fleet(2), sky=in_bands)
        seen = observe_shade(flights.state, flights.shade_map())
        unseen = np.full((GRID.rows, GRID.cols), np.nan, dtype=np.float32)
        blind = replace(forecast(clear_sky), horizon_s=unseen, velocity_mps=None)
        state, missions = decided(blind, *here, state=seen, now_s=1.0)
        assert len(missions) == 2
        assert state.reason == "under way"

    def test_a_part_of_a_row_is_named_so(self) -> None:
        whole = PLAN.pieces[0]
        half = replace(whole, end_m=whole.start_m + whole.length_m / 2)
        assert named([RowLeg(half, is_reversed=False)], PLAN) == f"part of row {whole.row + 1}"
        assert named([RowLeg(whole, is_reversed=True)], PLAN) == f"row {whole.row + 1}"

    def test_until_any_light_is_known_rows_are_flown_and_then_decided_on(self) -> None:
        here, unseen = Surveyor("S-1", (0.0, 0.0)), np.full((GRID.rows, GRID.cols), np.nan)
        blind = replace(lit_west(10.0), horizon_s=unseen.astype(np.float32), velocity_mps=None)
        state, given = decided(blind, here, now_s=10.0)
        assert len(given) == 1
        rows = {row + 1 for row in flown_rows(state, "S-1")}
        assert state.decisions["S-1"].text == (
            f"flies rows {min(rows)} to {max(rows)}; light not known yet"
        )
        # On its way to the first row: most of what it has is in shade.
        state, instead = decided(lit_west(13.0), here, state=state, now_s=13.0)
        assert len(instead) == 1
        assert state.decisions["S-1"].text.startswith("leaves its rows; flies ")
        _later, none = decided(lit_west(14.0), here, state=state, now_s=14.0)
        assert none == ()
        # Where it is in sun, its rows are flown on; it is looked at once.
        state, _given = decided(blind, here, now_s=10.0)
        kept, none = decided(forecast(clear_sky, 13.0), here, state=state, now_s=13.0)
        assert none == ()
        assert kept.flights["S-1"].route == state.flights["S-1"].route
        assert kept.decisions["S-1"].text == (
            f"flies on with rows {min(rows)} to {max(rows)}: probability of sun 1.0"
        )

    def test_other_rows_that_are_refused_on_the_way_are_asked_for_once(self) -> None:
        here, unseen = Surveyor("S-1", (0.0, 0.0)), np.full((GRID.rows, GRID.cols), np.nan)
        blind = replace(lit_west(10.0), horizon_s=unseen.astype(np.float32), velocity_mps=None)
        state, _given = decided(blind, here, now_s=10.0)
        state, (instead,) = decided(lit_west(13.0), here, state=state, now_s=13.0)
        state = refused(state, "S-1", instead.number, "a zone", seconds_to_ns(13.0))
        for now_s in range(14, 30):
            state, again = decided(lit_west(now_s), here, state=state, now_s=float(now_s))
            assert again == ()
            assert "flies on" in state.decisions["S-1"].text

    def test_decisions_in_any_light_are_in_the_order_of_their_missions(self) -> None:
        """A record's digest of the state depends on it."""
        unseen = np.full((GRID.rows, GRID.cols), np.nan)
        blind = replace(lit_west(10.0), horizon_s=unseen.astype(np.float32), velocity_mps=None)
        here = [Surveyor(f"S-{n}", (40.0 * n, -40.0)) for n in range(8)]
        state, missions = decided(blind, *here, now_s=10.0)
        assert list(state.decisions) == [mission.serial for mission in missions]

    def test_without_a_vehicle_that_can_fly_it_says_so(self) -> None:
        here = Surveyor("S-1", (180.0, -40.0), height_above_takeoff_m=60.0)
        sun = forecast(clear_sky)
        state, _given = decided(sun, here)
        out = replace(here, is_available=False, ended_mission=1)
        state, _none = decided(sun, out, state=state, now_s=50.0)
        assert state.reason == "waiting: no vehicle can fly now"
        back = replace(out, is_available=True)
        state, missions = decided(forecast(clear_sky, 60.0), back, state=state, now_s=60.0)
        assert (len(missions), state.reason) == (1, "under way")

    def test_where_all_is_in_sun_none_waits_for_its_motion(self) -> None:
        here = Surveyor("S-1", (0.0, 60.0)), Surveyor("S-2", (0.0, 180.0))
        clear = still(lambda _east, _north, _lead: True)
        assert len(decided(clear, *here, now_s=1.0)[1]) == 2

    def test_another_vehicle_in_the_way_bars_none(self) -> None:
        sun = forecast(lambda _east, _north, _lead: True)
        here = Surveyor("S-1", (0.0, 60.0))
        state, (first,) = decided(sun, here)
        now_ns = seconds_to_ns(1.0)
        barred = refused(state, "S-1", first.number, "it crosses the pond", now_ns)
        assert decided(sun, here, state=barred, now_s=60.0)[0].phase is SurveyPhase.PAUSED
        asked = refused(state, "S-1", first.number, "near Drone 2", now_ns, in_the_way=True)
        assert [m.serial for m in decided(sun, here, state=asked, now_s=5.0)[1]] == ["S-1"]

    @pytest.mark.flight
    def test_the_same_survey_is_flown_again_to_the_last_waypoint(self) -> None:
        given = []
        for _ in range(2):
            flights = Flights(started(fleet(3)), fleet(3), sky=in_bands)
            flights.run(200.0)
            given.append(flights.given)
        assert given[0] == given[1]


class TestDecisions:
    def test_what_will_be_shaded_is_flown_before_what_stays_in_sun(self) -> None:
        """The north is in sun for two minutes more, the rim in the south for good."""
        sun = forecast(
            lambda _east, north, lead: (north < 60.0) | ((north > 120.0) & (lead < 120.0))
        )
        state, _ = decided(sun, Surveyor("S-1", (0.0, 90.0)))
        across_m = PLAN.lattice.row_across_m(flown_rows(state, "S-1")[0])
        ((_east_m, north_m),) = PLAN.lattice.east_north_m([(0.0, across_m)]).tolist()
        assert north_m > 120.0

    def test_it_stands_by_where_sun_will_come(self) -> None:
        """Sun comes from the east in 80 s."""
        sun = forecast(lambda east, _north, lead: (lead >= 80.0) & (east > 200.0))
        state, (mission,) = decided(sun, Surveyor("S-1", (0.0, 100.0)))
        assert mission.stands_by
        assert len(mission.mission.waypoints) == 1
        assert state.flights["S-1"].route == ()
        assert "stands by: sun is expected" in state.decisions["S-1"].text
        ((east_m, _north_m),) = state.flights["S-1"].corners_m
        assert east_m > 180.0

    def test_one_that_is_there_waits_and_is_asked_again(self) -> None:
        sun = forecast(lambda east, _north, lead: (lead >= 80.0) & (east > 200.0))
        first, (mission,) = decided(sun, Surveyor("S-1", (0.0, 100.0)))
        place_m = first.flights["S-1"].corners_m[0]
        there = Surveyor("S-1", place_m, ended_mission=mission.number)
        state, missions = decided(sun, there, state=first, now_s=5.0)
        assert missions == ()
        assert state.decisions["S-1"].text.startswith("waits: sun is expected on row")
        assert decided(sun, there, state=state, now_s=6.0)[0].decisions == state.decisions
        lit = forecast(lambda east, _north, _lead: east > 200.0, now_s=9.0)
        _, (flown,) = decided(lit, there, state=state, now_s=9.0)
        assert not flown.stands_by

    def test_one_on_the_ground_takes_off_in_time_and_no_sooner(self) -> None:
        sun = forecast(lambda _east, _north, lead: lead >= 200.0)
        on_ground = Surveyor("S-1", (0.0, -40.0), is_flying=False)
        state, missions = decided(sun, on_ground)
        assert missions == ()
        assert "waits on the ground: sun is expected" in state.decisions["S-1"].text
        # The north stays in shade, so that no round is flown.
        later = forecast(lambda _east, north, lead: (lead >= 80.0) & (north < 120.0), now_s=120.0)
        _, (mission,) = decided(later, on_ground, state=state, now_s=120.0)
        assert mission.stands_by

    @pytest.mark.parametrize(("percent", "takes_off"), [(25, False), (35, True)])
    def test_sun_must_be_probable_enough_for_a_takeoff_and_not_for_a_flight(
        self, percent: int, takes_off: bool
    ) -> None:
        sure = forecast(clear_sky)
        little = np.full_like(sure.sun_probability, round(2.55 * percent))
        sun = replace(sure, sun_probability=little)
        on_ground = Surveyor("S-1", (0.0, -40.0), is_flying=False)
        state, missions = decided(sun, on_ground)
        assert bool(missions) == takes_off
        if not takes_off:
            why = "waits on the ground: little sun is expected on its rows"
            assert state.decisions["S-1"].text == why
        assert decided(sun, replace(on_ground, is_flying=True))[1]

    @pytest.mark.parametrize(("lit_from_s", "takes_off"), [(250.0, False), (60.0, True)])
    def test_one_on_the_ground_saves_its_battery_for_sun_that_comes_later(
        self, lit_from_s: float, takes_off: bool
    ) -> None:
        """Until then little sun is expected: enough for rows that one in the air would fly."""
        surely = forecast(lambda _east, north, lead: (lead >= lit_from_s) & (north < 120.0))
        sun = replace(surely, sun_probability=np.maximum(surely.sun_probability, 50))
        on_ground = Surveyor("S-1", (0.0, -40.0), is_flying=False)
        state, missions = decided(sun, on_ground)
        assert bool(missions) == takes_off
        assert takes_off or state.decisions["S-1"].text.startswith("waits on the ground")
        _, (flown,) = decided(sun, replace(on_ground, is_flying=True))
        assert not flown.stands_by

    def test_under_a_closed_sky_nothing_takes_off(self) -> None:
        sun = forecast(lambda _east, _north, _lead: False)
        state, missions = decided(sun, Surveyor("S-1", (0.0, -40.0), is_flying=False))
        assert missions == ()
        assert state.decisions["S-1"].text == "waits: no sun is expected on its rows for 5 min"

    @pytest.mark.parametrize(
        ("keeps_battery", "time_left_s", "shaded_s", "when_done", "purpose"),
        [
            (False, 300.0, 290.0, WhenDone.RETURN_HOME, CHANGES),
            (False, 300.0, 120.0, WhenDone.RETURN_HOME, ""),  # sun comes while it is away
            (False, 3_000.0, 290.0, WhenDone.RETURN_HOME, ""),  # longer than any shade
            (False, 300.0, 290.0, WhenDone.HOVER, ""),
            (True, 300.0, 290.0, WhenDone.RETURN_HOME, WAITS_BELOW),
            (True, 300.0, 120.0, WhenDone.RETURN_HOME, ""),
            (True, 300.0, 180.0, WhenDone.RETURN_HOME, WAITS_BELOW),  # it is back by then
            (True, 3_000.0, 290.0, WhenDone.RETURN_HOME, WAITS_BELOW),
            (True, 3_000.0, 290.0, WhenDone.HOVER, ""),
            (None, None, 290.0, WhenDone.RETURN_HOME, ""),
        ],
    )
    def test_one_that_would_wait_lands_where_that_costs_little_sun(
        self,
        keeps_battery: bool | None,
        time_left_s: float | None,
        shaded_s: float,
        when_done: WhenDone,
        purpose: str,
    ) -> None:
        sun = forecast(lambda _east, _north, lead: lead >= shaded_s)
        made = create(planned(replace(SURVEY, when_done=when_done)))
        assert isinstance(made, SurveyState)
        running = start(made, ["S-1"], 0)
        assert isinstance(running, SurveyState)
        here = Surveyor("S-1", (0.0, 100.0), keeps_battery=keeps_battery, time_left_s=time_left_s)
        state, missions = decided(sun, here, state=running)
        called = returning(state, [here])
        if not purpose:
            assert called == {}
        else:
            assert missions == ()
            assert called == {"S-1": purpose}
            assert returning(state, [replace(here, is_available=False)]) == {}

    @pytest.mark.parametrize(("shaded_s", "called"), [(240.0, {"S-1"}), (290.0, {"S-1", "S-2"})])
    def test_one_stays_for_sun_that_may_come_while_another_changes_its_battery(
        self, shaded_s: float, called: set[str]
    ) -> None:
        sun = forecast(lambda _east, _north, lead: lead >= shaded_s)
        pair = [
            Surveyor(f"S-{n}", (0.0, 80.0 * n), keeps_battery=False, time_left_s=300.0)
            for n in (1, 2)
        ]
        made = create(planned(replace(SURVEY, when_done=WhenDone.RETURN_HOME)))
        assert isinstance(made, SurveyState)
        running = start(made, ["S-1", "S-2"], 0)
        assert isinstance(running, SurveyState)
        state, _ = decided(sun, *pair, state=running)
        assert set(returning(state, pair)) == called

    def test_vehicles_side_by_side_get_rows_side_by_side(self) -> None:
        sun = forecast(lambda _east, _north, _lead: True)
        places = {f"S-{n}": (0.0, 60.0 + 60.0 * n) for n in range(3)}
        state, missions = decided(sun, *(Surveyor(s, at) for s, at in places.items()))
        assert len(missions) == 3
        across = [
            np.mean([PLAN.lattice.row_across_m(row) for row in flown_rows(state, serial)])
            for serial in places
        ]
        own = [PLAN.lattice.along_across_m([at])[0][1] for at in places.values()]
        assert np.argsort(across).tolist() == np.argsort(own).tolist()
        assert {mission.straight_within_m for mission in missions} == {PLAN.settings.near_m}

    @pytest.mark.parametrize("rim_m", [360.0, 330.0])
    def test_none_begins_where_its_neighbour_does(self, rim_m: float) -> None:
        """All is in sun throughout, or nearly all, and all vehicles come from the same side."""
        sun = forecast(lambda east, _north, _lead: east < rim_m)
        fleet = [Surveyor(f"S-{n}", (20.0 * n, -40.0)) for n in range(3)]
        state, missions = decided(sun, *fleet)
        assert len(missions) == 3
        begins_m = [flight.corners_m[0] for flight in state.flights.values()]
        assert all(np.hypot(a[0] - b[0], a[1] - b[1]) > 40.0 for a, b in combinations(begins_m, 2))
        flown = [flown_rows(state, each.serial) for each in fleet]
        assert len({rows[-1] > rows[0] for rows in flown}) == 1

    @pytest.mark.parametrize(("passed", "begins_near"), [(0, False), (6, True)])
    def test_one_begins_near_where_no_other_has_rows_left_to_lead_the_way(
        self, passed: int, begins_near: bool
    ) -> None:
        """S-1 is where its mission ended, and has all of its rows to fly again."""
        here, other = Surveyor("S-1", (0.0, -40.0)), Surveyor("S-2", (20.0, -40.0))
        state, _missions = decided(forecast(clear_sky), here, other)
        first, flight = state.flights["S-1"], state.flights["S-2"]
        state = state.with_flight("S-2", replace(flight, ends_passed=passed))
        done = replace(here, place_m=first.corners_m[-1], ended_mission=1)
        for now_s in (200.0, 210.0):
            sun = forecast(clear_sky, now_s)
            state, _missions = decided(sun, done, other, state=state, now_s=now_s)
        begin_m = state.flights["S-1"].corners_m[0]
        assert (np.hypot(*np.subtract(begin_m, done.place_m)) < 60.0) == begins_near

    def test_of_pieces_that_lie_apart_a_long_one_comes_before_a_short_one_far_off(self) -> None:
        """Also where another vehicle's rows lead from the short one's side to the long one's."""
        here, other = Surveyor("S-1", (0.0, -40.0)), Surveyor("S-2", (20.0, -40.0))
        state, _missions = decided(forecast(clear_sky), here, other)
        rows = flown_rows(state, "S-1")
        short, long = rows[0], rows[-1]
        cells = PLAN.cells
        row = PLAN.lattice.row_of(cells.across_m)
        is_left = (row == long) | ((row == short) & (abs(cells.along_m - 180.0) < 30.0))
        is_left |= np.isin(row, flown_rows(state, "S-2"))
        light = np.where(is_left, CellState.NOT_YET, CellState.IN_SUN).astype(np.uint8)
        state = replace(state, progress=replace(state.progress, state=light))
        at_long_m = state.flights["S-1"].corners_m[-1]
        done = replace(here, place_m=at_long_m, ended_mission=1)
        for now_s in (200.0, 210.0):
            sun = forecast(clear_sky, now_s)
            state, _missions = decided(sun, done, other, state=state, now_s=now_s)
        assert flown_rows(state, "S-1") == [long, short]

    def test_none_flies_off_for_one_cell_before_its_last_rows_have_counted(self) -> None:
        """One cell far off is known to be left; the rows that it has just flown were in shade."""
        here, other = Surveyor("S-1", (0.0, -40.0)), Surveyor("S-2", (20.0, -40.0))
        state, _missions = decided(forecast(clear_sky), here, other)
        own, others = flown_rows(state, "S-1"), flown_rows(state, "S-2")
        row = PLAN.lattice.row_of(PLAN.cells.across_m)
        light = np.where(np.isin(row, own), CellState.IN_SHADE, CellState.IN_SUN).astype(np.uint8)
        far = next(iter(np.argwhere(PLAN.cells.is_reached & (row == others[-1]))))
        light[tuple(far)] = CellState.NOT_YET
        state = replace(state, progress=replace(state.progress, state=light))
        done = replace(here, place_m=state.flights["S-1"].corners_m[-1], ended_mission=1)
        state = state.without_flight("S-2")
        for now_s in (200.0, 202.0, 204.0):
            state, missions = decided(forecast(clear_sky, now_s), done, state=state, now_s=now_s)
            assert missions == ()
        assert state.decisions["S-1"].text == "waits: its last rows are not counted yet"
        state, missions = decided(forecast(clear_sky, 207.0), done, state=state, now_s=207.0)
        assert len(missions) == 1
        assert set(own) <= set(flown_rows(state, "S-1"))

    @pytest.mark.parametrize(("lit_from_s", "is_round"), [(100.0, True), (600.0, False)])
    def test_a_round_is_flown_that_passes_most_ground_in_sun(
        self, lit_from_s: float, is_round: bool
    ) -> None:
        """The north lies in shade at first: for good, or until two vehicles from the south come."""
        sun = forecast(lambda _east, north, lead: (north < 100.0) | (lead >= lit_from_s))
        places = Surveyor("S-1", (0.0, -40.0)), Surveyor("S-2", (0.0, -60.0))
        state, missions = decided(sun, *places)
        rows = {row for each in places for row in flown_rows(state, each.serial)}
        assert (rows == {piece.row for piece in PLAN.pieces}) == is_round
        assert len(missions) == 2
        texts = {each.text for each in state.decisions.values()}
        assert not is_round or all("probability of sun" in text for text in texts)

    @pytest.mark.parametrize(("height_m", "steps_aside"), [(61.0, True), (68.0, False)])
    def test_one_that_waits_leaves_the_height_of_the_rows(
        self, height_m: float, steps_aside: bool
    ) -> None:
        sun = forecast(lambda _east, _north, _lead: False)
        waiting = Surveyor("S-1", (40.0, 100.0), height_above_takeoff_m=height_m)
        on_ground = Surveyor("S-2", (0.0, -40.0), is_flying=False, height_above_takeoff_m=0.0)
        state, missions = decided(sun, waiting, on_ground)
        assert [(each.serial, each.stands_by) for each in missions] == [("S-1", True)] * steps_aside
        if steps_aside:
            assert state.flights["S-1"].corners_m == (waiting.place_m,)
        assert state.decisions["S-1"].text.startswith("waits: no sun is expected")

    def test_without_a_place_aside_it_waits_where_it_is_for_a_while(self) -> None:
        sun = forecast(lambda _east, _north, _lead: False)
        here = Surveyor("S-1", (40.0, 100.0), height_above_takeoff_m=60.0)
        other = Surveyor("S-2", (0.0, -40.0), is_flying=False)
        state, (aside,) = decided(sun, here, other)
        state = refused(state, "S-1", aside.number, "no room", seconds_to_ns(1.0), may_end=True)
        asked = []
        for now_s in range(2, 30):
            later = replace(sun, issued_at_ns=seconds_to_ns(now_s))
            state, missions = decided(later, here, other, state=state, now_s=float(now_s))
            asked += [now_s] * len(missions)
            assert "S-1" not in state.decisions or "waits" in state.decisions["S-1"].text
        assert asked == [19]

    def test_a_place_aside_that_is_refused_leaves_no_share_behind(self) -> None:
        """Light is lost then: rows are flown in any light, and no empty share waits for ever."""
        here = Surveyor("S-1", (40.0, 100.0), height_above_takeoff_m=60.0)
        other = Surveyor("S-2", (0.0, -40.0), is_flying=False)
        state, (aside,) = decided(forecast(lambda _east, _north, _lead: False), here, other)
        state = refused(
            state, "S-1", aside.number, "no room", 0, may_end=aside.stands_by, in_the_way=True
        )
        assert state.waiting == {}
        state, missions = step(state, (here, other), seconds_to_ns(9.0))
        assert len(missions) == 2

    def test_alone_it_waits_where_it_is(self) -> None:
        sun = forecast(lambda _east, _north, _lead: False)
        alone = Surveyor("S-1", (40.0, 100.0), height_above_takeoff_m=60.0)
        assert decided(sun, alone)[1] == ()

    def test_a_refused_vehicle_is_decided_on_again_soon(self) -> None:
        sun = forecast(lambda _east, _north, _lead: True)
        here = Surveyor("S-1", (0.0, 60.0)), Surveyor("S-2", (0.0, 180.0))
        state, (first, _) = decided(sun, *here)
        state = refused(state, "S-1", first.number, "in the way", seconds_to_ns(1.0))
        assert decided(sun, *here, state=state, now_s=2.0)[1] == ()
        assert [m.serial for m in decided(sun, *here, state=state, now_s=4.5)[1]] == ["S-1"]


class TestSegments:
    def test_they_fill_each_piece_without_gap(self) -> None:
        segments = segments_of(PLAN)
        longest_m = PLAN.settings.segment_m + PLAN.lattice.mark_m
        for index, piece in enumerate(PLAN.pieces):
            parts = [each for each in segments.parts if each.piece == index]
            assert parts[0].start_m == piece.start_m
            assert parts[-1].end_m == piece.end_m
            assert parts[0].before == NONE
            assert parts[-1].after == NONE
            for a, b in pairwise(parts):
                assert a.end_m == b.start_m
                assert segments.parts[a.after] == b
                assert segments.parts[b.before] == a
            assert all(each.length_m <= longest_m for each in parts)

    def test_each_reached_cell_is_in_one(self) -> None:
        segments = segments_of(PLAN)
        assert ((segments.of_cell != NONE) == PLAN.cells.is_reached).all()


def state_with(shade: ShadeMap | None) -> SurveyState:
    made = create(PLAN)
    assert isinstance(made, SurveyState)
    return made if shade is None else observe_shade(made, shade)


def half_lit(at_s: float) -> ShadeMap:
    """The west in sun, the east in shade."""
    lit = np.zeros((GRID.rows, GRID.cols), np.float32)
    lit[:, : GRID.cols // 2] = 1.0
    known, ones = np.ones(lit.shape, np.bool_), np.ones(lit.shape, np.float32)
    return ShadeMap(GRID, seconds_to_ns(at_s), (), lit, known, ones, ones)


def expected_of(
    state: SurveyState, sun: SunForecast | None, now_s: float, plan: SurveyPlan = PLAN
) -> object:
    return expected_sun(segments_of(plan), plan, state.progress, sun, seconds_to_ns(now_s))


class TestExpectedSun:
    def test_a_forecast_is_read_at_its_leads_and_between(self) -> None:
        sun = forecast(lambda _east, _north, lead: lead >= 60.0)
        found = expected_sun(segments_of(PLAN), PLAN, state_with(None).progress, sun, 0)
        assert found is not None
        at = dict(zip(found.moments_s.tolist(), found.probability[0].tolist(), strict=True))
        assert at[40.0] == 0.0
        assert at[50.0] == pytest.approx(1.0 / 3.0)
        assert at[60.0] == at[300.0] == 1.0
        reached_m2 = PLAN.cells.is_reached.sum() * PLAN.cells.cell_m2
        assert found.missing_m2.sum() == pytest.approx(reached_m2)

    def test_an_old_forecast_gives_way_to_what_is_seen(self) -> None:
        state, old = state_with(half_lit(58.0)), forecast(lambda _e, _n, _lead: False)
        found = expected_sun(segments_of(PLAN), PLAN, state.progress, old, seconds_to_ns(60.0))
        assert found is not None
        now, late = found.probability[:, 0], found.probability[:, -1]
        assert now.max() > 0.95
        assert now.min() < 0.05
        assert 0.5 < late.max() < 0.6
        assert 0.4 < late.min() < 0.5

    def test_without_recent_light_nothing_is_expected(self) -> None:
        assert expected_of(state_with(None), None, 0.0) is None
        assert expected_of(state_with(half_lit(0.0)), None, 130.0) is None


@given(
    st.lists(st.floats(0.0, 500.0), min_size=1, max_size=8),
    st.floats(0.001, 5_000.0),
)
def test_vehicles_finish_together(busy_s: list[float], work_s: float) -> None:
    together_s = finished_together_s(np.array(busy_s), work_s)
    assert sum(max(0.0, together_s - each) for each in busy_s) == pytest.approx(work_s)
