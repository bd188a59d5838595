"""The truth of a finished mosaic's pixels: light by the simulated sky, places by the drawn land."""

import csv
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import rasterio

from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.product.mosaic.cameras import Camera, PhotoLens
from recon.sim.camera.field import FieldRenderer
from recon.sim.land.land_tiles import land_of
from recon.sim.land.plants import add_plants
from recon.sim.photos.cameras import pinhole
from recon.sim.photos.card import PhotoShot
from studies.survey_photos import SurveyFlown

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

DARK_TRANSMITTANCE = 0.25
PATCH_M, APART_M, SEARCH_M = 20.0, 35.0, 4.0
LEAST_CORRELATION = 0.6
"""Below it a patch shows too little to find its place: then it says nothing of places."""
DETAIL_M = 2.0
"""Width of the brightness that is taken away before patches are compared: light is not place."""


@dataclass(slots=True)
class Lights:
    """Counts of equal pieces of ground."""

    taken: int = 0
    shaded: int = 0
    dark: int = 0
    """At most a quarter lit."""
    shown: int = 0
    plain_shaded: int = 0
    sunlit: int = 0
    """Truly photographed in sun."""
    empty: int = 0
    """Of these, not in the mosaic."""

    def __iadd__(self, other: "Lights") -> "Lights":
        for name in self.__slots__:
            setattr(self, name, getattr(self, name) + getattr(other, name))
        return self

    def __str__(self) -> str:
        return (
            f"{self.shaded_percent:.3f} % in shade, {self.plain_percent:.2f} % without regard to "
            f"light, {self.empty_percent:.2f} % of the ground in sun empty"
        )

    @property
    def shaded_percent(self) -> float:
        """Share of the mosaic truly in shade."""
        return 100.0 * self.shaded / max(1, self.taken)

    @property
    def dark_percent(self) -> float:
        """Share of the mosaic truly at most a quarter lit."""
        return 100.0 * self.dark / max(1, self.taken)

    @property
    def plain_percent(self) -> float:
        """The same of the mosaic without regard to light."""
        return 100.0 * self.plain_shaded / max(1, self.shown)

    @property
    def empty_percent(self) -> float:
        """Share of the ground truly photographed in sun that the mosaic leaves empty."""
        return 100.0 * self.empty / max(1, self.sunlit)


def lights_of(mosaic: Path, flown: SurveyFlown) -> Lights:
    """Return the light of a mosaic's pieces of ground, at the true times of their photos."""
    with rasterio.open(mosaic / "provenance.tif") as raster:
        photo, light = raster.read(1), raster.read(6)
        east_m, north_m = _middles_m(raster.transform, *raster.shape)
    with (mosaic / "photos.csv").open(encoding="utf-8", newline="") as file:
        numbers = {row["name"]: int(row["number"]) for row in csv.DictReader(file)}
    area = np.isfinite(light)
    least_deg, plain = np.full(area.shape, np.inf), np.full(area.shape, np.nan)
    sunlit, own = np.zeros_like(area), np.full(area.shape, np.nan)
    places = _on_ground(flown, east_m, north_m)
    for shot in flown.shots.values():
        box = _around(shot, east_m, north_m)
        camera, here = camera_of(flown, shot), places[box]
        sun = flown.truth.sky.transmittance(here[..., 0], here[..., 1], shot.at_s)
        shown = camera.shows(here) & area[box]
        off_deg = camera.off_nadir_deg(here)
        nearest = shown & (off_deg < least_deg[box])
        least_deg[box][nearest], plain[box][nearest] = off_deg[nearest], sun[nearest]
        sunlit[box] |= shown & (sun >= SUNLIT_TRANSMITTANCE)
        taken = photo[box] == numbers.get(shot.name, -1)
        own[box][taken] = sun[taken]
    is_taken = np.isfinite(photo)
    assert np.isfinite(own[is_taken]).all(), "each piece is of a photo that was taken"
    return Lights(
        int(is_taken.sum()),
        int((own[is_taken] < SUNLIT_TRANSMITTANCE).sum()),
        int((own[is_taken] <= DARK_TRANSMITTANCE).sum()),
        int(np.isfinite(plain).sum()),
        int((plain < SUNLIT_TRANSMITTANCE).sum()),
        int(sunlit.sum()),
        int((sunlit & ~is_taken).sum()),
    )


def camera_of(flown: SurveyFlown, shot: PhotoShot) -> Camera:
    """Return the true camera of a photo."""
    camera, cols = flown.settings.camera, flown.settings.cols
    rows = camera.rows_of(cols)
    lens = pinhole(camera.across_deg, cols, rows)
    focal_px = -lens.direct[0]
    centre_px = lens.centre_col_px, lens.centre_row_px
    pose = shot.pose
    return Camera(
        pose.position_enu_m, pose.rotation_enu_camera, PhotoLens((focal_px, focal_px), centre_px),
        cols, rows,
    )  # fmt: skip


