"""The numbers of flights that go by events, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FlightSettings:
    """Speeds in m/s, times in seconds. What the airframe does is in `sim`, and in `autopilot`."""

    acts_after_s: float = 0.14
    """From a word of the station until the aircraft does it: the link and the app."""

    home_mps: float = 10.0
    """Go-home's usual speed."""

    descent_mps: float = 3.0
    landing_s: float = 9.0
    """The last metres come down slowly, and a second goes by until the landing is confirmed."""

    looked_s: float = 30.0
    """Until somebody has looked why a drone was stopped, and sends it on."""

    unheeded_s: float = 15.0
    """Until a mission that was not begun counts as ignored."""

    drifts_s: float = 60.0
    """Without satellites the wind carries a drone along; by then its pilot holds it by sight."""

    home_slack: float = 1.2
    """A vehicle flies home while the battery still lasts for this many times the way."""

    sample_s: float = 2.9
    """Positions are told this often at least: surveys want them within 3 s. Where speed changes
    there is one too."""

    separation_m: float = 10.0
    """Two in the air nearer than this count as a violation: half of it is GNSS."""

    separation_up_m: float = 6.0
    """Farther apart in height they do not."""


@dataclass(frozen=True, slots=True)
class RunSettings:
    """How a run is watched."""

    score_maps_every_s: float = 30.0
    """Shade maps less far apart say the same again."""

    forecast_every_s: float = 10.0
    """Of the maps that forecasts get: as far apart as the nearest two that are compared."""

    score_forecasts_every_s: float = 60.0
    lead_s: tuple[float, ...] = (60.0, 180.0, 300.0, 600.0)
    """Whole minutes, so that one truth serves many leads."""

    watch_s: float = 1_200.0
    """The eye watches this long at least, whenever the survey is done: else a sky that lets it end
    early would be scored on fewer maps."""

    calm_s: float = 10.0
    """The survey is looked at this often while all fly missions, for nothing else is to be given;
    well within the time for which it keeps shade maps."""

    longest_way_home_s: float = 1_800.0
    """After the limit: a run ends then even if somebody is still in the air."""

    idle_s: float = 1.0
    """The planner is asked this often when something has ended."""


FLIGHT = FlightSettings()
RUN = RunSettings()
