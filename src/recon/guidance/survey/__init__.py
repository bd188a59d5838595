"""Surveys: a region cut into rows, shared among vehicles, flown in rounds, recorded cell by cell.

`plan_survey` makes the rows. `create`, `start`, `pause`, `abort` and `step` are the life cycle.
`observe` and `observe_shade` add positions, photos and shade maps. Everything is pure.
"""

from recon.guidance.survey.closed_areas import ClosedArea
from recon.guidance.survey.life import (
    NO_BATTERY,
    PAUSED_BY_COMMAND,
    abort,
    create,
    observe,
    observe_shade,
    pause,
    refused,
    returning,
    start,
    step,
)
from recon.guidance.survey.plan import SurveyPlan, SurveySurroundings, plan_survey, surroundings_of
from recon.guidance.survey.planners import PLANNERS, Planner
from recon.guidance.survey.progress import CoverageProgress, PhotoSample, PositionSample
from recon.guidance.survey.settings import SurveySettings
from recon.guidance.survey.state import (
    AssignedMission,
    CoverageFigures,
    Surveyor,
    SurveyState,
    figures,
)
