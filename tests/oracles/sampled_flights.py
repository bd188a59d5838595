"""An independent, slow prediction of flights: dense samples, with kinematics of its own.

Uses nothing of `recon.safety` or `recon.geo`. A vehicle's command is flown with the
figures of SAFETY.md (2.5 m/s2, a second to react, climbs of 3 m/s and sinks of 4 m/s at most), and
sampled at most `STEP_M` and `STEP_S` apart. Each sample has the times within which the vehicle
may be there, in two readings:

- `certain`: what a vehicle that flies as commanded does at that instant. Its time is uncertain by
  10 % of the elapsed time, and by 3 s (0.5 s now, growing by half a second for each).
- `possible`: all that may be counted besides. Paths are compared in pieces of 3 s, or of 10 % of
  the time when that is more: so any instant of a piece, any of its heights, and for a rounded
  corner half its reach times its sine beside the leg.

What the certain reading breaks must be refused; what the possible reading keeps must be approved.
"""

from dataclasses import dataclass
from math import ceil, hypot, sqrt

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

STEP_M = 2.0
STEP_S = 0.5
FOREVER_S = 1.0e6
ALL_HEIGHTS_M = 1.0e5

BRAKING_MPS2 = 2.5
VERTICAL_BRAKING_MPS2 = 2.0
REACTION_S = 1.0
CLIMB_MPS = 3.0
SINK_MPS = 4.0
STANDING_MPS = 0.5
TIME_UNCERTAINTY = 0.1
PIECE_S = 3.0
START_DELAY_S = 8.0

(EARLY_S, LATE_S, EAST, NORTH, LOW, HIGH, RADIUS, AT_S, CARRIED_M) = range(9)
"""Each sample's columns. CARRIED_M: how far its present velocity carries a vehicle off the way it
was ordered, before it has turned: no order's doing."""
Band = tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Aircraft:
    """A vehicle `age_s` ago: place (3,) and velocity (3,) as east, north, up, metres and m/s.

    `home_m` is (2,), `takeoff_m` the height of its takeoff point and `go_home_m` of its route home.
    """

    here_m: FloatArray
    velocity_mps: FloatArray
    home_m: FloatArray
    takeoff_m: float
    go_home_m: float | None
    goes_home: bool
    age_s: float


