"""A scenario: site, fleet, sky, wind, faults, survey task and methods."""

from dataclasses import dataclass
from pathlib import Path

from recon.camera.sight import COARSEST_M
from recon.model.geo import LocalFrame
from recon.model.survey import Survey
from recon.sim.app.faults import InjectedFault, RandomFault
from recon.sim.conditions import ConditionRanges, Range
from recon.sim.fleet import IMAGER_SERIAL
from recon.sim.world import LayerSettings, SunSettings, WindSettings
from recon.site import Site

IDEAL, NO_FORECAST = "ideal", "none"
PERFECT = "perfect"
"""The station's forecast is the true sky to come."""
TRUE_MOTION = "true_motion"
"""The forecast that moves what is seen now by the true motion, without error."""

EastNorth = tuple[float, float]
"""East and north metres of the site."""


@dataclass(frozen=True, slots=True)
class ScenarioFleet:
    """The survey drones, one pad each."""

    pads_m: tuple[EastNorth, ...]
    endurance_s: float
    """Hovering, from full to empty."""
    reserve_share: float
    """Share of the battery that is never planned with."""
    swap_s: float
    """Time on the ground to change the battery."""
    kept_share: float
    """A battery that is this full at landing is not changed."""
    takes_missions: bool = True

    @property
    def serials(self) -> tuple[str, ...]:
        """One for each drone."""
        return tuple(f"SIM-{number + 1}" for number in range(len(self.pads_m)))


@dataclass(frozen=True, slots=True)
class ScenarioImager:
    """The imaging drones, each over a place; each sees a circle of the ground."""

    over_m: EastNorth
    """Place of the first one."""
    height_m: float
    radius_m: float
    """Radius of the scored ground, if the lens shows as much."""
    cell_m: float
    """Cell size of shade maps and their score."""
    field_deg: float | None = None
    """Field of a generated site's lens, from its axis; None: as the demonstration's."""
    tilt_deg: float = 0.0
    """Tilt of a generated site's camera, from straight down to the front."""
    reach_m: float | None = None
    """Reach of a generated site's shade maps; None: as the scored ground."""
    coarsest_m: float = COARSEST_M
    """Ground that a pixel may show, for ideal detection to see it."""
    is_upwind: bool = False
    """Whether the operator moves the first one to where it sees most of the shade to come."""
    also_over_m: tuple[EastNorth, ...] = ()
    """Places of the others."""

    @property
    def places_m(self) -> dict[str, EastNorth]:
        """Where each hovers first, by serial."""
        others = {f"{IMAGER_SERIAL}-{n}": place for n, place in enumerate(self.also_over_m, 2)}
        return {IMAGER_SERIAL: self.over_m, **others}


@dataclass(frozen=True, slots=True)
class Methods:
    """Names of the detection and forecast methods; the planner's is in the survey.

    `detection` is `ideal` (true shade maps) or a name in `DETECTORS`; `forecast` is `none`,
    `perfect` (the true sky to come, with `ideal` detection only) or a name in `FORECASTERS`.
    """

    detection: str = IDEAL
    forecast: str = "advection"
    compared: tuple[str, ...] = ()
    """Forecast methods that are scored besides the station's own, on the same maps."""
    scores_maps: bool = True
    """Whether shade maps and forecasts are scored; without that a run ends with the survey."""

    @property
    def conflict(self) -> str | None:
        """Why detection and forecast cannot be flown together, as a sentence; None if they can."""
        if self.forecast != PERFECT or self.detection == IDEAL:
            return None
        return (
            f"forecast: expected detection {IDEAL} with the forecast {PERFECT}, got detection "
            f"{self.detection}: choose detection {IDEAL}, or another forecast"
        )

    @property
    def is_guidance_alone(self) -> bool:
        """Whether no method of detection or forecast is scored: a run then ends with the survey."""
        is_true = self.detection == IDEAL and self.forecast == NO_FORECAST
        return is_true or not self.scores_maps


@dataclass(frozen=True, slots=True)
class CloudRanges:
    """One layer of clouds, before its velocity is drawn."""

    layer: LayerSettings
    """The layer, as if its clouds moved north at first."""
    speed_mps: Range
    turn_deg: Range
    """Clockwise from the heading of the layer below; of the lowest layer from north."""


@dataclass(frozen=True, slots=True, eq=False)
class Scenario:
    """Everything that a run needs besides its seed, which replaces `wind.seed`.

    The seed also draws the clouds' velocity and, from `conditions`, the sun's elevation, light,
    camera and link.
    """

    name: str
    about: str
    site: Site
    """Read from a folder, or generated around the task; has a frame and an imaging drone."""
    fleet: ScenarioFleet
    imager: ScenarioImager
    sun: SunSettings
    clouds: tuple[CloudRanges, ...]
    """Layers, the lower first."""
    wind: WindSettings
    conditions: ConditionRanges
    """Relief is rendered only: the station assumes flat ground on a site without an elevation
    model, and drones keep their height above takeoff in any case."""
    faults: tuple[InjectedFault, ...]
    chances: tuple[RandomFault, ...]
    """Random faults, drawn from the run's seed."""
    survey: Survey
    methods: Methods
    limit_s: float
    """The operator aborts the survey then."""
    files: tuple[Path, ...] = ()
    """Files besides the scenario's own: the site's folder, the file of faults."""

    @property
    def frame(self) -> LocalFrame:
        """The site's local frame, in which all positions are given."""
        assert self.site.frame is not None  # or it would not have been read
        return self.site.frame
