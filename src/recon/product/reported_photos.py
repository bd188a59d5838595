"""Which report an app made of each photo: by index, with no search for the camera's clock.

An app counts photos, and a camera numbers its files; the two differ by a constant for a card. It is
the difference for which photos lie where their reports say. A photo without a report is dated by
the clock's offset that the others show.
"""

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from recon.model.arrays import IntArray
from recon.model.units import NS_PER_S
from recon.product.clock import ClockFit, Shots
from recon.product.reported_shots import ReportedShots

SAME_PLACE_M = 15.0
"""Greatest distance of a photo's stated place from its report's: both are the aircraft's, and a
camera without a fix of its own time writes one a second old."""
LEAST_SHARE = 0.8
"""Of the photos with a report of that index that must lie where it says."""
FEWEST = 3
CANDIDATES = 20
"""Differences that are compared: neighbours along a row are few metres apart."""
SIGMA_S = 0.3
"""Of a reported time: by what a link delays its text."""
_NUMBER = re.compile(r"(\d{3,9})(?=\D*$)")


def numbers_of(names: Sequence[str]) -> IntArray:
    """Return the numbers in file names (N,), or the files' order where one has none."""
    stems = [_NUMBER.search(name.rpartition(".")[0] or name) for name in names]
    if all(stems):
        return np.array([int(found[1]) for found in stems if found], dtype=np.int64)
    return np.arange(len(names), dtype=np.int64)


def reported_fits(
    shots: Shots,
    numbers: IntArray,
    reports: Sequence[ReportedShots],
    utc_ahead_ns: int,
) -> tuple[tuple[ClockFit, ...], IntArray]:
    """Return fits with the times that apps reported, and the photos (N,) in none of them."""
    left = np.arange(len(shots))
    fits = []
    for report in sorted(reports, key=lambda each: -len(each.index)):
        found = _matched(shots.chosen(left), numbers[left], report)
        if found is None:
            continue
        photos, rows, far_m = left[found[0]], found[1], found[2]
        at_ns = report.at_ns[rows]
        ahead_s = (at_ns + utc_ahead_ns - shots.clock_ns[photos]) / NS_PER_S
        offset_s = float(np.median(ahead_s)) - shots.step_s / 2.0
        fits.append(ClockFit(report.serial, offset_s, SIGMA_S, photos, far_m, at_ns))
        left = np.setdiff1d(left, photos)
    return tuple(fits), left


def _matched(
    shots: Shots, numbers: IntArray, report: ReportedShots
) -> tuple[IntArray, IntArray, float] | None:
    """Return the photos (N,) of a series, the rows (N,) of their reports and how far they are."""
    votes: Counter[int] = Counter()
    for number, east_m, north_m in zip(numbers, shots.east_m, shots.north_m, strict=True):
        near = np.hypot(report.east_m - east_m, report.north_m - north_m) <= SAME_PLACE_M
        votes.update((number - report.index[near]).tolist())
    best: tuple[IntArray, IntArray, float] | None = None
    for difference, _count in votes.most_common(CANDIDATES):
        found = _by_difference(shots, numbers - difference, report)
        if found is not None and (best is None or found[2] < best[2]):
            best = found
    return best


def _by_difference(
    shots: Shots, indices: IntArray, report: ReportedShots
) -> tuple[IntArray, IntArray, float] | None:
    rows = np.searchsorted(report.index, indices).clip(0, len(report.index) - 1)
    has_report = report.index[rows] == indices
    far_m = np.hypot(report.east_m[rows] - shots.east_m, report.north_m[rows] - shots.north_m)
    is_near = has_report & (far_m <= SAME_PLACE_M)
    placed = has_report & np.isfinite(far_m)
    if is_near.sum() < max(FEWEST, LEAST_SHARE * placed.sum()):
        return None
    photos = np.flatnonzero(is_near)
    return photos, rows[photos], float(np.median(far_m[photos]))
