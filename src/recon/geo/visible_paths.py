"""The shortest paths around corners: Dijkstra's search on a visibility graph."""

from collections.abc import Callable, Iterator
from heapq import heappop, heappush
from math import dist

import numpy as np

from recon.model.arrays import BoolArray, FloatArray

Place = tuple[float, float]
"""East and north, metres."""


class VisiblePaths:
    """The shortest paths between places, straight or turning at corners; what it found it keeps."""

    def __init__(self, corners_m: FloatArray, is_open: Callable[[FloatArray], BoolArray]) -> None:
        """Take corners (N, 2), and what tells which of legs (N, 2, 2) may be flown, (N,)."""
        self._corners = corners_m
        self._places: list[Place] = [(float(east), float(north)) for east, north in corners_m]
        self._is_open = is_open
        self._legs: dict[int, list[tuple[int, float]]] = {}
        self._sees = np.zeros((len(corners_m), len(corners_m)), dtype=np.bool_)
        """Which corners see each other, as far as it was asked: of those in `_legs`, all."""

    def between(self, start_m: Place, end_m: Place) -> tuple[Place, ...] | None:
        """Return the corners on the way, none where it is straight; None where there is no path.

        Of paths of one length it is that over the corner of the lowest number.
        """
        if self._is_open(np.array([[start_m, end_m]]))[0]:
            return ()
        end, sees_end = len(self._corners), self._are_seen(end_m)
        before: dict[int, int] = {}
        waiting = [(far_m, corner, -1) for corner, far_m in self._visible_from(start_m)]
        waiting.sort()
        while waiting:
            far_m, node, previous = heappop(waiting)
            if node == end:
                return tuple(self._back(previous, before))[::-1]
            if node in before:
                continue
            before[node] = previous
            if sees_end[node]:
                heappush(waiting, (far_m + dist(self._places[node], end_m), end, node))
            for neighbour, leg_m in self._neighbours(node):
                if neighbour not in before:
                    heappush(waiting, (far_m + leg_m, neighbour, node))
        return None

    def _back(self, corner: int, before: dict[int, int]) -> Iterator[Place]:
        while corner >= 0:
            yield self._places[corner]
            corner = before[corner]

    def _neighbours(self, corner: int) -> list[tuple[int, float]]:
        if corner not in self._legs:
            # A leg that was asked for from its other end is known.
            is_asked = np.ones(len(self._corners), dtype=np.bool_)
            is_asked[list(self._legs)] = False
            found = self._are_seen(self._places[corner], is_asked)
            self._sees[corner, is_asked] = self._sees[is_asked, corner] = found
            self._legs[corner] = self._lengths(self._sees[corner], self._places[corner])
        return self._legs[corner]

    def _visible_from(self, place_m: Place) -> list[tuple[int, float]]:
        return self._lengths(self._are_seen(place_m), place_m)

    def _lengths(self, seen: BoolArray, place_m: Place) -> list[tuple[int, float]]:
        corners = np.flatnonzero(seen)
        return [(int(each), dist(self._places[each], place_m)) for each in corners]

    def _are_seen(self, place_m: Place, which: BoolArray | slice = slice(None)) -> BoolArray:
        """Return which of these corners see a place."""
        corners_m = self._corners[which]
        ends = np.broadcast_to(np.array(place_m), corners_m.shape)
        return self._is_open(np.stack([corners_m, ends], axis=1))
