"""One straight leg, worked out at once: when a vehicle is how far along it.

It is what `sim.kinematics` and `sim.mission` do in steps: speed up, cruise, brake, settle. Each of
these may be empty.
"""

from dataclasses import dataclass
from math import log, sqrt

import numpy as np
import numpy.typing as npt

from recon.sim.flight.kinematics import BRAKING_MPS2

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Pace:
    """How a leg is flown, along it."""

    speed_mps: float
    acceleration_mps2: float = 2.5
    left_m: float = 0.4
    """The leg counts as flown when this is left of it; more than nothing."""
    braking_mps2: float = BRAKING_MPS2
    start_mps: float = 0.0


@dataclass(frozen=True, slots=True)
class Leg:
    """In the last metres the speed falls with the distance left, as a position control has it: the
    time constant there is one second."""

    way_m: float
    """What is flown of it."""
    start_mps: float
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
        """From the start until the leg counts as flown."""
        return self.up_s + self.cruise_s + self.brake_s + self.settle_s

    @property
    def phases_s(self) -> tuple[float, float, float, float]:
        """How long each of them lasts."""
        return self.up_s, self.cruise_s, self.brake_s, self.settle_s

    @property
    def end_mps(self) -> float:
        """The speed at its end."""
        if self.settle_s > 0.0:
            return float(self.settling_m * np.exp(-self.settle_s))
        return self.top_mps - self.braking_mps2 * self.brake_s

    def along_m(self, after_s: FloatArray) -> FloatArray:
        """Return how far along a vehicle is at times after the start, (N,)."""
        up_s = _within(after_s, self.up_s)
        cruise_s = _within(after_s - self.up_s, self.cruise_s)
        brake_s = _within(after_s - self.up_s - self.cruise_s, self.brake_s)
        settle_s = _within(after_s - self.duration_s + self.settle_s, self.settle_s)
        along_m = (self.start_mps + 0.5 * self.acceleration_mps2 * up_s) * up_s
        along_m += self.top_mps * (cruise_s + brake_s) - 0.5 * self.braking_mps2 * brake_s**2
        along_m += self.settling_m * (1.0 - np.exp(-settle_s))
        flown: FloatArray = np.where(after_s >= self.duration_s, self.way_m, along_m)
        return np.minimum(flown, self.way_m)


def leg(length_m: float, pace: Pace) -> Leg:
    """Return the motion over a length, as far as there is room for the speed."""
    up, down, start_mps = pace.acceleration_mps2, pace.braking_mps2, pace.start_mps
    way_m = length_m - pace.left_m
    if way_m <= 0.0:
        return Leg(0.0, 0.0, 0.0, up, down, 0.0, 0.0, 0.0, 0.0, 0.0)
    # Braking aims at a place half a settling way before the end, and passes into settling there.
    gained_m = start_mps**2 / (2.0 * up)
    room_m = length_m - down / 2.0 + gained_m
    top_mps = min(pace.speed_mps, sqrt(max(2.0 * room_m * up * down / (up + down), 0.0)))
    settling_m = min(top_mps, down)
    if top_mps < down:
        # No room to brake: it speeds up until its speed is what is left, and settles.
        reached_mps = up * (sqrt(1.0 + 2.0 * (length_m + gained_m) / up) - 1.0)
        settling_m = top_mps = max(min(pace.speed_mps, reached_mps), start_mps)
    end_m = max(settling_m, pace.left_m)
    end_mps = min(sqrt(2.0 * down * (end_m - down / 2.0)) if end_m > down else end_m, top_mps)
    braking_m = (top_mps**2 - end_mps**2) / (2.0 * down)
    sped_m = (top_mps**2 - start_mps**2) / (2.0 * up)
    return Leg(
        way_m=way_m,
        start_mps=start_mps,
        top_mps=top_mps,
        acceleration_mps2=up,
        braking_mps2=down,
        settling_m=settling_m,
        up_s=(top_mps - start_mps) / up,
        cruise_s=max(length_m - sped_m - braking_m - end_m, 0.0) / top_mps,
        brake_s=(top_mps - end_mps) / down,
        settle_s=max(log(settling_m / pace.left_m), 0.0),
    )


def _within(at_s: FloatArray, most_s: float) -> FloatArray:
    return np.minimum(np.maximum(at_s, 0.0), most_s)
