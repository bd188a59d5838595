"""One leg from standstill to standstill, worked out at once: when a vehicle is how far along it."""

from dataclasses import dataclass
from math import log, sqrt

import numpy as np
import numpy.typing as npt

from recon.score.settings import FlightSettings

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Leg:
    """Speeding up, cruising, braking, settling; each phase may be empty.

    In the last metres the speed falls with the distance left, as a position control has it: the
    time constant there is one second.
    """

    length_m: float
    top_mps: float
    acceleration_mps2: float
    braking_mps2: float
    settling_m: float
    """What is left when settling begins, in metres and in m/s."""
    up_s: float
    cruise_s: float
    brake_s: float
    settle_s: float

    @property
    def duration_s(self) -> float:
        """From the start until the end counts as reached."""
        return self.up_s + self.cruise_s + self.brake_s + self.settle_s

    def along_m(self, after_s: FloatArray) -> FloatArray:
        """Return how far along a vehicle is at times after the start, (N,)."""
        up_s = _within(after_s, self.up_s)
        cruise_s = _within(after_s - self.up_s, self.cruise_s)
        brake_s = _within(after_s - self.up_s - self.cruise_s, self.brake_s)
        settle_s = _within(after_s - self.duration_s + self.settle_s, self.settle_s)
        along_m = 0.5 * self.acceleration_mps2 * up_s**2 + self.top_mps * cruise_s
        along_m += self.top_mps * brake_s - 0.5 * self.braking_mps2 * brake_s**2
        along_m += self.settling_m * (1.0 - np.exp(-settle_s))
        arrived: FloatArray = np.where(after_s >= self.duration_s, self.length_m, along_m)
        return np.minimum(arrived, self.length_m)


def leg(length_m: float, speed_mps: float, settings: FlightSettings) -> Leg:
    """Return the motion over a length at a speed, as far as there is room for it."""
    up, down = settings.acceleration_mps2, settings.braking_mps2
    # Braking aims at a place half a settling way before the end, and passes into settling there.
    room_m = length_m - down / 2.0
    peak_mps = sqrt(max(2.0 * room_m * up * down / (up + down), 0.0))
    top_mps = min(speed_mps, peak_mps)
    if top_mps < down:
        # No room to brake: it speeds up until its speed is what is left, and settles.
        top_mps = min(speed_mps, up * (sqrt(1.0 + 2.0 * length_m / up) - 1.0))
        settling_m, braking_s, braking_m = top_mps, 0.0, 0.0
    else:
        settling_m, braking_s = down, (top_mps - down) / down
        braking_m = (top_mps**2 - down**2) / (2.0 * down)
    cruise_m = max(length_m - top_mps**2 / (2.0 * up) - braking_m - settling_m, 0.0)
    settle_s = max(log(settling_m / settings.stopped_mps), 0.0) if settling_m > 0.0 else 0.0
    cruise_s = cruise_m / top_mps if top_mps > 0.0 else 0.0
    up_s = top_mps / up
    return Leg(length_m, top_mps, up, down, settling_m, up_s, cruise_s, braking_s, settle_s)


def _within(at_s: FloatArray, most_s: float) -> FloatArray:
    return np.minimum(np.maximum(at_s, 0.0), most_s)
