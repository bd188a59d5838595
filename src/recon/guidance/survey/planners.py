"""The survey planners, by name."""

from collections.abc import Callable, Sequence

from recon.guidance.survey.comparison import lawnmower_waits, nearest_sunlit
from recon.guidance.survey.rounds import Step, lawnmower_again, lawnmower_once
from recon.guidance.survey.segments import NewestForecast
from recon.guidance.survey.state import Surveyor, SurveyState
from recon.guidance.survey.sunlit_first import sunlit_first
from recon.model.methods import MethodRegistry

Planner = Callable[[SurveyState, Sequence[Surveyor], NewestForecast, int], Step]
"""Pure: the survey, its vehicles, the newest forecast and the time in; the survey and the missions
to give out. Asked about once a second."""

PLANNERS: MethodRegistry[Planner] = MethodRegistry(
    "recon.planners",
    {
        "lawnmower_once": lawnmower_once,
        "lawnmower_again": lawnmower_again,
        "sunlit_first": sunlit_first,
        "lawnmower_waits": lawnmower_waits,
        "nearest_sunlit": nearest_sunlit,
    },
    callable,
)
