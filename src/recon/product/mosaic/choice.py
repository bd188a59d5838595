"""Which photo each piece of ground is taken from: one surely in sun, most from above.

A choice cell is `STEP_PX` x `STEP_PX` pixels of the mosaic. Light and angles change over metres,
so the cells that one photo wins are whole areas, and the chosen photo of each pixel is exactly what
the provenance states.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.model.arrays import FloatArray
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap
from recon.product.coverage import LEAST_CONFIDENCE
from recon.product.mosaic.cameras import Camera
from recon.product.mosaic.ground import MosaicGround
from recon.product.mosaic.light import PhotoLight
from recon.product.mosaic.visibility import SurfaceAround
from recon.product.timing import TimedPhoto

STEP_PX = 8
HALF_DIAGONAL = 0.71
"""Of a square, in its sides: a photo counts where it shows a whole cell."""
SURE_EVIDENCE = 0.45
"""Evidence of sun is how far the transmittance is above the threshold, 0 to 1, by its confidence.
From here on ground is in sun whatever the maps' error may be, and the angle alone decides."""
EVIDENCE_DEG = 600.0
"""Angle from nadir that evidence is worth: little of it lets shade in, a view from the side does
not."""
SHADED_DEG, UNKNOWN_DEG = 1_000.0, 3_000.0
"""Costs that put all shaded ground behind ground in sun, and unknown light behind both."""


OUTSIDE = 255


class Light(IntEnum):
    """What the photos of a place show."""

    MISSING = 0
    """No photo shows it."""
    UNKNOWN = 1
    """None shows it in known light."""
    SHADE = 2
    """None shows it in sun."""
    SUN = 3


@dataclass(frozen=True, slots=True)
class ChoiceSettings:
    """How photos are chosen."""

    margin: float = 0.08
    """Transmittance above `SUNLIT_TRANSMITTANCE` from which a place counts as in sun: the larger,
    the less shade is in the mosaic, and the more ground at the edges of shadows stays empty."""
    fills: bool = False
    """Whether ground without a photo in sun is taken from the least shaded one."""


@dataclass(frozen=True, slots=True, eq=False)
class PlacedPhoto:
    """A photo with its camera, its light and the ground that it may show."""

    timed: TimedPhoto
    camera: Camera
    light: PhotoLight
    footprint: shapely.Geometry


@dataclass(slots=True, eq=False)
class PixelChoice:
    """What was chosen for cells (R, C); NaN, or -1, where nothing was."""

    photo: npt.NDArray[np.int32]
    transmittance: FloatMap
    confidence: FloatMap
    off_nadir_deg: FloatMap
    light: npt.NDArray[np.uint8]
    """`Light` by cell, of all photos that show it; `OUTSIDE` the mosaic's area."""

    @classmethod
    def empty(cls, shape: tuple[int, int]) -> "PixelChoice":
        """Return a choice of nothing."""
        sun, sure, off_deg = (np.full(shape, np.nan, dtype=np.float32) for _ in range(3))
        outside = np.full(shape, OUTSIDE, dtype=np.uint8)
        return cls(np.full(shape, -1, dtype=np.int32), sun, sure, off_deg, outside)

    def indices(self) -> list[int]:
        """Return the photos that were chosen anywhere."""
        found = np.unique(self.photo)
        return [int(each) for each in found if each >= 0]

    def span(self, index: int) -> tuple[slice, slice]:
        """Return the rows and columns around the cells of a chosen photo."""
        chosen = self.photo == index
        rows, cols = (np.flatnonzero(chosen.any(axis=axis)) for axis in (1, 0))
        return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(cols[0]), int(cols[-1]) + 1)


def choose_photos(
    photos: Sequence[PlacedPhoto],
    candidates: Sequence[int],
    east_m: FloatArray,
    north_m: FloatArray,
    ground: MosaicGround,
    inside: npt.NDArray[np.bool_],
    settings: ChoiceSettings,
) -> PixelChoice:
    """Return the photos of cells with their middles at easts (C,) and norths (R,).

    `candidates` are indices of photos that may show them; only cells `inside` (R, C) count.
    """
    up_m = ground.up_m(east_m, north_m)
    easts, norths = np.meshgrid(east_m, north_m)
    places = np.stack([easts, norths, up_m], axis=-1)
    around = SurfaceAround.of(ground, east_m, north_m) if ground.is_rough else None
    cell_m = abs(float(east_m[1] - east_m[0]))
    best = PixelChoice.empty(up_m.shape)
    best.light[inside] = Light.MISSING
    least = np.full(up_m.shape, np.inf, dtype=np.float32)
    for index in candidates:
        photo = photos[index]
        shown = inside & photo.camera.shows(places, HALF_DIAGONAL * cell_m)
        if not shown.any():
            continue
        if around is not None:
            shown &= around.is_seen(photo.camera, places)
        _offer(best, least, index, photo, shown, places, settings)
    return best


def _offer(
    best: PixelChoice,
    least: FloatMap,
    index: int,
    photo: PlacedPhoto,
    shown: npt.NDArray[np.bool_],
    places: FloatArray,
    settings: ChoiceSettings,
) -> None:
    """Take a photo for the cells where it costs less than what is chosen so far."""
    sun, sure = photo.light.at(places[0, :, 0], places[:, 0, 1])
    is_known = sure >= LEAST_CONFIDENCE
    is_lit = is_known & (sun >= SUNLIT_TRANSMITTANCE + settings.margin)
    light = np.where(is_lit, Light.SUN, np.where(is_known, Light.SHADE, Light.UNKNOWN))
    np.maximum(best.light, np.where(shown, light, Light.MISSING), out=best.light, casting="unsafe")
    off_deg = photo.camera.off_nadir_deg(places).astype(np.float32)
    above = (sun - SUNLIT_TRANSMITTANCE) / (1.0 - SUNLIT_TRANSMITTANCE)
    evidence = np.clip(above, 0.0, 1.0) * sure
    cost = off_deg + EVIDENCE_DEG * np.maximum(SURE_EVIDENCE - evidence, 0.0)
    if settings.fills:
        shaded = np.where(is_known, SHADED_DEG * (2.0 - sun), UNKNOWN_DEG)
        cost = np.where(is_lit, cost, shaded + off_deg)
    else:
        shown = shown & is_lit
    wins = shown & (cost < least)
    least[wins] = cost[wins]
    best.photo[wins] = index
    best.transmittance[wins] = sun[wins]
    best.confidence[wins] = sure[wins]
    best.off_nadir_deg[wins] = off_deg[wins]
