"""A scenario: a place, a fleet, a sky, what goes wrong, what is to be imaged, and how."""

from dataclasses import dataclass

from recon.model.geo import LocalFrame
from recon.model.survey import Survey
from recon.sim.app.faults import InjectedFault, RandomFault
from recon.sim.world import LightSettings, SkySettings, WindSettings
from recon.site import Site

IDEAL, NO_FORECAST = "ideal", "none"

Place = tuple[float, float]
"""East and north metres of the site."""


@dataclass(frozen=True, slots=True)
class Fleet:
    """The survey drones; `pads_m` holds one place for each."""

    pads_m: tuple[Place, ...]
    endurance_s: float
    """Hovering, from full to empty."""
    reserve_share: float
    """Of the battery, that nobody plans with."""
    swap_s: float
    """On the ground, for a fresh battery."""

    @property
    def serials(self) -> tuple[str, ...]:
        """One for each drone."""
        return tuple(f"SIM-{number + 1}" for number in range(len(self.pads_m)))


@dataclass(frozen=True, slots=True)
class ScenarioImager:
    """The eye hovers over a place and sees a circle of the ground."""

    over_m: Place
    height_m: float
    radius_m: float
    period_s: float
    """Between two shade maps."""
    cell_m: float


@dataclass(frozen=True, slots=True)
class Methods:
    """Who sees, who foresees: names; the planner's is in the survey.

    `detection` is `ideal`, for shade maps that are the truth, or a detector's name; `forecast` is
    `none` or a forecaster's name.
    """

    detection: str = IDEAL
    forecast: str = "global_shift"

    @property
    def is_guidance_alone(self) -> bool:
        """Whether neither detection nor forecast is scored: then the eye looks only at the region,
        and only until the survey is over. Studies of guidance are fast by that."""
        return self.detection == IDEAL and self.forecast == NO_FORECAST


@dataclass(frozen=True, slots=True, eq=False)
class Scenario:
    """All that a run needs beside its seed; `sky.seed` and `wind.seed` are the run's to set."""

    name: str
    about: str
    site: Site
    """A folder's, or made up around the task; it has a frame and an eye."""
    fleet: Fleet
    imager: ScenarioImager
    sky: SkySettings
    light: LightSettings
    wind: WindSettings
    relief_m: float
    """Standard deviation of the heights of the land that the eye sees; the station takes a site
    without an elevation model for flat, and drones fly above their takeoff point all the same."""
    faults: tuple[InjectedFault, ...]
    chances: tuple[RandomFault, ...]
    """Faults that each run draws from its seed."""
    survey: Survey
    methods: Methods
    limit_s: float
    """When the run ends at the latest."""

    @property
    def frame(self) -> LocalFrame:
        """The site's local frame, which all places are in."""
        assert self.site.frame is not None  # or it would not have been read
        return self.site.frame