def _middles_m(transform: rasterio.Affine, rows: int, cols: int) -> tuple[FloatArray, FloatArray]:
    east_m = transform.c + transform.a * (np.arange(cols) + 0.5)
    north_m = transform.f + transform.e * (np.arange(rows) + 0.5)
    return east_m, north_m


def _on_ground(flown: SurveyFlown, east_m: FloatArray, north_m: FloatArray) -> FloatArray:
    """Return the true ground (R, C, 3) at easts (C,) and norths (R,)."""
    easts, norths = np.meshgrid(east_m, north_m)
    up_m = np.zeros_like(easts)
    if flown.relief is not None:
        up_m = flown.relief.height_m(easts, norths).astype(np.float64)
    return np.stack([easts, norths, up_m], axis=-1)


def _around(shot: PhotoShot, east_m: FloatArray, north_m: FloatArray) -> tuple[slice, slice]:
    """Return the rows and columns of all ground that a photo from straight above may show."""
    reach_m = 1.2 * float(shot.place_m[2])
    cols = np.flatnonzero(np.abs(east_m - shot.place_m[0]) <= reach_m)
    rows = np.flatnonzero(np.abs(north_m - shot.place_m[1]) <= reach_m)
    if len(cols) == 0 or len(rows) == 0:
        return slice(0, 0), slice(0, 0)
    return slice(rows[0], rows[-1] + 1), slice(cols[0], cols[-1] + 1)


def places_off_m(mosaic: Path, flown: SurveyFlown) -> list[float]:
    """Return how far patches of a mosaic's picture lie from where the land truly is, in metres."""
    with rasterio.open(mosaic / "mosaic.tif") as raster:
        cell_m = raster.transform.a
        picture = np.moveaxis(raster.read(), 0, -1)
        east_m, north_m = _middles_m(raster.transform, *raster.shape)
    world, found = flown.world, list[float]()
    size, step = round(PATCH_M / cell_m), round(APART_M / cell_m)
    reach = round(SEARCH_M / cell_m)
    for row in range(reach, len(north_m) - size - reach, step):
        for col in range(reach, len(east_m) - size - reach, step):
            patch = picture[row : row + size, col : col + size]
            if not patch[..., -1].all():
                continue
            rows = slice(row - reach, row + size + reach)
            cols = slice(col - reach, col + size + reach)
            land = drawn(world, east_m[cols], north_m[rows], cell_m)
            shift = _shift_px(_detail(patch[..., :3], cell_m), _detail(land, cell_m))
            if shift is not None:
                found.append(float(np.hypot(*(shift - reach))) * cell_m)
    return found


def drawn(
    world: FieldRenderer, east_m: FloatArray, north_m: FloatArray, cell_m: float
) -> npt.NDArray[np.uint8]:
    """Return the land (R, C, 3) at easts (C,) and norths (R,), in even light."""
    middle_e, middle_n = float(east_m.mean()), float(north_m.mean())
    square = land_of(world.seed).square(0, middle_e, middle_n, world.sky.sun_at(0.0))
    easts, norths = (part.astype(np.float32) for part in np.meshgrid(east_m, north_m))
    cols = (easts - np.float32(square.west_m)) / np.float32(square.cell_m) - np.float32(0.5)
    rows = (np.float32(square.north_m) - norths) / np.float32(square.cell_m) - np.float32(0.5)
    picture = cv2.remap(square.pixels, cols, rows, cv2.INTER_LINEAR).astype(np.uint8)
    add_plants(picture, easts, norths, cell_m, world.seed)
    return picture[..., :3]


def _detail(rgb: npt.NDArray[np.uint8], cell_m: float) -> npt.NDArray[np.float32]:
    """Return a picture's brightness, without what changes over more than `DETAIL_M`."""
    grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY).astype(np.float32)
    return (grey - cv2.GaussianBlur(grey, (0, 0), DETAIL_M / cell_m)).astype(np.float32)


def _shift_px(patch: npt.NDArray[np.float32], land: npt.NDArray[np.float32]) -> FloatArray | None:
    """Return column and row of the land where a patch fits best, to a part of a pixel; None where
    it fits nowhere well, or at the edge."""
    fits = cv2.matchTemplate(land, patch, cv2.TM_CCOEFF_NORMED)
    _, most, _, (col, row) = cv2.minMaxLoc(fits)
    inside = 0 < col < fits.shape[1] - 1 and 0 < row < fits.shape[0] - 1
    if most < LEAST_CORRELATION or not inside:
        return None
    across, down = fits[row, col - 1 : col + 2], fits[row - 1 : row + 2, col]
    return np.array([col + _vertex(across), row + _vertex(down)])


def _vertex(three: npt.NDArray[np.float32]) -> float:
    """Return where a parabola through three values has its top, from the middle one."""
    before, middle, after = (float(each) for each in three)
    return 0.5 * (before - after) / (before - 2.0 * middle + after)
