"""Draws a mosaic in sun beside the one that has no regard to light, of the same photos.

    python -m studies.mosaic_picture docs/images/mosaic.jpg

A survey under broken cloud is flown by the whole station with detected shade, and its photos are
rendered; both mosaics are of the same cameras, in the brightness as photographed.
"""

import argparse
from contextlib import redirect_stdout
from dataclasses import replace
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

import numpy as np
from PIL import Image

from recon.cli.mosaic import mosaic_command
from recon.cli.score import with_methods
from recon.cli.sim_photos import write_photos
from recon.product.mosaic import PlacedPhoto, placed_photos
from recon.product.mosaic.light import PhotoLight
from recon.product.sun_at import Sunshine
from recon.score import load_scenario
from recon.sim.photos.card import CardSettings
from studies.mosaic import DETECTION, FORECAST, PLANNER, SCENARIO
from studies.survey_photos import fly

GAP_PX, WIDE_PX = 16, 700
RESOLUTION_M = 0.25
EMPTY = (255, 255, 255)


def main() -> None:
    """Fly, make both mosaics and draw them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=9.0)
    options = parser.parse_args()
    settings = CardSettings(cols=600)
    scenario = with_methods(load_scenario(SCENARIO), PLANNER, DETECTION, FORECAST)
    with TemporaryDirectory() as name, redirect_stdout(StringIO()):
        folder = Path(name)
        limit_s = 60.0 * options.minutes
        flown = fly(SCENARIO, scenario, options.seed, folder / "record", settings, limit_s)
        write_photos(folder / "card", flown.flight, flown.truth, settings)
        panels = []
        for place in (without_light, placed_photos):
            out = folder / f"mosaic-{len(panels)}"
            with patch("recon.cli.mosaic.placed_photos", place):
                mosaic_command(
                    flight=flown.record,
                    photos=[folder / "card"],
                    out=out,
                    resolution_m=RESOLUTION_M,
                    raw=True,
                )
            panels.append(panel(out / "preview.png"))
    beside(panels).save(options.out, quality=82)


def without_light(*inputs: Any) -> list[PlacedPhoto]:
    """Return placed photos as if all ground were in full sun."""
    return [replace(each, light=_sunny(each.light)) for each in placed_photos(*inputs)]


def _sunny(light: PhotoLight) -> PhotoLight:
    ones = np.ones_like(light.sun.transmittance)
    return replace(light, sun=Sunshine(ones, ones))


def panel(path: Path) -> Image.Image:
    """Return a preview in the width of a panel, on white."""
    picture = Image.open(path).convert("RGBA")
    ground = Image.new("RGBA", picture.size, (*EMPTY, 255))
    whole = Image.alpha_composite(ground, picture).convert("RGB")
    return whole.resize((WIDE_PX, round(WIDE_PX * whole.height / whole.width)))


def beside(panels: list[Image.Image]) -> Image.Image:
    """Return panels side by side."""
    size = sum(each.width for each in panels) + GAP_PX, max(each.height for each in panels)
    found, left = Image.new("RGB", size, EMPTY), 0
    for each in panels:
        found.paste(each, (left, 0))
        left += each.width + GAP_PX
    return found


if __name__ == "__main__":
    main()
