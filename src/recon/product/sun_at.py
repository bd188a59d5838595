"""The sun on the ground at any time of a flight, from the shade maps around it.

Shadows move on between two maps by tens of metres. So the maps of the minute before are moved
forward and those of the minute after are moved back, each along the shadows' velocity, and they are
mixed: the nearer in time and the surer, the more. A shadow is so seen over different ground, and
what ground misleads the detection counts less. The velocity is the forecast's as it was known half
a minute later: after the flight both sides of a moment are known.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import ceil, floor, hypot

import cv2
import numpy as np
import numpy.typing as npt

from recon.forecast import ForecastSettings
from recon.forecast.pooled_motion import pooled_motion, with_agreement
from recon.forecast.state import ForecastState
from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap
from recon.model.units import NS_PER_S
from recon.product.flight import FULL, UNKNOWN, KeptMap

FloatMap = npt.NDArray[np.float32]

LONGEST_S = 60.0
"""Longest time to a map: shadows change their shape within a minute or two."""
HALVES_S = 20.0
"""The confidence of a map that is moved on: at 10 s detection's errors are averaged less, at 40 s
shadows' shapes are others."""
EVERY_S = 10.0
"""Time between maps whose motion is estimated."""
LATER_S = 30.0
STANDS = (0.0, 0.0)
MARGIN = 2
"""Cells around a part: values between cells are of both."""

Part = tuple[slice, slice]
"""Rows and columns of a grid."""


@dataclass(frozen=True, slots=True, eq=False)
class Sunshine:
    """The sun on a grid at one moment; arrays are (R, C) float32, row 0 north.

    `transmittance` is 0 where nothing is known: there the confidence is 0.
    """

    transmittance: FloatMap
    confidence: FloatMap


@dataclass(slots=True)
class SunHistory:
    """The sun on a flight's grid by time."""

    grid: GroundGrid
    maps: Sequence[KeptMap]
    _times: list[int] = field(init=False)
    _motions: npt.NDArray[np.float64] = field(init=False)

    def __post_init__(self) -> None:
        self._times = [each.at_ns for each in self.maps]
        self._motions = _motions(self.grid, self.maps)

    def velocity_mps(self, at_ns: int) -> tuple[float, float]:
        """Return the shadows' velocity east and north; zero where it is not clear."""
        if not len(self._motions):
            return STANDS
        # What is known some time later is of the maps on both sides of the moment.
        later = np.searchsorted(self._motions[:, 0], at_ns + LATER_S * NS_PER_S)
        east_mps, north_mps = self._motions[min(int(later), len(self._motions) - 1), 1:].tolist()
        return east_mps, north_mps

    def around(self, at_ns: int, points_m: FloatArray) -> tuple[Sunshine, GroundGrid]:
        """Return the sun on the part of the grid around points (N, 2), east and north, and the
        part's own grid: the sun on a photo takes a fraction of that on the flight's ground."""
        part = _part(self.grid, points_m)
        rows, cols = part
        cell_m = self.grid.cell_m
        grid = replace(
            self.grid,
            west_m=self.grid.west_m + cols.start * cell_m,
            north_m=self.grid.north_m - rows.start * cell_m,
            rows=rows.stop - rows.start,
            cols=cols.stop - cols.start,
        )
        return self._on(at_ns, part), grid

    def at(self, at_ns: int) -> Sunshine:
        """Return the sun at a station time."""
        return self._on(at_ns, (slice(0, self.grid.rows), slice(0, self.grid.cols)))

    def _on(self, at_ns: int, part: Part) -> Sunshine:
        reach_ns = round(LONGEST_S * NS_PER_S)
        first = bisect_left(self._times, at_ns - reach_ns)
        last = bisect_right(self._times, at_ns + reach_ns)
        velocity = self.velocity_mps(at_ns)
        if velocity == STANDS:
            # Without a velocity only the maps on both sides tell about the moment.
            after = bisect_right(self._times, at_ns)
            first, last = max(first, after - 1), min(last, after + 1)
        shape = tuple(each.stop - each.start for each in part)
        total, weights, sure = np.zeros((3, *shape), dtype=np.float32)
        for number in range(first, last):
            gap_s = (at_ns - self._times[number]) / NS_PER_S
            sun, confidence = _moved(self.maps[number], part, velocity, gap_s, self.grid.cell_m)
            confidence *= np.float32(2.0 ** (-abs(gap_s) / HALVES_S))
            total += sun * confidence
            weights += confidence
            np.maximum(sure, confidence, out=sure)
        found = total / np.where(weights > 0.0, weights, np.float32(1.0))
        return Sunshine(found.astype(np.float32), sure)


