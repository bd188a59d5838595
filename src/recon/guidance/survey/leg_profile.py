"""The fewest waypoints along a straight leg that keep the aircraft near a wanted height.

An aircraft flies straight between waypoints, also vertically, and stops at each. Waypoints may
stand at multiples of a step along the leg, at the wanted height or a little off it. The fewest are
found by dynamic programming: from each of these vertices the slopes that keep within the limits
narrow with every metre (a funnel), and every vertex inside the funnel is one leg away.

Where the wanted height changes faster than the step can follow, as at the edge of a quarry, the
vertices stand as high as the highest wanted height within a step: the aircraft is then higher than
the limits, and not lower.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, dist

import numpy as np

from recon.guidance.survey.lattice import EastNorth
from recon.model.arrays import FloatArray

Vertex = tuple[EastNorth, float]
"""East-north metres, and the height there."""

FINEST_M = 0.5
"""Distance between two places at which a leg is compared with the wanted height."""

INSIDE = 0.8
"""Share of the limits for vertices off the wanted height."""

BETWEEN_M = 0.2
"""Margin to the limits, for what lies between two such places."""

OFF_COST, RAISED_COST = 0.01, 0.02
"""Cost, in waypoints, of one off the wanted height, so that it is taken only to save others."""

RAISED = 3
"""The kind of vertex that is as high as the highest wanted height within a step."""

STEEP_COST, LOW_COST = 1e3, 1e6
"""Cost of a leg of one step that may be too high, and of one that may be too low."""


@dataclass(frozen=True, slots=True)
class ProfileLimits:
    """How far a leg may be off the wanted height, and how it is divided."""

    below_m: float
    above_m: float
    climb_m: float
    """Climb between the ends of one leg, up or down."""
    step_m: float
    """Distance between waypoints, or down to half of it."""


def leg_profile(
    start_m: EastNorth,
    end_m: EastNorth,
    ends_up_m: tuple[float, float],
    wanted_m: Callable[[FloatArray], FloatArray],
    limits: ProfileLimits,
) -> tuple[Vertex, ...]:
    """Return the waypoints between the ends of a leg, which are at `ends_up_m`.

    `wanted_m` returns the heights (N,) wanted at (N, 2) places.
    """
    length_m = dist(start_m, end_m)
    steps = ceil(length_m / limits.step_m)
    if steps < 2:
        return ()
    each = ceil(length_m / steps / FINEST_M)
    share = np.linspace(0.0, 1.0, steps * each + 1)[:, np.newaxis]
    places = np.array(start_m) * (1.0 - share) + np.array(end_m) * share
    apart_m = length_m / (steps * each)
    chosen = _Vertices(wanted_m(places), ends_up_m, each, apart_m, limits).fewest()
    return tuple(((float(places[i * each][0]), float(places[i * each][1])), z) for i, z in chosen)


class _Vertices:
    """Vertices at every step of a leg, each at one of a few heights; and the best path to each."""

    def __init__(
        self,
        wanted_m: FloatArray,
        ends_up_m: tuple[float, float],
        each: int,
        apart_m: float,
        limits: ProfileLimits,
    ) -> None:
        self._wanted_m, self._each, self._apart_m = wanted_m, each, apart_m
        self._limits = limits
        at_m = wanted_m[::each]
        padded = np.pad(wanted_m, each, mode="edge")
        around = np.lib.stride_tricks.sliding_window_view(padded, 2 * each + 1)
        raised_m = around.max(axis=1)[::each]
        self._heights_m = np.column_stack(
            [at_m, at_m - INSIDE * limits.below_m, at_m + INSIDE * limits.above_m, raised_m]
        )
        self._price = np.tile([0.0, OFF_COST, OFF_COST, RAISED_COST], (len(at_m), 1))
        # Both ends are corners of other legs too: their heights are given.
        self._heights_m[[0, -1], 0] = ends_up_m
        self._price[[0, -1], 1:] = np.inf

    def fewest(self) -> list[tuple[int, float]]:
        """Return step and height of each vertex between the ends."""
        count, kinds = self._heights_m.shape
        cost = np.full((count, kinds), np.inf)
        cost[0, 0] = 0.0
        before = np.zeros((count, kinds), dtype=np.int64)
        for step in range(count - 1):
            for kind in np.flatnonzero(np.isfinite(cost[step])).tolist():
                to_it = cost[step, kind] + self._costs(step, kind)
                later = slice(step + 1, step + 1 + len(to_it))
                is_better = to_it < cost[later]
                cost[later] = np.where(is_better, to_it, cost[later])
                before[later] = np.where(is_better, step * kinds + kind, before[later])
            if step == 0 and cost[-1, 0] == 1.0:
                return []
        chosen: list[tuple[int, float]] = []
        at = int(before[-1, 0])
        while at:
            step, kind = divmod(at, kinds)
            chosen.append((step, float(self._heights_m[step, kind])))
            at = int(before[step, kind])
        return chosen[::-1]

    def _costs(self, step: int, kind: int) -> FloatArray:
        """What a leg costs from a vertex to each later one as far as any is open, (M, kinds)."""
        low, high = self._funnel(step, float(self._heights_m[step, kind]))
        rise_m = self._heights_m[step + 1 : step + 1 + len(low)] - self._heights_m[step, kind]
        far_m = self._apart_m * self._each * np.arange(1, len(low) + 1)[:, np.newaxis]
        slope = rise_m / far_m
        is_open = (slope >= low[:, np.newaxis]) & (slope <= high[:, np.newaxis])
        is_open &= np.abs(rise_m) <= self._limits.climb_m
        costs = np.where(is_open, 1.0, np.inf)
        # To the next step there is always a leg: one between raised vertices never lies too low.
        steep = np.full(len(is_open[0]), LOW_COST)
        if step == 0 or kind == RAISED:
            steep[0 if step + 2 == len(self._heights_m) else RAISED] = STEEP_COST
        costs[0] = np.where(is_open[0], 1.0, steep)
        price = self._price[step + 1 : step + 1 + len(low)]
        return np.asarray(costs + price)

    def _funnel(self, step: int, height_m: float) -> tuple[FloatArray, FloatArray]:
        """The least and the largest allowed slope to each later step, up to the first that no slope
        reaches; at least one step."""
        ahead_m = self._wanted_m[step * self._each + 1 :] - height_m
        far_m = self._apart_m * np.arange(1, len(ahead_m) + 1)
        below_m, above_m = self._limits.below_m - BETWEEN_M, self._limits.above_m - BETWEEN_M
        least = np.maximum.accumulate((ahead_m - below_m) / far_m)
        most = np.minimum.accumulate((ahead_m + above_m) / far_m)
        closed = np.flatnonzero(least > most)
        reach = len(ahead_m) if len(closed) == 0 else int(closed[0])
        steps = max(1, reach // self._each)
        at = self._each * np.arange(1, steps + 1) - 1
        return least[at], most[at]
