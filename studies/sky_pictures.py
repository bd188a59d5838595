"""Draws the shade of some skies on the ground, for docs/world.md.

    python -m studies.sky_pictures docs/images/skies.png

From the left: cover 20, 40 and 60 %, and two layers; below, the same ten minutes later. A picture
is 8 km wide; white is full sun.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from recon.sim.world import LayerSettings, Sky, SkySettings
from recon.sim.world.keyframes import FloatImage

SEED = 12
WIDTH_M = 8_000.0
CELLS = 180
TIMES_S = (0.0, 600.0)
GRAYS = 20
"""So few that the file stays small."""
LOW = LayerSettings()
HIGH = LayerSettings(4_500.0, 14.0, 115.0, 0.3, softness=0.6)
SKIES = (
    (replace(LOW, cover=0.2),),
    (replace(LOW, cover=0.4),),
    (replace(LOW, cover=0.6),),
    (replace(LOW, cover=0.3), HIGH),
)


def shade(layers: tuple[LayerSettings, ...], time_s: float) -> FloatImage:
    """Return what reaches the ground, north up."""
    east_m = (np.arange(CELLS) + 0.5) * WIDTH_M / CELLS
    return Sky(SkySettings(SEED, layers=layers)).transmittance(
        east_m[np.newaxis, :], east_m[::-1, np.newaxis], time_s
    )


def picture() -> np.ndarray:
    """Return all skies side by side, a row per time, as gray values."""
    frame = 4
    rows = []
    for time_s in TIMES_S:
        panels = [np.pad(shade(sky, time_s), frame, constant_values=0.5) for sky in SKIES]
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
