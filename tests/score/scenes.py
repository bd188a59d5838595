"""A small scenario, as text and loaded."""

from pathlib import Path

from recon.score import Scenario, load_scenario

SMALL = """about = "a small field under cumulus"
start_utc = 2025-06-20T16:00:00Z
faults = ["pilot-takes:1:40:30"]

[site]
latitude_deg = 41.9
longitude_deg = -93.6
ground_altitude_m = 280.0

[task]
region_m = [
    [0.0, 0.0], [200.0, 0.0],
    [200.0, 150.0], [0.0, 150.0],
]
limit_min = 10.0

[fleet]
survey_drones = 2

[imager]
radius_m = 160.0

[[clouds]]
cover = 0.4
outer_scale_m = 2000.0

[wind]
speed_10m_mps = 4.0
"""

CALM = SMALL.replace('faults = ["pilot-takes:1:40:30"]\n', "")
"""The same without a fault."""

TINY = (
    CALM.replace("200.0", "60.0")
    .replace("150.0]", "40.0]")
    .replace("[fleet]", "height_m = 30.0\nside_overlap = 0.2\nfront_overlap = 0.4\n\n[fleet]")
)
"""Two rows of 50 m, flown low: a drone climbs and lands for most of the time."""

BRIEF = (
    TINY.replace("limit_min = 10.0", "limit_min = 1.0\nrounds = 1")
    .replace("60.0,", "30.0,")
    .replace("survey_drones = 2", "survey_drones = 1")
    .replace("radius_m = 160.0", "radius_m = 80.0")
)
"""One drone along one row: a minute."""


def written(folder: Path, text: str = SMALL) -> Path:
    path = folder / "small.toml"
    path.write_text(text, encoding="utf-8")
    return path


def small(folder: Path, text: str = SMALL) -> Scenario:
    return load_scenario(written(folder, text))
