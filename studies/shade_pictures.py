"""Draws how shade is found, a picture per step, for docs/detection-and-forecast.md.

    python -m studies.shade_pictures docs/images/shade-steps.png
    RECON_DATA=... python -m studies.shade_pictures docs/images/shade-becker-1.png --place becker-1

From the left: the frame on the ground, its light, its colour (blue over red), the land in full sun,
the shade that was found, and the true shade; unknown is red. Of a real place only the last two are
drawn: frames of others stay where they are.
"""

import argparse
import os
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
from tests.real_footage.footage import FootageSettings, footage, ground_images
from tests.real_footage.places import PLACES, load_place

from recon.detection import DETECTORS, DetectionSettings, DetectionState
from recon.detection.cells import field_grid
from recon.detection.sunlit.colour import cell_colour, upsampled
from recon.model.imagery import GroundImage
from recon.model.shade import FloatMap, ShadeMap
from studies.shade import Flight, moments

Picture = npt.NDArray[np.uint8]
Moments = Iterator[tuple[GroundImage, FloatMap]]

PANEL_PX = 260
FRAME_PX = 3
SIMULATED = Flight("cumulus-40", 2, 4.0, "auto", "true", 640, 5.0)
REAL_FRAMES = 48
SETTINGS = DetectionSettings()
RED = (40, 40, 200)
PALE = 245


def simulated() -> Moments:
    """Yield the ground images and true shade of a rendered flight."""
    for moment in moments(SIMULATED):
        yield moment.image, moment.transmittance


def real(folder: Path, name: str) -> Moments:
    """Yield the ground images of a real place under drawn shade, and that shade."""
    place = load_place(folder, name, SIMULATED.cols)
    made = footage(place, FootageSettings(), REAL_FRAMES)
    grid = place.grid()
    field = field_grid(grid, SETTINGS)
    for image, frame in ground_images(place, made, grid):
        yield image, frame.transmittance(field)


def panels(flown: Moments, *, is_real: bool) -> list[Picture]:
    """Return a panel per step at the last frame of a flight."""
    state = DetectionState()
    for image, truth in flown:  # noqa: B007
        state, found = DETECTORS["sunlit_reference"](state, image, SETTINGS)
    if not isinstance(found, ShadeMap) or state.sunlit is None or state.sunlit.land is None:
        raise SystemExit("expected a last frame in which shade is found, got one without")
    cells = cell_colour(image, found.grid, SETTINGS)
    shown = np.where(cells.seen, truth, np.nan)
    result = [_gray(found.transmittance, 0.0, 1.0), _gray(shown, 0.0, 1.0)]
    if is_real:
        return result
    land = state.sunlit.land
    light = upsampled(np.where(land.known, land.light, np.nan).astype(np.float32), truth.shape)
    return [
        np.where(image.valid[..., np.newaxis], image.rgb[..., ::-1], PALE).astype(np.uint8),
        _gray(cells.light, *_range(cells.light)),
        _gray(cells.colour, *_range(cells.colour)),
        _gray(np.where(cells.seen, light, np.nan), *_range(light)),
        *result,
    ]


def _range(values: FloatMap) -> tuple[float, float]:
    low, high = np.nanpercentile(values, [1.0, 99.0])
    return float(low), float(high)


def _gray(values: FloatMap, low: float, high: float) -> Picture:
    """Return values as grays from low to high, red where there is none."""
    known = np.isfinite(values)
    level = np.clip((np.nan_to_num(values) - low) / max(high - low, 1e-6), 0.0, 1.0)
    shown = np.repeat((235.0 * level)[..., np.newaxis], 3, axis=2)
    return np.where(known[..., np.newaxis], shown, RED).astype(np.uint8)


def side_by_side(parts: list[Picture]) -> Picture:
    """Return panels of one size in a row, with margins."""
    size = (PANEL_PX, PANEL_PX)
    scaled = [cv2.resize(part, size, interpolation=cv2.INTER_AREA) for part in parts]
    edge = ((FRAME_PX, FRAME_PX), (FRAME_PX, FRAME_PX), (0, 0))
    return np.hstack([np.pad(part, edge, constant_values=PALE) for part in scaled])


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description="Draw how shade is found.")
    parser.add_argument("file", type=Path)
    parser.add_argument("--place", choices=PLACES, help="a real place; default: a rendered flight")
    asked = parser.parse_args()
    if asked.place is None:
        flown = simulated()
    else:
        flown = real(Path(os.environ["RECON_DATA"]) / "fisheye", asked.place)
    whole = side_by_side(panels(flown, is_real=asked.place is not None))
    if not cv2.imwrite(str(asked.file), whole, [cv2.IMWRITE_PNG_COMPRESSION, 9]):
        raise SystemExit(f"expected a file that can be written, got {asked.file}")


if __name__ == "__main__":
    main()