class Flight:
    """What a vehicle flies, sample after sample from its last telemetry."""

    def __init__(self, aircraft: Aircraft) -> None:
        self.aircraft = aircraft
        self.place_m: FloatArray = aircraft.here_m[:2].copy()
        self.low_m = self.high_m = float(aircraft.here_m[2])
        self.time_s = -aircraft.age_s
        self.begins_late_s = 0.0
        """How much later all of it may be flown."""
        self._certain: list[FloatArray] = []
        self._possible: list[FloatArray] = []

    @property
    def certain(self) -> FloatArray:
        """(N, 9) samples, in order of time as they are flown."""
        return np.concatenate(self._certain)

    @property
    def possible(self) -> FloatArray:
        """(N, 9) samples of the wider reading."""
        return np.concatenate(self._possible)

    def instants(
        self,
        at_s: FloatArray,
        places_m: FloatArray,
        bands_m: tuple[FloatArray, FloatArray],
        radius_m: FloatArray | float = 0.0,
        *,
        carried_m: FloatArray | float = 0.0,
        certain: bool = True,
        possible: bool = True,
    ) -> None:
        """Add samples: (N,) times, (N, 2) places, (N,) lowest and highest heights."""
        columns = [*places_m.T, *bands_m, np.broadcast_to(radius_m, at_s.shape)]
        if certain:
            times = [earliest_s(at_s), latest_s(at_s)]
            self._certain.append(_stacked(*times, *columns, at_s, carried_m))
        if possible:
            piece_s = np.maximum(PIECE_S, TIME_UNCERTAINTY * at_s) + STEP_S
            times = [earliest_s(at_s - piece_s), latest_s(at_s + piece_s)]
            columns[2:] = [
                _within(at_s, piece_s, columns[2], np.minimum),
                _within(at_s, piece_s, columns[3], np.maximum),
                _within(at_s, piece_s, columns[4], np.maximum),
            ]
            self._possible.append(_stacked(*times, *columns, at_s, 0.0))

    def goes(
        self, place_m: FloatArray, seconds: float, band_m: Band, beside_m: float = 0.0
    ) -> None:
        """Fly straight and evenly to a place, the heights changing to its end's."""
        start_m, far_m = self.place_m, float(np.hypot(*(place_m - self.place_m)))
        share = np.linspace(0.0, 1.0, 1 + max(1, ceil(far_m / STEP_M), ceil(seconds / STEP_S)))
        at_s = self.time_s + share * seconds
        places_m = start_m + share[:, np.newaxis] * (place_m - start_m)
        bands_m = (
            self.low_m + share * (band_m[0] - self.low_m),
            self.high_m + share * (band_m[1] - self.high_m),
        )
        self.instants(at_s, places_m, bands_m, possible=False)
        self.instants(at_s, places_m, bands_m, beside_m, certain=False)
        self.place_m, self.time_s = place_m, self.time_s + seconds
        self.low_m, self.high_m = band_m

    def stays(self, seconds: float = FOREVER_S, radius_m: float = 0.0) -> None:
        """Be anywhere within a disc, at any height of the present band, all this time."""
        times_s = np.array([self.time_s, min(self.time_s + seconds, FOREVER_S)])
        window_s = earliest_s(times_s)[0], latest_s(times_s)[1]
        disc = (*self.place_m, self.low_m, self.high_m, radius_m)
        sample = np.array([[*window_s, *disc, self.time_s, 0.0]])
        self._certain.append(sample)
        self._possible.append(sample)
        self.time_s = float(times_s[1])

    def grows(self, radius_m: float, seconds: float) -> None:
        """Be anywhere within a disc that grows to this radius."""
        at_s = np.linspace(0.0, 1.0, 1 + ceil(max(radius_m / STEP_M, seconds / STEP_S)))
        places_m = np.broadcast_to(self.place_m, (len(at_s), 2))
        bands_m = np.full_like(at_s, self.low_m), np.full_like(at_s, self.high_m)
        self.instants(self.time_s + at_s * seconds, places_m, bands_m, at_s * radius_m)
        self.time_s += seconds

    def widens(self, band_m: Band) -> None:
        """From here on be anywhere between the present heights and these."""
        self.low_m, self.high_m = min(self.low_m, band_m[0]), max(self.high_m, band_m[1])

    def brakes(self, reaction_s: float, velocity_mps: FloatArray | None = None) -> None:
        """Fly straight on for the reaction's time, then lose speed along and up."""
        velocity = self.aircraft.velocity_mps if velocity_mps is None else velocity_mps
        speed_mps, up_mps = hypot(*velocity[:2]), float(velocity[2])
        braking_s, settling_s = speed_mps / BRAKING_MPS2, abs(up_mps) / VERTICAL_BRAKING_MPS2
        lasts_s = reaction_s + max(braking_s, settling_s)
        count = 1 + max(1, ceil(lasts_s / STEP_S), ceil(speed_mps * lasts_s / STEP_M))
        gone_s = np.linspace(0.0, lasts_s, count)
        along_s = _slowed_s(gone_s, reaction_s, braking_s)
        places_m = self.place_m + along_s[:, np.newaxis] * velocity[:2]
        rise_m = up_mps * _slowed_s(gone_s, reaction_s, settling_s)
        self.instants(
            self.time_s + gone_s,
            places_m,
            (self.low_m + rise_m, self.high_m + rise_m),
            possible=False,
        )
        widest_m = (
            np.full(count, self.low_m + min(0.0, rise_m[-1])),
            np.full(count, self.high_m + max(0.0, rise_m[-1])),
        )
        self.instants(self.time_s + gone_s, places_m, widest_m, certain=False)
        self.place_m, self.time_s = places_m[-1], self.time_s + reaction_s + braking_s
        self.low_m, self.high_m = self.low_m + rise_m[-1], self.high_m + rise_m[-1]

    def flies_to(
        self, place_m: FloatArray, band_m: Band, speeds_mps: tuple[float, float, float]
    ) -> float:
        """Return how long a leg takes from one speed over another to a third, climb included."""
        far_m = float(np.hypot(*(place_m - self.place_m)))
        rise_s = max(
            (band_m[1] - self.high_m) / CLIMB_MPS, (self.low_m - band_m[0]) / SINK_MPS, 0.001
        )
        return max(leg_seconds(far_m, *speeds_mps), rise_s)

    def sinks(self) -> None:
        """Be anywhere between here and the ground for as long as a landing takes, then be down."""
        above_m = min(500.0, max(0.0, self.high_m - self.aircraft.takeoff_m))
        self.low_m = -ALL_HEIGHTS_M
        self.stays(above_m / 1.0 + 30.0)

    def towards_mps(self, place_m: FloatArray) -> float:
        """How fast it flew towards a place at its last telemetry."""
        ahead_m = place_m - self.place_m
        far_m = max(float(np.hypot(*ahead_m)), 1e-9)
        return max(0.0, float(ahead_m @ self.aircraft.velocity_mps[:2]) / far_m)


