"""A window's pixels, each from the photo that was chosen for it."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.arrays import FloatArray
from recon.product.mosaic.cameras import Camera
from recon.product.mosaic.choice import STEP_PX, PixelChoice, PlacedPhoto
from recon.product.mosaic.ground import MosaicGround
from recon.product.mosaic.pixels import Cut, Edges, MosaicBand, PhotoCuts, Pixels
from recon.product.mosaic.plan import WINDOW_PX, MosaicPlan, MosaicWindow
from recon.product.photos.photo_error import PhotoError

ROUGH_STEP_PX = 2
"""Places are projected at every such pixel of rough ground, at every `STEP_PX`-th of smooth one;
between them pixels of photos are interpolated."""
GAMMA = 2.2
"""Of cameras' pictures: about sRGB's."""
BRIGHTEST = 3.0
"""Largest gain of light: below a quarter of the beam noise and colour are another's."""

BoolMap = npt.NDArray[np.bool_]
FloatMap = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Renderer:
    """Makes the windows of one band; several threads may call it."""

    plan: MosaicPlan
    photos: Sequence[PlacedPhoto]
    ground: MosaicGround
    cuts: PhotoCuts
    band: MosaicBand
    direct_share: float | None
    """The direct beam's share of a clear sky's light, to even brightness; None: as photographed."""

    def window(
        self, number: int, window: MosaicWindow, choice: PixelChoice
    ) -> tuple[Pixels | None, dict[int, str]]:
        """Return a window's pixels (rows, cols, channels), and why photos failed.

        Of a picture the last channel is alpha; of another band, 0 is no data. None where nothing
        was chosen.
        """
        picture: Pixels | None = None
        failed: dict[int, str] = {}
        for index in choice.indices():
            camera = camera_for(self.band, self.photos, index)
            if camera is None or not self.cuts.has(number, index):
                continue
            try:
                cut = self.cuts.get(number, index)
            except PhotoError as problem:
                failed[index] = str(problem)
                continue
            if picture is None:
                shape = WINDOW_PX, WINDOW_PX, len(self.band.channels) + self.band.is_picture
                picture = np.zeros(shape, dtype=self.band.dtype)
            rows, cols = choice.span(index)
            found, is_known = self._part(window, index, camera, cut, rows, cols)
            mask = is_known & _by_pixel(choice.photo[rows, cols] == index)
            part = picture[_pixels(rows), _pixels(cols)]
            if self.band.is_picture:
                part[mask, :-1] = found[mask]
                part[mask, -1] = np.iinfo(picture.dtype).max
            else:
                part[mask] = np.maximum(found[mask], 1)
        return picture, failed

    def _part(
        self, window: MosaicWindow, index: int, camera: Camera, cut: Cut, rows: slice, cols: slice
    ) -> tuple[Pixels, BoolMap]:
        """Return a photo's values on some cells of a window, and where their place is known."""
        photo, shrunk = self.photos[index], float(self.cuts.shrink)
        across, down = _pixel_maps(self.plan, window, camera, self.ground, rows, cols)
        with np.errstate(invalid="ignore"):
            is_known = (across >= -1.0) & (across <= camera.cols)
            is_known &= (down >= -1.0) & (down <= camera.rows)
        # A shrunk pixel's middle is the middle of those it was made of.
        across, down = (
            np.nan_to_num((each + 0.5) / shrunk - 0.5 - first)
            for each, first in ((across, cut.first[1]), (down, cut.first[0]))
        )
        found = cv2.remap(cut.pixels, across, down, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT)
        found = found.reshape(*across.shape, -1)
        if self.direct_share is not None:
            east_m, north_m = self.plan.middles_m(window, STEP_PX, rows, cols)
            sun, _sure = photo.light.at(east_m, north_m)
            light = _upsampled(sun, STEP_PX)
            found = _evened(found, light, self.direct_share, self.band.is_picture)
        return found, is_known


def camera_for(band: MosaicBand, photos: Sequence[PlacedPhoto], index: int) -> Camera | None:
    """Return the camera of a photo's band; None where the photo lacks it."""
    return photos[index].camera if band.cameras is None else band.cameras[index]


