"""What a scenario's methods make of a run: the frames sent, the station's settings and jobs.

With ideal detection, frames of a few pixels are sent over the link, with latency and faults.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np

from recon.guidance.survey.settings import DEFAULT as SURVEYS
from recon.model.imagery import RgbImage
from recon.score.ideal_detection import IdealDetection
from recon.score.scenario import IDEAL, NO_FORECAST, PERFECT, Scenario
from recon.score.scenario_conditions import conditions_of
from recon.score.simulation import simulation_of
from recon.score.true_frames import Frames
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.fleet import SimulationConfig
from recon.sim.world import Sky
from recon.station.imaging.frames import PROJECT_FRAME
from recon.station.imaging.shade import READ_SHADE, read_shade
from recon.station.kernel.worker import JobRunner
from recon.station.state.settings import StationSettings

PLACEHOLDER_PX = 8


@dataclass(frozen=True, slots=True)
class Placeholders:
    """Frames whose pixels are not read."""

    def prepare(self) -> None:
        """Do nothing: there is nothing to render."""

    def render(self, view: CameraView) -> RgbImage:
        """Return a grey frame; its level depends on the number, as repeated frames are rejected."""
        level = 1 + view.number % 250
        return np.full((PLACEHOLDER_PX, PLACEHOLDER_PX, 3), level, dtype=np.uint8)


def renderers_of(config: SimulationConfig) -> dict[str, FieldRenderer]:
    """Return the renderers of the frames, which know their true poses, by serial."""
    renderers = {}
    for serial, imager in config.imagers.items():
        assert isinstance(imager.source, FieldRenderer)
        renderers[serial] = imager.source
    return renderers


def config_of(scenario: Scenario, seed: int) -> SimulationConfig:
    """Return the scenario's simulation, with frames as they are rendered."""
    return simulation_of(scenario, seed, conditions_of(scenario, seed).feed)


def sent_by(config: SimulationConfig, scenario: Scenario) -> SimulationConfig:
    """Return the simulation with rendered frames only where they are read."""
    if scenario.methods.detection != IDEAL:
        return config
    unread = {s: replace(each, source=Placeholders()) for s, each in config.imagers.items()}
    return replace(config, imagers=unread)


def settings_of(scenario: Scenario) -> StationSettings:
    """Return the station's settings with the scenario's methods.

    With the perfect forecast the station's usual method observes the maps: what it remembers of
    shade that has left the view is used beside the forecast.
    """
    settings, methods = StationSettings(), scenario.methods
    detection = replace(settings.detection, cell_m=scenario.imager.cell_m)
    if methods.detection != IDEAL:
        detection = replace(detection, method=methods.detection)
    settings = replace(settings, detection=detection)
    forecast = settings.forecast
    if methods.forecast not in (NO_FORECAST, PERFECT):
        forecast = replace(forecast, method=methods.forecast)
    if not methods.scores_maps:
        forecast = replace(forecast, lead_s=_leads_planned_with_s(forecast.lead_s))
    return replace(settings, forecast=forecast)


def _leads_planned_with_s(leads_s: Sequence[float]) -> tuple[float, ...]:
    """The leads that guidance reads; later ones are for operators, and half of all computing.

    A forecast is read between two leads, until it is too old.
    """
    until_s = SURVEYS.planned_s + SURVEYS.forecast_age_s
    return tuple(lead_s for before_s, lead_s in pairwise((-1.0, *leads_s)) if before_s < until_s)


def jobs_of(scenario: Scenario, sky: Sky, frames: Frames) -> JobRunner:
    """Return the runner of the station's jobs; with ideal detection it reads the truth of `sky`."""
    jobs = JobRunner(scenario.site)
    shows_sun = _shows_sun(scenario)
    jobs.replace(READ_SHADE, partial(read_shade, shows_sun=shows_sun))
    if scenario.methods.detection == IDEAL:
        ideal = IdealDetection(scenario, sky, frames, shows_sun=shows_sun)
        jobs.replace(PROJECT_FRAME, ideal.project)
        jobs.replace(READ_SHADE, ideal.read)
    return jobs


def _shows_sun(scenario: Scenario) -> bool:
    """Whether each forecast is read, besides what surveys decide by and scores compare: the truth
    replaces it, an imaging drone moves upwind by it, or several merge their maps by it."""
    imager = scenario.imager
    return scenario.methods.forecast == PERFECT or imager.is_upwind or len(imager.places_m) > 1