def _part(grid: GroundGrid, points_m: FloatArray) -> Part:
    """Return the rows and columns of a grid around points, with `MARGIN` cells more; not none."""
    cols = (points_m[:, 0] - grid.west_m) / grid.cell_m
    rows = (grid.north_m - points_m[:, 1]) / grid.cell_m
    return (
        _within(float(rows.min()), float(rows.max()), grid.rows),
        _within(float(cols.min()), float(cols.max()), grid.cols),
    )


def _within(least: float, most: float, count: int) -> slice:
    first = min(max(floor(least) - MARGIN, 0), count - 1)
    return slice(first, max(min(ceil(most) + MARGIN, count), first + 1))


def _values(shade: KeptMap, part: Part) -> FloatMap:
    """Return of a part of a map (R, C, 3): whether it is known (0 or 1), its transmittance and its
    confidence there, 0 elsewhere."""
    kept = shade.sun[part]
    known = kept != UNKNOWN
    values = np.empty((*kept.shape, 3), dtype=np.float32)
    values[..., 0] = known
    values[..., 1] = kept * (known * np.float32(1.0 / FULL))
    values[..., 2] = shade.confidence[part] * (known * np.float32(1.0 / 255.0))
    return values


def _moved(
    shade: KeptMap, part: Part, velocity_mps: tuple[float, float], seconds: float, cell_m: float
) -> tuple[FloatMap, FloatMap]:
    """Return the transmittance of a map moved on, in a part of it, and its confidence: 0 where the
    map shows nothing."""
    right, down = (v * seconds / cell_m for v in (velocity_mps[0], -velocity_mps[1]))
    if hypot(right, down) < 0.01:
        still = _values(shade, part)
        return still[..., 1], still[..., 2]
    rows, cols = part
    map_rows, map_cols = shade.sun.shape
    source_rows = _within(rows.start - down, rows.stop - down, map_rows)
    source_cols = _within(cols.start - right, cols.stop - right, map_cols)
    move = np.array(
        [[1.0, 0.0, right + source_cols.start - cols.start],
         [0.0, 1.0, down + source_rows.start - rows.start]]
    )  # fmt: skip
    size = cols.stop - cols.start, rows.stop - rows.start
    values = _values(shade, (source_rows, source_cols))
    found = cv2.warpAffine(values, move, size, flags=cv2.INTER_LINEAR).astype(
        np.float32, copy=False
    )
    # Of cells between known and unknown ones the known part tells, where it is at least half.
    share = found[..., 0].copy()
    share[share < 0.5] = np.inf
    return found[..., 1] / share, found[..., 2] / share


def _motions(grid: GroundGrid, maps: Sequence[KeptMap]) -> npt.NDArray[np.float64]:
    """Return rows of time in ns, east and north velocity in m/s: zero while none is clear."""
    settings = replace(ForecastSettings(), keep_every_s=EVERY_S)
    state, found = ForecastState(), []
    for each in maps:
        kept = state.kept
        state = with_agreement(state, shade_map(each, grid), settings)
        if state.kept is kept:
            continue
        motion = pooled_motion(state, settings)
        velocity = STANDS if motion is None else (motion.east_mps, motion.north_mps)
        found.append((each.at_ns, *velocity))
    return np.array(found, dtype=np.float64).reshape(-1, 3)


def shade_map(shade: KeptMap, grid: GroundGrid) -> ShadeMap:
    """Return a kept map as the core's value."""
    valid = shade.sun != UNKNOWN
    transmittance = np.where(valid, shade.sun / np.float32(FULL), np.nan).astype(np.float32)
    confidence = (shade.confidence / np.float32(255.0)).astype(np.float32)
    return ShadeMap(grid, shade.at_ns, (), transmittance, valid, confidence, confidence)
