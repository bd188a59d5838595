"""The fewest photos that show each cell in sun often enough.

This is set multicover, which is hard: a greedy list is made, photos that it does not need are taken
out, and parts of it are taken apart and made again as long as that saves photos. How far the list
may be from the shortest one is stated by the bound of the linear relaxation, over some of the
cells: what is needed for them is needed for all.
"""

import heapq
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np

from recon.model.arrays import BoolArray, IntArray

TRIES = 150
"""Attempts to shorten the list; each takes one neighbourhood apart."""
BOUND_CELLS = 1_500
BOUND_STEPS = 20_000
"""Most steps of the linear program: a hundred times what fields need."""
SEED = 15


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """Indices of the chosen photos, and the least number that any list needs."""

    photos: IntArray
    bound: int


def views_for(overlap: float) -> int:
    """Return how many photos show a place when both neighbours overlap by that share."""
    return max(1, round(1.0 / (1.0 - overlap) ** 2))


def choose(shows: Any, views: int) -> Choice:
    """Return photos so that each cell is shown `views` times, or as often as all of them do.

    `shows` (P, C) is not 0 where a photo shows a cell in sun.
    """
    by_photo: list[IntArray] = [
        shows.indices[a:b].astype(np.int64)
        for a, b in zip(shows.indptr, shows.indptr[1:], strict=False)
    ]
    needed = np.minimum(views, np.asarray(shows.sum(axis=0)).ravel()).astype(np.int64)
    is_chosen = np.zeros(len(by_photo), dtype=np.bool_)
    _complete(by_photo, needed, is_chosen)
    _without_spare(by_photo, needed, is_chosen)
    is_chosen = _shortened(shows, by_photo, needed, is_chosen)
    return Choice(np.flatnonzero(is_chosen), min(_bound(shows, needed), int(is_chosen.sum())))


def _counts(by_photo: list[IntArray], is_chosen: BoolArray, cells: int) -> IntArray:
    counts = np.zeros(cells, dtype=np.int64)
    for number in np.flatnonzero(is_chosen):
        counts[by_photo[number]] += 1
    return counts


def _complete(by_photo: list[IntArray], needed: IntArray, is_chosen: BoolArray) -> None:
    """Choose the photo that adds most until nothing is missing (changes `is_chosen`)."""
    missing = np.maximum(needed - _counts(by_photo, is_chosen, len(needed)), 0)
    # Gains only fall: one looked up before is a bound, and is worked out again when it is on top.
    heap = [
        (-int((missing[cells] > 0).sum()), number)
        for number, cells in enumerate(by_photo)
        if not is_chosen[number]
    ]
    heapq.heapify(heap)
    while heap and missing.any():
        _stale, number = heapq.heappop(heap)
        gain = int((missing[by_photo[number]] > 0).sum())
        if heap and gain < -heap[0][0]:
            heapq.heappush(heap, (-gain, number))
            continue
        is_chosen[number] = True
        cells = by_photo[number]
        missing[cells] = np.maximum(missing[cells] - 1, 0)


def _without_spare(by_photo: list[IntArray], needed: IntArray, is_chosen: BoolArray) -> None:
    """Take out what is not needed, the photos with fewest cells first (changes `is_chosen`)."""
    spare = _counts(by_photo, is_chosen, len(needed)) - needed
    for number in sorted(np.flatnonzero(is_chosen).tolist(), key=lambda n: len(by_photo[n])):
        cells = by_photo[number]
        if (spare[cells] > 0).all():
            is_chosen[number] = False
            spare[cells] -= 1


def _shortened(
    shows: Any, by_photo: list[IntArray], needed: IntArray, is_chosen: BoolArray
) -> BoolArray:
    random = np.random.default_rng(SEED)
    by_cell = shows.tocsc()
    for _ in range(TRIES):
        chosen = np.flatnonzero(is_chosen)
        if len(chosen) < 2:
            break
        # A photo and those that share cells with it, but not all: another order of the rest.
        cells = by_photo[int(random.choice(chosen))]
        near = np.unique(
            np.concatenate(
                [by_cell.indices[by_cell.indptr[c] : by_cell.indptr[c + 1]] for c in cells]
                or [np.zeros(0, dtype=np.int32)]
            )
        )
        taken = near[random.random(len(near)) < 0.7]
        tried = is_chosen.copy()
        tried[taken] = False
        _complete(by_photo, needed, tried)
        _without_spare(by_photo, needed, tried)
        if tried.sum() <= is_chosen.sum():
            is_chosen = tried
    return is_chosen


def _bound(shows: Any, needed: IntArray) -> int:
    """Return the least number of photos, by the linear relaxation over some of the cells."""
    # Imported here: it takes a tenth of the memory of a mosaic, which needs none of it.
    from scipy.optimize import linprog

    cells = np.flatnonzero(needed)
    if len(cells) == 0:
        return 0
    if len(cells) > BOUND_CELLS:
        cells = np.sort(np.random.default_rng(SEED).choice(cells, BOUND_CELLS, replace=False))
    rows = shows.T.tocsr()[cells]
    found: Any = linprog(
        np.ones(shows.shape[0]),
        A_ub=-rows,
        b_ub=-needed[cells].astype(np.float64),
        bounds=(0.0, 1.0),
        method="highs",
        options={"maxiter": BOUND_STEPS},
    )
    if found.status == 0:
        return ceil(float(found.fun) - 1e-6)
    # Not solved: all cells' needs together, over the most that one photo shows.
    most = int(np.diff(shows.indptr).max(initial=1))
    return ceil(int(needed.sum()) / max(most, 1))
