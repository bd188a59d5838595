"""Survey cameras by their makers' public figures, and their lens in the renderer's model."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import atan, degrees, radians, tan

import numpy as np

from recon.camera import OmnidirectionalCamera


@dataclass(frozen=True, slots=True)
class PhotoCamera:
    """A camera without distortion, as its photos name it."""

    make: str
    model: str
    cols: int
    rows: int
    focal_mm: float
    film_mm: int
    """Focal length of the same field on 35 mm film, as EXIF rounds it."""
    sensor_mm: float
    """Width of the sensor, along the photo's longer side."""
    has_rtk: bool = False

    @property
    def across_deg(self) -> float:
        """Field of view along the longer side."""
        return degrees(2.0 * atan(self.sensor_mm / 2.0 / self.focal_mm))

    def rows_of(self, cols: int) -> int:
        """Return the rows of a photo reduced to so many columns."""
        return round(cols * self.rows / self.cols)


class CameraName(StrEnum):
    """Cameras by the name that a person types; a Mavic 3M's is its visible one."""

    MAVIC_3E = "mavic-3e"
    MAVIC_3M = "mavic-3m"
    PHANTOM_4_RTK = "phantom-4-rtk"


# Sensors: 4/3 type (17.3 mm wide) and 1 inch (13.2 mm wide).
CAMERAS: Mapping[CameraName, PhotoCamera] = {
    CameraName.MAVIC_3E: PhotoCamera("DJI", "M3E", 5280, 3956, 12.29, 24, 17.3),
    CameraName.MAVIC_3M: PhotoCamera("DJI", "M3M", 5280, 3956, 12.29, 24, 17.3),
    CameraName.PHANTOM_4_RTK: PhotoCamera("DJI", "FC6310R", 5472, 3648, 8.8, 24, 13.2, True),
}
"""By their makers' public figures."""

PROFILE_POINTS, PROFILE_POWER = 200, 10
"""Of the fit that the renderer's lens model wants besides the exact one: it is not used."""


def pinhole(across_deg: float, cols: int, rows: int) -> OmnidirectionalCamera:
    """Return a lens without distortion of that field along the columns, in the renderer's model."""
    focal_px = cols / 2.0 / tan(radians(across_deg / 2.0))
    largest = np.arctan(np.hypot(cols, rows) / 2.0 / focal_px)
    angles = np.linspace(0.0, 1.05 * largest, PROFILE_POINTS)
    inverse = np.polynomial.polynomial.Polynomial.fit(
        angles - np.pi / 2.0, focal_px * np.tan(angles), PROFILE_POWER, domain=[]
    )
    return OmnidirectionalCamera(
        direct=(-focal_px,),
        inverse=tuple(inverse.coef.tolist()),
        centre_row_px=(rows - 1) / 2.0,
        centre_col_px=(cols - 1) / 2.0,
        affine_c=1.0,
        affine_d=0.0,
        affine_e=0.0,
        rows=rows,
        cols=cols,
    )
