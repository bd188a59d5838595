"""A scenario of a hectare in full sun: flown in a minute."""

from pathlib import Path

SMALL_FIELD = """about = "a small field in sun"
start_utc = 2025-06-20T16:00:00Z

[site]
latitude_deg = 41.9
longitude_deg = -93.6
ground_altitude_m = 280.0

[task]
region_m = [[0.0, 0.0], [120.0, 0.0], [120.0, 80.0], [0.0, 80.0]]
limit_min = 10.0

[fleet]
survey_drones = {drones}

[imager]
radius_m = 150.0
"""


def small_field(folder: Path, *, drones: int) -> Path:
    """Write the scenario with a number of survey drones; return its file."""
    file = folder / "small-field.toml"
    file.write_text(SMALL_FIELD.format(drones=drones), encoding="utf-8")
    return file
