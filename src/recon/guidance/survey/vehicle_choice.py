"""What one vehicle without a mission does next, for the planner `sunlit_first`.

Over its share of the missing ground the best flight is searched. If that begins at once, its first
rows are flown; if later, the vehicle goes there and stands by, or waits where it is; under a
closed sky it waits on the ground, and a low battery is changed when that costs least. Each decision
leaves a sentence (`Decision`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from math import dist, exp

import numpy as np

from recon.guidance.survey.closed_areas import closed_ground, is_open
from recon.guidance.survey.lattice import AlongAcross, EastNorth
from recon.guidance.survey.own_share import own_share
from recon.guidance.survey.passing import Passing, passing
from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.rounds import Step, assign, longest_mission
from recon.guidance.survey.route import Route, RowLeg, direction_of, route_of
from recon.guidance.survey.rows import Piece
from recon.guidance.survey.search import Flight, Pace, PlannedLeg, Search
from recon.guidance.survey.segments import (
    NONE,
    ExpectedSun,
    Segments,
)
from recon.guidance.survey.settings import SurveySettings
from recon.guidance.survey.state import (
    AssignedMission,
    Decision,
    Surveyor,
    SurveyState,
)
from recon.model.arrays import BoolArray
from recon.model.survey import CellState, WhenDone
from recon.model.units import seconds_to_ns

WANTED = CellState.IN_SUN


def just_flown_legs(state: SurveyState) -> list[RowLeg]:
    """Return the rows of missions that have just ended."""
    return [leg for each in state.just_flown.values() for leg in each.route]


def missing_pieces(state: SurveyState, segments: Segments, chosen: BoolArray) -> Sequence[Piece]:
    """The missing ground of the chosen segments (S,), in pieces of rows."""
    of_cell = segments.of_cell
    is_missing = state.missing(WANTED) & (of_cell != NONE) & chosen[of_cell]
    return state.plan.pieces_over(is_missing)


@dataclass(frozen=True, slots=True, eq=False)
class VehicleChoice:
    """What one vehicle without a mission does now."""

    state: SurveyState
    segments: Segments
    expected: ExpectedSun
    able: tuple[Surveyor, ...]
    surveyor: Surveyor
    now_ns: int

    @property
    def plan(self) -> SurveyPlan:
        """The survey's plan."""
        return self.state.plan

    @property
    def settings(self) -> SurveySettings:
        """Its thresholds."""
        return self.state.plan.settings

    def decide(self) -> Step:
        """Return the survey with the decision, and the vehicle's mission if it gets one."""
        free = self.free()
        if not free.any():
            return self.wait(self._why_none_is_free())
        share = self.share(free)
        if self.expected.is_clear(share, self.settings.clear_sky_probability):
            return self.fly_all(self.clear_rows(share))
        flight = self.best(share)
        if (flight.waits_s > 0.0 or not flight.legs) and self._is_time_to_land(free):
            return self._return_home()
        if not flight.legs:
            minutes = self.settings.planned_s / 60.0
            return self.wait(f"waits: no sun is expected on its rows for {minutes:.0f} min")
        if not (self.surveyor.is_flying or self._is_worth_taking_off(flight)):
            return self.wait("waits on the ground: little sun is expected on its rows")
        if flight.waits_s > 0.0:
            return self._stand_by(flight)
        return self.fly_all(self.long_enough(self.committed(flight)))

    def _is_worth_taking_off(self, flight: Flight) -> bool:
        """Whether what it flies first has sun: one that flies in shade until then has less of its
        battery when sun comes, or has landed."""
        most = max(leg.probability for leg in self.committed(flight))
        return most >= self.settings.takeoff_probability

    def begun_at_once(self, share: BoolArray) -> tuple[PlannedLeg, ...]:
        """Return the first legs of the best flight over a share; none if that would wait."""
        best = self.best(share)
        return self.committed(best) if best.legs and best.waits_s <= 0.0 else ()

    def free(self) -> BoolArray:
        """Return (S,): segments with missing ground that no vehicle flies, or has just flown."""
        flown = [leg for flight in self.state.flights.values() for leg in flight.rows_taken]
        flown += just_flown_legs(self.state)
        free: BoolArray = (self.expected.missing_m2 > 0.0) & ~self.segments.under(flown)
        return free

    def _why_none_is_free(self) -> str:
        if not self.state.closed:
            return "waits: others are on what is left"
        names = ", ".join(each.name for each in self.state.closed)
        return f"waits: {names}, without telemetry, may be where rows are left"

    def share(self, free: BoolArray) -> BoolArray:
        """Return (S,): its own share of the free segments; all of them where that has no sun."""
        state = self.state
        share = own_share(
            self.surveyor, self.able, state.flights, free, self.expected, self.plan, self.now_ns
        )
        missing_m2 = np.where(share, self.expected.missing_m2, 0.0)
        lit_m2 = float(missing_m2 @ self.expected.probability.max(axis=1))
        is_worth = lit_m2 > self.settings.share_worth * missing_m2.sum()
        return share if is_worth else free

    def _is_time_to_land(self, free: BoolArray) -> bool:
        """Whether it can fly home, and that costs less sun now than it gains."""
        surveyor = self.surveyor
        if self.plan.survey.when_done is not WhenDone.RETURN_HOME or not surveyor.is_flying:
            return False
        if surveyor.keeps_battery is None:
            return False
        cost, gain = self.landing_cost_and_gain(free)
        return cost < gain

    @property
    def _away_s(self) -> float:
        settings, keeps = self.settings, self.surveyor.keeps_battery
        return settings.ground_wait_away_s if keeps else settings.battery_change_away_s

    def landing_cost_and_gain(self, free: BoolArray) -> tuple[float, float]:
        """Return what landing now costs and gains, as shares of its time in sun.

        It costs the sun expected on free ground until the vehicle is back. A low battery is
        changed: that costs the more the fewer others stay, and gains what a change would cost
        later, if it is needed at all. A good one stays in, and its change is needed later.
        """
        settings, missing_m2 = self.settings, self.expected.missing_m2[free]
        sun = missing_m2 @ self.expected.probability[free] / missing_m2.sum()
        is_away = self.expected.moments_s <= self._away_s
        cost = float(sun[is_away].mean())
        probability = self._swap_probability(float(missing_m2.sum()))
        if self.surveyor.keeps_battery:
            return cost, settings.saved_battery_gain * probability
        return cost * self._scarcity, settings.swap_later * probability

    def _swap_probability(self, missing_m2: float) -> float:
        """Return how probably its battery does not last: for its part of the missing ground, or for
        shade that lasts longer than what it has beyond that."""
        assert self.surveyor.time_left_s is not None, "known where the charge is"
        settings, lattice = self.settings, self.plan.lattice
        rows_m = missing_m2 / lattice.spacing_m / len(self.able)
        flown_s = rows_m / (self.plan.survey.speed_mps * settings.expected_rate)
        spare_s = self.surveyor.time_left_s * settings.flight_time_share - flown_s
        return exp(-max(spare_s, 0.0) / settings.shade_lasts_s)

    @property
    def _scarcity(self) -> float:
        """The survey's other vehicles divided by those that stay; if none stays, by one half."""
        others = set(self.state.serials) - {self.surveyor.serial}
        returning = {serial for serial, each in self.state.decisions.items() if each.returns}
        staying = others & {each.serial for each in self.able} - returning
        return len(others) / max(len(staying), 0.5) if others else 1.0

    def _return_home(self) -> Step:
        purpose = "wait on the ground" if self.surveyor.keeps_battery else "change its battery"
        minutes = self._away_s / 60.0
        text = f"returns to {purpose}: little sun is expected for {minutes:g} min"
        state = self._with_decision(text, self.now_ns + seconds_to_ns(self.settings.retry_s), True)
        return state, ()

    def rows(self, share: BoolArray) -> Route:
        """Return the missing ground of a share row by row, to and fro, from the end that is near.

        All vehicles work across the field in the same direction, so that none begins where its
        neighbour does.
        """
        pieces = missing_pieces(self.state, self.segments, share)
        others = {direction_of(flight.rows_left) for flight in self.state.flights.values()} - {0}
        direction = others.pop() if len(others) == 1 else 0
        return route_of(pieces, self.plan.lattice, self.start_m, direction)

    def clear_rows(self, share: BoolArray) -> Route:
        """Return the missing ground of a share in sun: row by row, which keeps vehicles apart, or
        the best flight over it where that images more soon, as of pieces here and there."""
        rows, flown = self.rows(share), self.long_enough(self.best(share).legs)
        is_better = self._worth_m2(flown) > self.settings.best_flight_worth * self._worth_m2(rows)
        return flown if is_better else rows

    def _worth_m2(self, route: Route) -> float:
        return self.passing(route).lit_m2(self.expected, patience_s=self.settings.patience_s)

    def fly_all(self, route: Route) -> Step:
        """Fly these rows one after the other; put off what images little until it is known what its
        last rows have left, a few seconds."""
        flown = self.state.just_flown.get(self.surveyor.serial)
        if flown is not None and self.now_ns < flown.until_ns and self._images_little(route):
            again_ns = self.now_ns + seconds_to_ns(self.settings.decided_again_s)
            return self._with_decision("waits: its last rows are not counted yet", again_ns), ()
        return self.fly(self._allowed(route))

    def _images_little(self, route: Route) -> bool:
        """Whether nearly all the time of these rows would be for the path there."""
        passed = self.passing(route)
        rate_m2ps = self.plan.survey.speed_mps * self.plan.lattice.spacing_m
        return (
            passed.lit_m2(self.expected) < self.settings.put_off_share * rate_m2ps * passed.ends_s
        )

    def best(self, share: BoolArray) -> Flight:
        """Return the best flight over the segments (S,) of a share."""
        search = Search(
            self.segments, self.expected, share, self.plan.lattice, self._pace, self.settings
        )
        return search.best(self.start_m, self._starts_s)

    def passing(self, route: Route, starts_s: float | None = None) -> Passing:
        """Return when it passes the rows of a route; without a start, that of a new mission."""
        starts_s = self._starts_s if starts_s is None else starts_s
        start_m = self.start_m
        segments, lattice = self.segments, self.plan.lattice
        return passing(route, segments, self.expected, lattice, self._pace, start_m, starts_s)

    @property
    def _pace(self) -> Pace:
        speed_mps, settings = self.plan.survey.speed_mps, self.settings
        stop_s = speed_mps / settings.turning_mps2 + settings.corner_s
        stop_s += self.surveyor.extra_corner_s
        # Stops within rows make them slower, on average.
        rows_mps = speed_mps / (1.0 + speed_mps * self.plan.stops_per_m * stop_s)
        return Pace(rows_mps, stop_s, settings.layer_s)

    @property
    def _starts_s(self) -> float:
        if self.surveyor.is_flying:
            return self.settings.start_s
        surveyor = self.surveyor
        wanted_m = self.plan.height_above_takeoff_m(surveyor.place_m, surveyor.takeoff_up_m)
        assert wanted_m is not None, "a vehicle without a takeoff height is not asked"
        climb_s = max(wanted_m, 0.0) / self.settings.climb_mps
        return self.settings.start_s + self.settings.takeoff_s + climb_s

    @property
    def start_m(self) -> AlongAcross:
        """Where it is."""
        return self.plan.lattice.along_across_of(self.surveyor.place_m)

    def committed(self, flight: Flight) -> tuple[PlannedLeg, ...]:
        """Return the legs of a flight flown before it is decided anew; the first one always."""
        first, *others = flight.legs
        until_s = self.settings.committed_s
        return first, *takewhile(lambda leg: leg.until_s <= until_s, others)

    def fly(self, route: Route, why: str = "") -> Step:
        """Fly these rows, as far as the battery lasts and no lost vehicle may be; else wait.

        The decision's sentence begins with `why`, and states the sun expected on what is flown.
        """
        state = self.state
        may_fly = partial(is_open, closed_ground(state.closed)) if state.closed else None
        track, count = longest_mission(self.plan, route, self.surveyor, may_fly)
        if track is None:
            text = "waits: its battery lasts for no row, the path there and the return"
            return self.wait(text, self.settings.retry_s)
        passed = self.passing(route[:count])
        sun = passed.lit_m2(self.expected) / max(passed.missing_m2, 1.0)
        text = f"{why}flies {named(route[:count], self.plan)}: probability of sun {sun:.1f}"
        speed_mps, stops_s = self.plan.survey.speed_mps, self._pace.stop_s * len(track.corners_m)
        climbing_s = track.climbing_s(speed_mps, self.settings.climb_mps)
        ends_s = self._starts_s + track.length_m / speed_mps + stops_s + climbing_s
        mission = AssignedMission(
            state.missions + 1,
            route[:count],
            track.corners_m,
            track.length_m,
            self.now_ns + seconds_to_ns(ends_s),
            track.up_m,
            is_chosen=True,
            is_beside_closed=bool(state.closed),
        )
        state, given = assign(self._with_decision(text), self.surveyor, mission, ())
        return state, (replace(given, straight_within_m=self.settings.near_m),)

    def _allowed(self, route: Route) -> Route:
        """The first of these rows after a mission that would meet another vehicle on its way."""
        refused = self.state.refusals.get(self.surveyor.serial)
        if refused is None or refused.rows_most is None:
            return route
        is_new = self.now_ns < refused.again_ns + seconds_to_ns(self.settings.retry_soon_s)
        return route[: refused.rows_most] if is_new else route

    def long_enough(self, legs: Sequence[PlannedLeg]) -> Route:
        """Return the rows to be flown for these legs: each long enough for a photo."""
        return tuple(self._long_enough(leg) for leg in legs)

    def _long_enough(self, leg: PlannedLeg) -> RowLeg:
        piece = self.segments.parts[leg.segments[0]].piece
        return replace(leg.route, piece=self.plan.long_enough(piece, leg.route.piece))

    def _stand_by(self, flight: Flight) -> Step:
        plan, surveyor = self.plan, self.surveyor
        first = flight.legs[0]
        entry, _ = first.route.ends_m(plan.lattice, plan.swath.lead_m)
        ((east_m, north_m),) = plan.lattice.east_north_m([entry]).tolist()
        far_m = dist((east_m, north_m), surveyor.place_m)
        row = first.route.piece.row + 1
        sun = f"row {row} in {first.from_s:.0f} s, probability {first.probability:.1f}"
        if surveyor.is_flying and far_m <= self.settings.standby_m:
            return self.wait(f"waits: sun is expected on {sun}")
        if not surveyor.is_flying and flight.waits_s > self._starts_s + self.settings.standby_s:
            return self.wait(f"waits on the ground: sun is expected on {sun}")
        there_ns = self.now_ns + seconds_to_ns(first.from_s)
        text = f"goes to row {row} and stands by: sun is expected on {sun}"
        return self._go_and_wait((east_m, north_m), there_ns, text)

    def wait(self, text: str, again_s: float | None = None) -> Step:
        """Wait where it is; out of the others' rows if there is a place."""
        if self._is_among_rows:
            return self._step_aside(text)
        again_s = self.settings.decided_again_s if again_s is None else again_s
        return self._with_decision(text, self.now_ns + seconds_to_ns(again_s)), ()

    @property
    def _is_among_rows(self) -> bool:
        """Whether it hovers where other vehicles fly rows, and may have a place aside."""
        refused = self.state.refusals.get(self.surveyor.serial)
        wait_ns = seconds_to_ns(self.settings.retry_s)
        if refused is not None and self.now_ns < refused.again_ns + wait_ns:
            return False
        surveyor, height_m = self.surveyor, self.surveyor.height_above_takeoff_m
        if height_m is None or not surveyor.is_flying or len(self.able) == 1:
            return False
        return self.plan.is_at_rows_height(surveyor.place_m, height_m, surveyor.takeoff_up_m)

    def _step_aside(self, text: str) -> Step:
        aside_ns = self.now_ns + seconds_to_ns(self._starts_s + self.settings.layer_s / 2.0)
        return self._go_and_wait(self.surveyor.place_m, aside_ns, text)

    def _go_and_wait(self, place_m: EastNorth, there_ns: int, text: str) -> Step:
        """Stand by in its layer over a place, without rows."""
        terrain = self.plan.terrain
        up_m = () if terrain is None else (terrain.up_at_m(place_m),)
        number = self.state.missions + 1
        mission = AssignedMission(number, (), (place_m,), 0.0, there_ns, up_m, is_chosen=True)
        state, given = assign(self._with_decision(text), self.surveyor, mission, ())
        return state, (replace(given, stands_by=True),)

    def _with_decision(self, text: str, again_ns: int = 0, returns: bool = False) -> SurveyState:
        decision = Decision(text, again_ns, returns)
        return self.state.with_decision(self.surveyor.serial, decision)


PART_OF_ROW = 0.95
"""Below this share of its length a row is flown in part; two vehicles may fly parts of one row."""


def named(route: Sequence[RowLeg], plan: SurveyPlan) -> str:
    """Name the rows of a route, and whether it is a part of one."""
    rows = sorted({leg.piece.row for leg in route})
    if len(rows) > 1:
        return f"rows {rows[0] + 1} to {rows[-1] + 1}"
    flown_m = sum(leg.piece.length_m for leg in route)
    whole_m = sum(piece.length_m for piece in plan.pieces if piece.row == rows[0])
    return f"{'part of ' * (flown_m < PART_OF_ROW * whole_m)}row {rows[0] + 1}"
