"""Draws the shade of some skies on the ground, for docs/world.md.

    python -m studies.sky_pictures docs/images/skies.png

From the left: the scenarios cumulus-20, -40, -60 and two-layers; below, the same ten minutes later.
A picture is 8 km wide; white is full sun.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np

from recon.score import load_scenario
from recon.score.scenario_sky import sky_of
from recon.sim.world.keyframes import FloatImage

SEED = 12
WIDTH_M = 8_000.0
CELLS = 180
TIMES_S = (0.0, 600.0)
GRAYS = 20
"""So few that the file stays small."""
SCENARIOS = ("cumulus-20", "cumulus-40", "cumulus-60", "two-layers")


def shade(scenario: str, time_s: float) -> FloatImage:
    """Return what reaches the ground, north up."""
    sky = sky_of(load_scenario(Path("scenarios") / f"{scenario}.toml"), SEED)
    east_m = (np.arange(CELLS) + 0.5) * WIDTH_M / CELLS
    return sky.transmittance(east_m[np.newaxis, :], east_m[::-1, np.newaxis], time_s)


def picture() -> np.ndarray:
    """Return all skies side by side, a row per time, as gray values."""
    frame = 4
    rows = []
    for time_s in TIMES_S:
        panels = [np.pad(shade(sky, time_s), frame, constant_values=0.5) for sky in SCENARIOS]
        rows.append(np.hstack(panels))
    whole = np.vstack(rows)
    return (np.round(whole * (GRAYS - 1)) * (255.0 / (GRAYS - 1))).astype(np.uint8)


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description="Draw the shade of some skies.")
    parser.add_argument("file", type=Path)
    is_written, data = cv2.imencode(".png", picture(), [cv2.IMWRITE_PNG_COMPRESSION, 9])
    if not is_written:
        raise SystemExit("expected a picture that PNG can hold")
    parser.parse_args().file.write_bytes(data.tobytes())


if __name__ == "__main__":
    main()
