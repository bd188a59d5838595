"""Survey cameras: an interval timer without telemetry, and the footprint of each photo.

The pilot starts the timer by hand before the flight, so its phase is unknown to the station. Here
it is a function of seed and serial; only the score and tests may use it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, cos, radians, sin
from random import Random

import numpy as np
import numpy.typing as npt

from recon.model.survey import SurveyCamera
from recon.model.units import seconds_to_ns
from recon.sim.errors import SimulationError
from recon.sim.flight.kinematics import AircraftMotion

FloatArray = npt.NDArray[np.float64]
TruePath = Callable[[int], AircraftMotion | None]
"""Time in ns -> the aircraft's true motion, None while it is not flying."""

LATEST_S = 0.08
"""Largest delay of a photo, uniform from 0: writing to the memory card."""


@dataclass(frozen=True, slots=True)
class IntervalTimer:
    """A camera that takes a photo each interval, at an unknown phase."""

    seed: int
    serial: str
    interval_s: float

    def __post_init__(self) -> None:
        if not LATEST_S < self.interval_s < 3600.0:
            raise SimulationError(
                f"interval timer: expected {LATEST_S:g} to 3600 s, got {self.interval_s:g}"
            )

    @property
    def phase_s(self) -> float:
        """Phase within the interval, in seconds."""
        return Random(f"{self.seed}/{self.serial}/shutter").uniform(0.0, self.interval_s)

    def capture_ns(self, number: int) -> int:
        """Return when photo `number` is taken, in ns since the simulation's start."""
        # Seeded per photo: the delay does not depend on which photos were asked for.
        late_s = Random(f"{self.seed}/{self.serial}/photo {number}").uniform(0.0, LATEST_S)
        return seconds_to_ns(self.phase_s + number * self.interval_s + late_s)

    def between(self, start_ns: int, end_ns: int) -> list[tuple[int, int]]:
        """Return (number, time in ns) of the photos in [start_ns, end_ns)."""
        interval_ns = seconds_to_ns(self.interval_s)
        first = (start_ns - seconds_to_ns(self.phase_s + LATEST_S)) // interval_ns
        last = ceil((end_ns - seconds_to_ns(self.phase_s)) / interval_ns)
        numbered = [(n, self.capture_ns(n)) for n in range(max(0, first), max(0, last) + 1)]
        return [(number, time_ns) for number, time_ns in numbered if start_ns <= time_ns < end_ns]


@dataclass(frozen=True, slots=True, eq=False)
class SurveyPhoto:
    """One photo, with its true position."""

    serial: str
    number: int
    captured_at_ns: int
    east_m: float
    north_m: float
    height_m: float
    """Above the ground."""
    corners_m: FloatArray
    """(4, 2) east, north of its footprint: front left, front right, back right, back left."""


def photos(
    timer: IntervalTimer,
    camera: SurveyCamera,
    path: TruePath,
    span_ns: tuple[int, int],
    home_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> list[SurveyPhoto]:
    """Return the photos taken in flight over level ground, the camera pointing straight down.

    `path` is relative to a home that lies `home_m` east, north, up of the site's origin; photos
    are in the site's frame.
    """
    taken = []
    for number, time_ns in timer.between(*span_ns):
        motion = path(time_ns)
        if motion is not None and motion.height_m > 0.0:
            moved = motion._replace(
                east_m=motion.east_m + home_m[0],
                north_m=motion.north_m + home_m[1],
                height_m=motion.height_m + home_m[2],
            )
            taken.append(_photo(timer.serial, number, time_ns, moved, camera))
    return taken


def footprint_m(motion: AircraftMotion, camera: SurveyCamera) -> FloatArray:
    """Return the footprint's corners (4, 2) east, north; the top of the image points to the yaw."""
    ahead_m = camera.along_m(motion.height_m) / 2.0
    aside_m = camera.across_m(motion.height_m) / 2.0
    yaw = radians(motion.yaw_deg)
    ahead, right = np.array([sin(yaw), cos(yaw)]), np.array([cos(yaw), -sin(yaw)])
    signs = ((1, -1), (1, 1), (-1, 1), (-1, -1))
    middle = np.array([motion.east_m, motion.north_m])
    return np.array([middle + a * ahead_m * ahead + r * aside_m * right for a, r in signs])


def _photo(
    serial: str, number: int, time_ns: int, motion: AircraftMotion, camera: SurveyCamera
) -> SurveyPhoto:
    return SurveyPhoto(
        serial,
        number,
        time_ns,
        motion.east_m,
        motion.north_m,
        motion.height_m,
        footprint_m(motion, camera),
    )
