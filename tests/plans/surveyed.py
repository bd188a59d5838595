"""Fields of three shapes in three parts of the world, and the flights over them."""

from functools import cache

import numpy as np

from recon.guidance.survey import Surveyor, SurveyPlan, plan_survey
from recon.guidance.survey.estimate import Batteries, corner_of, estimate
from recon.model.airspace import Region
from recon.model.command import Refusal
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.survey import Survey
from recon.plans.flight_plan import ExportedPlan
from recon.plans.from_survey import flight_plans

FIELDS = {
    "rectangle": (GeoPoint(41.9, -93.6, 275.0), ((0, 0), (90, 0), (90, 60), (0, 60))),
    "triangle": (GeoPoint(-38.2, 176.3, 60.0), ((0, 0), (110, 20), (30, 95))),
    "bay": (
        GeoPoint(60.7, 11.2, 210.0),
        ((0, 0), (120, 0), (120, 70), (75, 70), (75, 30), (45, 30), (45, 70), (0, 70)),
    ),
}
HEIGHT_M, SPEED_MPS = 35.0, 5.0


@cache
def survey_plan(field: str) -> SurveyPlan:
    """Return the rows over a field."""
    origin, corners = FIELDS[field]
    region = Region(np.array(corners, dtype=float))
    survey = Survey(1, f"the {field}", region, HEIGHT_M, SPEED_MPS)
    plan = plan_survey(survey, LocalFrame(origin))
    assert not isinstance(plan, Refusal), plan
    return plan


@cache
def flights(field: str, drones: int = 1, level_s: float | None = None) -> tuple[ExportedPlan, ...]:
    """Return the flights of drones that take off at a field's corner, with batteries that last."""
    plan = survey_plan(field)
    home_m = corner_of(plan)
    fleet = [
        Surveyor(f"drone {n}", home_m, home_m=home_m, takeoff_up_m=0.0)
        for n in range(1, drones + 1)
    ]
    needs = estimate(plan, fleet, Batteries(level_s))
    assert not isinstance(needs, Refusal), needs
    return tuple(flight_plans(plan, needs, fleet, {}))