def leg_seconds(far_m: float, start_mps: float, speed_mps: float, end_mps: float) -> float:
    """Return how long a straight path takes: speed is gained, kept and lost at 2.5 m/s2."""
    if far_m < 1e-3:
        return 0.0
    peak_mps = sqrt((start_mps**2 + end_mps**2) / 2.0 + BRAKING_MPS2 * far_m)
    top_mps = min(speed_mps, peak_mps)
    gaining_s, losing_s = (abs(top_mps - mps) / BRAKING_MPS2 for mps in (start_mps, end_mps))
    changing_m = gaining_s * (top_mps + start_mps) / 2.0 + losing_s * (top_mps + end_mps) / 2.0
    return gaining_s + losing_s + max(0.0, far_m - changing_m) / top_mps


def earliest_s(at_s: FloatArray) -> FloatArray:
    """When a vehicle may be where it should be at a time, at the earliest."""
    return at_s - TIME_UNCERTAINTY * np.maximum(at_s, 0.0) - _slack_s(at_s)


def latest_s(at_s: FloatArray) -> FloatArray:
    """And at the latest."""
    return at_s + TIME_UNCERTAINTY * np.maximum(at_s, 0.0) + _slack_s(at_s)


def _stacked(*columns: FloatArray | float) -> FloatArray:
    return np.column_stack(np.broadcast_arrays(*columns))


def _slack_s(at_s: FloatArray) -> FloatArray:
    return np.minimum(3.0, np.maximum(0.5, 0.5 + at_s / 2.0))


def _slowed_s(gone_s: FloatArray, reaction_s: float, braking_s: float) -> FloatArray:
    """For how long at full speed a vehicle would have come as far."""
    braked_s = np.clip(gone_s - reaction_s, 0.0, braking_s)
    lost_s = braked_s**2 / (2.0 * braking_s) if braking_s > 0.0 else 0.0
    return np.minimum(gone_s, reaction_s) + braked_s - lost_s


def _within(
    at_s: FloatArray, piece_s: FloatArray, values: FloatArray, pick: np.ufunc
) -> FloatArray:
    """The lowest or highest that monotone values come to within a piece's time."""
    before = np.interp(at_s - piece_s, at_s, values)
    after = np.interp(at_s + piece_s, at_s, values)
    found: FloatArray = pick(before, after)
    return found
