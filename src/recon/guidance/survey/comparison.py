"""Planners to compare others with: what comes to mind first when shade is to be avoided.

Both go by the light of the moment and use no forecast. `lawnmower_waits` begins a round of the
lawnmower once most of what is missing lies in sun. `nearest_sunlit` sends each vehicle to the
nearest row of which most lies in sun, one row at a time.
"""

from collections.abc import Sequence
from dataclasses import replace

from recon.guidance.survey.rounds import Step, fly_rounds
from recon.guidance.survey.route import route_of
from recon.guidance.survey.segments import NewestForecast, expected_sun, segments_of
from recon.guidance.survey.state import (
    Surveyor,
    SurveyState,
    end_between_rounds,
    spent_budget,
)
from recon.guidance.survey.sunlit_first import PlanningMoment, vehicle_by_vehicle
from recon.guidance.survey.vehicle_choice import WANTED, missing_pieces
from recon.model.survey import MissionAssignment

IN_SUN = 0.5
"""Share of a segment's missing ground that must be in sun for `nearest_sunlit` to fly it."""


def lawnmower_waits(
    state: SurveyState, vehicles: Sequence[Surveyor], sun: NewestForecast, now_ns: int
) -> Step:
    """Fly rounds over what is missing, each once most of that is in sun, until all is."""
    is_between = not state.flights and not state.waiting
    is_over = spent_budget(state, WANTED, now_ns) is not None
    is_over = is_over or end_between_rounds(state, WANTED) is not None
    if is_between and not is_over and not _is_mostly_in_sun(state, sun, now_ns):
        return replace(state, reason="waiting: most of what is missing lies in shade"), ()
    return fly_rounds(state, vehicles, now_ns, WANTED)


def nearest_sunlit(
    state: SurveyState, vehicles: Sequence[Surveyor], sun: NewestForecast, now_ns: int
) -> Step:
    """Fly the nearest row in sun, until all is imaged in sun."""
    return vehicle_by_vehicle(state, vehicles, sun, now_ns, _give_nearest)


def _is_mostly_in_sun(state: SurveyState, sun: NewestForecast, now_ns: int) -> bool:
    """Whether a round is worth it by the light of the moment; also where that is unknown."""
    segments = segments_of(state.plan)
    expected = expected_sun(segments, state.plan, state.progress, sun(), now_ns)
    if expected is None:
        return True
    lit_m2 = float(expected.missing_m2 @ expected.probability[:, 0])
    return lit_m2 >= state.plan.settings.round_sun_share * float(expected.missing_m2.sum())


def _give_nearest(state: SurveyState, moment: PlanningMoment) -> Step:
    """Give each idle vehicle the nearest row in sun; without one it waits."""
    missions: tuple[MissionAssignment, ...] = ()
    for serial in moment.idle(state):
        choice = moment.choice(state, serial)
        is_lit = choice.free() & (moment.expected.probability[:, 0] >= IN_SUN)
        pieces = missing_pieces(state, moment.segments, is_lit)
        row = route_of(pieces, state.plan.lattice, choice.start_m)[:1]
        state, new = choice.fly_all(row) if row else choice.wait("waits: no free row is in sun")
        missions += new
    return state, missions