def taken_of(
    plan: MosaicPlan,
    windows: Iterable[tuple[MosaicWindow, PixelChoice]],
    photos: Sequence[PlacedPhoto],
    ground: MosaicGround,
    band: MosaicBand,
) -> dict[int, dict[int, Edges]]:
    """Return by photo and by a window's number what it takes of the photo's band."""
    taken: dict[int, dict[int, Edges]] = defaultdict(dict)
    for number, (window, choice) in enumerate(windows):
        for index in choice.indices():
            camera = camera_for(band, photos, index)
            if camera is None:
                continue
            rows, cols = choice.span(index)
            places = _places(plan, window, ground, STEP_PX, _wider(rows), _wider(cols))
            edges = _edges(camera, places)
            if edges is not None:
                taken[index][number] = edges
    return taken


def _edges(camera: Camera, places: FloatArray) -> Edges | None:
    """Return the part of a picture that shows places; None where it shows nothing of them."""
    across, down = camera.project(places)
    if not np.isfinite(across).any():
        return None
    low = np.maximum([np.nanmin(down), np.nanmin(across)], 0.0)
    most = [camera.rows - 1.0, camera.cols - 1.0]
    high = np.minimum([np.nanmax(down), np.nanmax(across)], most)
    # A band of a narrower field may show nothing.
    return None if (low > high).any() else (*low.tolist(), *high.tolist())


def _wider(span: slice) -> slice:
    return slice(span.start - 1, span.stop + 1)


def _by_pixel(cells: BoolMap) -> BoolMap:
    return np.repeat(np.repeat(cells, STEP_PX, axis=0), STEP_PX, axis=1)


def _pixels(span: slice) -> slice:
    return slice(span.start * STEP_PX, span.stop * STEP_PX)


def _places(
    plan: MosaicPlan,
    window: MosaicWindow,
    ground: MosaicGround,
    step_px: int,
    rows: slice,
    cols: slice,
) -> FloatArray:
    """Return the middles (R, C, 3) of squares of `step_px` pixels of a window."""
    east_m, north_m = plan.middles_m(window, step_px, rows, cols)
    easts, norths = np.meshgrid(east_m, north_m)
    return np.stack([easts, norths, ground.up_m(east_m, north_m)], axis=-1)


def _pixel_maps(
    plan: MosaicPlan,
    window: MosaicWindow,
    camera: Camera,
    ground: MosaicGround,
    rows: slice,
    cols: slice,
) -> tuple[FloatMap, FloatMap]:
    """Return a photo's column and row for each pixel of some cells of a window; NaN: unknown."""
    step = ROUGH_STEP_PX if ground.is_rough else STEP_PX
    squares = STEP_PX // step
    spans = [_wider(slice(s.start * squares, s.stop * squares)) for s in (rows, cols)]
    found = camera.project(_places(plan, window, ground, step, spans[0], spans[1]))
    across, down = (_upsampled(each.astype(np.float32), step) for each in found)
    inner = slice(step, -step), slice(step, -step)
    return across[inner], down[inner]


def _upsampled(values: FloatMap, step: int) -> FloatMap:
    """Return values of squares' middles at the middles of their pixels, between them linearly."""
    size = values.shape[1] * step, values.shape[0] * step
    return cv2.resize(values, size, interpolation=cv2.INTER_LINEAR).astype(np.float32, copy=False)


def _evened(found: Pixels, sun: FloatMap, direct_share: float, is_picture: bool) -> Pixels:
    """Return pixels as bright as in full sun: divided by their share of a clear sky's light."""
    share = direct_share * np.clip(sun, 0.0, 1.0) + (1.0 - direct_share)
    gain = np.minimum(1.0 / share, BRIGHTEST)
    gain = (gain ** (1.0 / GAMMA) if is_picture else gain).astype(np.float32)
    brighter = found * gain[..., np.newaxis] + np.float32(0.5)
    full = np.float32(np.iinfo(found.dtype).max)
    evened: Pixels = np.minimum(brighter, full, out=brighter).astype(found.dtype)
    return evened
