"""Surveys: a region cut into rows, shared among vehicles, flown in rounds, followed cell by cell.

`plan_survey` makes the rows; `create`, `start`, `pause`, `abort` and `step` are the survey's life;
`observe` and `observe_shade` tell it what was seen. All of it is pure.
"""

from recon.guidance.survey.life import (
    abort,
    create,
    observe,
    observe_shade,
    pause,
    refused,
    spent,
    start,
    step,
)
from recon.guidance.survey.plan import Surroundings, SurveyPlan, plan_survey
from recon.guidance.survey.planners import PLANNERS, Planner, lawnmower_again, lawnmower_once
from recon.guidance.survey.progress import PositionSample, Progress
from recon.guidance.survey.settings import SurveySettings
from recon.guidance.survey.state import Flight, SurveyFigures, Surveyor, SurveyState, figures

__all__ = [
    "PLANNERS",
    "Flight",
    "Planner",
    "PositionSample",
    "Progress",
    "Surroundings",
    "SurveyFigures",
    "SurveyPlan",
    "SurveySettings",
    "SurveyState",
    "Surveyor",
    "abort",
    "create",
    "figures",
    "lawnmower_again",
    "lawnmower_once",
    "observe",
    "observe_shade",
    "pause",
    "plan_survey",
    "refused",
    "spent",
    "start",
    "step",
]
