"""Survey cameras by name: field of view, pixels, timer and shutter, from the makers' pages.

Angles are of a whole photo at infinity, as a pinhole camera would have them: barrel distortion adds
a percent or two at the corners, which overlaps do not need. Where a maker gives sensor and focal
length, these are used; a rounded diagonal angle ("84 degrees") is up to 2 % wide of them.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import atan, degrees, hypot, radians, tan
from types import MappingProxyType
from typing import Literal

from recon.model.errors import ReconError
from recon.model.names import did_you_mean
from recon.model.survey import SurveyCamera

Shutter = Literal["global", "mechanical", "rolling"]

DJI_TIMER_S = (2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 60.0)
"""What DJI's apps offer as the interval of timed photos."""

FAST_TIMER_S = (0.7, 1.0, *DJI_TIMER_S)
"""Intervals with a fast mechanical shutter, JPEG only."""


class SurveyCameraError(ReconError):
    """A camera that is not in the table, or whose numbers are impossible."""


@dataclass(frozen=True, slots=True)
class CameraModel:
    """A camera on a gimbal. The longer side of a photo lies across the flight.

    `timer_s` are the intervals that its timer can be set to, ascending.
    """

    key: str
    title: str
    across_px: int
    along_px: int
    across_deg: float
    along_deg: float
    timer_s: tuple[float, ...]
    shutter: Shutter
    source: str

    def interval_fault(self, interval_s: float) -> str | None:
        """Return why the camera's timer cannot be set to an interval, else None."""
        if any(abs(each - interval_s) < 1e-6 for each in self.timer_s):
            return None
        known = ", ".join(f"{each:g}" for each in self.timer_s)
        return f"the timer of {self.title} has no {interval_s:g} s: choose one of {known} s"

    def at_interval(self, interval_s: float) -> SurveyCamera:
        """Return the camera as a survey needs it, its timer set to an interval."""
        return SurveyCamera(self.across_deg, self.along_deg, interval_s, self.across_px)


def of_sensor(
    across_px: int, along_px: int, sensor_mm: tuple[float, float], focal_mm: float
) -> tuple[int, int, float, float]:
    """Return pixels and angles (across, along) of a sensor's size and a true focal length."""
    across_deg, along_deg = (degrees(2.0 * atan(side / focal_mm / 2.0)) for side in sensor_mm)
    return across_px, along_px, across_deg, along_deg


def of_diagonal(
    across_px: int, along_px: int, diagonal_deg: float
) -> tuple[int, int, float, float]:
    """Return pixels and angles (across, along) of square pixels and a diagonal field of view."""
    per_px = 2.0 * tan(radians(diagonal_deg) / 2.0) / hypot(across_px, along_px)
    return of_sensor(across_px, along_px, (across_px * per_px, along_px * per_px), 1.0)


_4_3 = of_sensor(5280, 3956, (17.3, 13.0), 12.29)
_P1 = (8192, 5460, (35.9, 24.0))

CAMERAS: Mapping[str, CameraModel] = MappingProxyType(
    {
        model.key: model
        for model in (
            CameraModel(
                "mavic3m",
                "Mavic 3M, RGB (JPEG only)",
                *_4_3,
                FAST_TIMER_S,
                "mechanical",
                "DJI Mavic 3M, specifications: RGB camera; focal length as its photos state it",
            ),
            CameraModel(
                "mavic3m-ms",
                "Mavic 3M, multispectral (with or without RGB)",
                2592,
                1944,
                61.2,
                48.1,
                DJI_TIMER_S,
                "global",
                "DJI Mavic 3M, specifications: multispectral camera",
            ),
            CameraModel(
                "mavic3e",
                "Mavic 3E, wide",
                *_4_3,
                FAST_TIMER_S,
                "mechanical",
                "DJI Mavic 3 Enterprise, specifications: wide camera; focal length as its photos "
                "state it",
            ),
            CameraModel(
                "matrice4e",
                "Matrice 4E, wide",
                *of_diagonal(5280, 3956, 84.0),
                (0.5, *FAST_TIMER_S),
                "mechanical",
                "DJI Matrice 4 series, specifications: wide camera of the 4E",
            ),
            CameraModel(
                "mini3pro",
                "Mini 3 Pro (12 MP)",
                *of_diagonal(4032, 3024, 82.1),
                DJI_TIMER_S,
                "rolling",
                "DJI Mini 3 Pro, specifications: camera",
            ),
            CameraModel(
                "mini4pro",
                "Mini 4 Pro (12 MP)",
                *of_diagonal(4032, 3024, 82.1),
                DJI_TIMER_S,
                "rolling",
                "DJI Mini 4 Pro, specifications: camera",
            ),
            CameraModel(
                "air2s",
                "Air 2S",
                *of_diagonal(5472, 3648, 88.0),
                DJI_TIMER_S,
                "rolling",
                "DJI Air 2S, specifications: camera",
            ),
            CameraModel(
                "p4rtk",
                "Phantom 4 RTK (3:2)",
                *of_sensor(5472, 3648, (13.2, 8.8), 8.8),
                (2.5, *DJI_TIMER_S[1:]),
                "mechanical",
                "DJI Phantom 4 RTK, specifications: camera; its GSD is given as height / 36.5",
            ),
            CameraModel(
                "p4m",
                "P4 Multispectral",
                *of_sensor(1600, 1300, (1600 / 1890, 1300 / 1890), 1.0),
                DJI_TIMER_S,
                "global",
                "DJI P4 Multispectral, specifications: GSD of height / 18.9; its angle of 62.7 "
                "degrees is that of the whole sensor",
            ),
            *(
                CameraModel(
                    f"p1-{focal}mm",
                    f"Zenmuse P1, {focal} mm",
                    *of_sensor(*_P1, float(focal)),
                    FAST_TIMER_S,
                    "mechanical",
                    "DJI Zenmuse P1, specifications: sensor, lenses, shortest interval",
                )
                for focal in (24, 35, 50)
            ),
            CameraModel(
                "h20t-wide",
                "Zenmuse H20T, wide",
                *of_diagonal(4056, 3040, 82.9),
                DJI_TIMER_S,
                "rolling",
                "DJI Zenmuse H20 series, specifications: wide camera",
            ),
        )
    }
)
"""Cameras by the name that options and requests use, without the L-type payloads (lidars)."""


def camera_named(name: str, own: Iterable[CameraModel] = ()) -> CameraModel:
    """Return a camera of the table, or one of a site's own, which come first.

    Raises `SurveyCameraError` with the known names.
    """
    known = {**CAMERAS, **{model.key: model for model in own}}
    if name in known:
        return known[name]
    hint = did_you_mean(name, known)
    raise SurveyCameraError(f"Camera {name!a} not found; available: {', '.join(known)}{hint}")
