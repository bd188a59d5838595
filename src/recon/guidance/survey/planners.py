"""The survey planners, chosen by name.

A planner is pure: the running survey, its vehicles and the time in; the survey and the missions to
give out. It is asked about once a second.
"""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from recon.guidance.survey.rounds import Step, fly_rounds
from recon.guidance.survey.state import Surveyor, SurveyState
from recon.model.survey import PLANNER_GOALS

Planner = Callable[[SurveyState, Sequence[Surveyor], int], Step]


def lawnmower_once(state: SurveyState, positions: Sequence[Surveyor], now_ns: int) -> Step:
    """Fly all rows once, in whatever light; again only what was not imaged, as by a dropout."""
    return fly_rounds(state, positions, now_ns, PLANNER_GOALS["lawnmower_once"])


def lawnmower_again(state: SurveyState, positions: Sequence[Surveyor], now_ns: int) -> Step:
    """Fly all rows, and again what was imaged in shade, until all is imaged in sun.

    It does not wait for sun: the survey's budget ends it under a closed sky.
    """
    return fly_rounds(state, positions, now_ns, PLANNER_GOALS["lawnmower_again"])


PLANNERS: Mapping[str, Planner] = MappingProxyType(
    {"lawnmower_once": lawnmower_once, "lawnmower_again": lawnmower_again}
)
