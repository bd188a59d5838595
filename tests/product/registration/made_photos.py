"""Photos rendered from a made ground, straight down, with true poses by construction."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.units import NS_PER_S
from recon.product.footprint import Aim, PhotoView
from recon.product.headings import GIMBAL, RECORDED, best_guess_deg
from recon.product.photos.photo import Photo
from recon.product.registration import GreyImage
from recon.product.timing import TimedPhoto

HEIGHT_M, ACROSS_DEG, COLS, ROWS = 60.0, 66.0, 240, 180
GROUND_M, PIXEL_M = 260.0, 0.25
STEP_M, ROW_M, ROW_PHOTOS = 17.0, 25.0, 6

FloatArray = npt.NDArray[np.float64]


def ground() -> npt.NDArray[np.uint8]:
    """Return the ground's brightness, row 0 north: structures of half a metre to ten metres."""
    random, side = np.random.default_rng(7), round(GROUND_M / PIXEL_M)
    total = np.zeros((side, side), np.float32)
    for size in (2, 6, 20, 40):
        coarse = random.normal(size=(side // size + 2,) * 2).astype(np.float32)
        total += cv2.resize(coarse, (side, side), interpolation=cv2.INTER_CUBIC)
    return np.clip(128.0 + 25.0 * total, 0, 255).astype(np.uint8)


GROUND = ground()


def flown(rows: int = 2) -> list[Aim]:
    """Return true poses: rows to the north and back, the picture's top to the front."""
    aims = []
    for row in range(rows):
        for number in range(ROW_PHOTOS):
            along = (number - (ROW_PHOTOS - 1) / 2.0) * STEP_M
            north, yaw = (along, 0.0) if row % 2 == 0 else (-along, 180.0)
            aims.append(Aim((row - (rows - 1) / 2.0) * ROW_M, north, HEIGHT_M, yaw))
    return aims


@dataclass
class Card:
    """Photos with what they state, their true views, and pictures of the ground."""

    photos: list[TimedPhoto]
    true: list[PhotoView]

    def read(self, timed: TimedPhoto) -> GreyImage:
        return pictured(self.true[int(timed.photo.name)])


def pictured(view: PhotoView) -> GreyImage:
    """Return what a camera sees of the made ground."""
    to_pixels = np.array(
        [[1.0 / PIXEL_M, 0.0, GROUND_M / 2.0 / PIXEL_M - 0.5],
         [0.0, -1.0 / PIXEL_M, GROUND_M / 2.0 / PIXEL_M - 0.5],
         [0.0, 0.0, 1.0]]
    )  # fmt: skip
    # A pixel of the photo covers more than one of the ground's: their mean.
    fine = replace(view, cols=2 * view.cols, rows=2 * view.rows)
    seen = cv2.warpPerspective(
        GROUND,
        to_pixels @ fine.homography,
        (fine.cols, fine.rows),
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        borderMode=cv2.BORDER_REFLECT,
    )
    small = cv2.resize(seen, (view.cols, view.rows), interpolation=cv2.INTER_AREA)
    return np.asarray(small, dtype=np.uint8)


States = Callable[[int, Aim], Mapping[str, float]]


def card(
    aims: list[Aim],
    states: States,
    gnss_m: float = 0.2,
    across_deg: float = ACROSS_DEG,
) -> Card:
    """Return photos of poses; `states` gives their headings by source, `across_deg` is stated."""
    random = np.random.default_rng(3)
    true = [PhotoView(aim, ACROSS_DEG, COLS, ROWS) for aim in aims]
    photos = []
    for number, aim in enumerate(aims):
        east, north = random.normal(0.0, gnss_m, 2)
        headings = states(number, aim)
        stated = replace(
            aim,
            east_m=aim.east_m + east,
            north_m=aim.north_m + north,
            yaw_deg=best_guess_deg(headings),
        )
        photo = Photo(
            Path(f"{number}.JPG"), str(number), COLS, ROWS, 1, ("Made", "Camera", "1"),
            number * 2 * NS_PER_S, 1.0, 0.0, 0.0, None, across_deg, None, HEIGHT_M,
        )  # fmt: skip
        view = PhotoView(stated, across_deg, COLS, ROWS)
        photos.append(
            TimedPhoto(photo, "SIM-1", photo.clock_ns, 0.1, view, HEIGHT_M, dict(headings))
        )
    return Card(photos, true)


def gimbal_off(off_deg: float) -> States:
    """Return the statements of a gimbal that is off by so much, and of a right recorded heading."""
    return lambda _number, aim: {GIMBAL: aim.yaw_deg + off_deg, RECORDED: aim.yaw_deg + 1.0}
