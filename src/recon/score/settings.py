"""How runs are scored; each value with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ScoreSettings:
    """Times in seconds, distances in metres."""

    curve_min: tuple[float, ...] = (5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0)
    """Minutes at which the share of the region in sun is printed."""

    score_maps_every_s: float = 30.0
    """Interval of scored shade maps: those of one sky differ little over shorter times."""

    score_forecasts_every_s: float = 60.0
    lead_s: tuple[float, ...] = (15.0, 30.0, 60.0, 90.0, 120.0, 180.0, 300.0, 600.0)
    """A photo is a moment, a row half a minute, a mission minutes."""

    oldest_map_s: float = 10.0
    """An older shade map does not describe the present: its cells count as wrong."""

    right_share: float = 0.9
    """Share of the scored cells known and right: the time until then is a figure."""

    coarse_cell_m: float = 12.0
    """Cell size for that time: every map is scored, not one of six, on a ninth of the cells."""

    least_run_s: float = 1_200.0
    """Least length of a run in which detection or forecast is scored: otherwise a sky under which
    the survey ends early would be scored on fewer maps."""

    longest_return_s: float = 1_800.0
    """Longest time after the limit: a run then ends even with a drone still in the air."""

    sample_s: float = 0.1
    """Interval between two samples of the true paths."""

    separation_m: float = 10.0
    """Two vehicles in the air nearer than this, and nearly level, are a violation."""

    separation_up_m: float = 5.0
    """Height difference from which they are none; survey layers are 10 m apart."""


SCORE = ScoreSettings()
