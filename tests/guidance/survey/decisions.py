"""Single decisions of the planner, from forecasts that are sure."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from tests.guidance.survey.fields import FRAME, planned, rectangle, survey_of

from recon.guidance.survey import (
    ClosedArea,
    Surveyor,
    SurveyState,
    create,
    start,
    step,
)
from recon.model.geo import GroundGrid
from recon.model.shade import SunForecast
from recon.model.survey import MissionAssignment
from recon.model.units import seconds_to_ns

FIELD = rectangle(360.0, 240.0)
SURVEY = survey_of(FIELD, planner="sunlit_first", bearing_deg=90.0)
PLAN = planned(SURVEY)


GRID = GroundGrid(FRAME, -40.0, 280.0, 8.0, 42, 55)
LEADS_S = np.arange(0.0, 330.0, 15.0)


def forecast(sunlit: object, now_s: float = 0.0) -> SunForecast:
    """A forecast that is sure: `sunlit(east_m, north_m, lead_s)`."""
    east_m = GRID.west_m + GRID.cell_m * (np.arange(GRID.cols) + 0.5)
    north_m = GRID.north_m - GRID.cell_m * (np.arange(GRID.rows) + 0.5)
    east, north = np.meshgrid(east_m, north_m)
    by_lead = np.stack([np.broadcast_to(sunlit(east, north, lead), east.shape) for lead in LEADS_S])  # type: ignore[operator]
    return SunForecast(
        grid=GRID,
        issued_at_ns=seconds_to_ns(now_s),
        lead_s=LEADS_S,
        sun_probability=np.where(by_lead, 255, 0).astype(np.uint8),
        horizon_s=np.full(east.shape, 300.0, np.float32),
        prior_sunlit=0.5,
        method="made",
        velocity_mps=(1.0, 0.0),
    )


def still(sunlit: object, now_s: float = 0.0) -> SunForecast:
    """The same, where the shadows' motion is not known."""
    return replace(forecast(sunlit, now_s), velocity_mps=None)


def decided(
    sun: SunForecast,
    *surveyors: Surveyor,
    state: SurveyState | None = None,
    now_s: float = 0.0,
    closed: Sequence[ClosedArea] = (),
) -> tuple[SurveyState, tuple[MissionAssignment, ...]]:
    if state is None:
        made = create(PLAN)
        assert isinstance(made, SurveyState)
        running = start(made, [each.serial for each in surveyors], 0)
        assert isinstance(running, SurveyState)
        state = running
    return step(state, surveyors, seconds_to_ns(now_s), lambda: sun, closed)


def flown_rows(state: SurveyState, serial: str) -> list[int]:
    return [leg.piece.row for leg in state.flights[serial].route]
