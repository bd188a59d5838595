"""The poses of all photos at once: what links between them say, and what they state themselves.

A link tells the second photo's place and heading in the first one's picture; its length needs the
scale of the camera's pictures. Places are held by GNSS, headings by the source that was found.
Robust least squares (Gauss and Newton, weights after Huber): GNSS errors of neighbours are evened
out, those that all photos share remain.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

from recon.model.arrays import FloatArray, IntArray
from recon.product.registration.match import Link, Places

LINK_M, LINK_SHARE = 0.3, 0.015
"""Standard deviation of a link: of its features, and of its length by height and terrain."""
TURN_RAD = np.deg2rad(0.5)
SCALE_SHARE = 0.1
STEPS = 12
HUBER = 2.0
"""Standard deviations beyond which a link counts less."""


@dataclass(frozen=True, slots=True, eq=False)
class Stated:
    """What photos state: places (N,) with standard deviations (N,) in metres, headings (N,) with
    standard deviations in radians, heights above ground (N,), and the number of each one's
    camera (N,)."""

    places: Places
    place_m: FloatArray
    headings_rad: FloatArray
    heading_rad: FloatArray
    heights_m: FloatArray
    cameras: IntArray


@dataclass(frozen=True, slots=True, eq=False)
class Adjusted:
    """Places (N,), headings (N,), scales by camera, and the links' remaining residuals (L,)."""

    places: Places
    headings_rad: FloatArray
    scales: FloatArray
    residuals_m: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Poses:
    """What is solved for: places and headings (N,), logarithms of the cameras' scales."""

    places: Places
    headings_rad: FloatArray
    scales: FloatArray

    def changed(self, change: FloatArray) -> "_Poses":
        east, north, turned = change[: 3 * len(self.places)].reshape(-1, 3).T
        scales = self.scales + change[3 * len(self.places) :]
        return _Poses(self.places + east + 1j * north, self.headings_rad + turned, scales)


Term = tuple[IntArray, FloatArray]
"""Unknowns (N,) that N residuals depend on, and the slopes (N,)."""


class _Equations:
    """Residuals with their slopes, each divided by its standard deviation."""

    def __init__(self) -> None:
        self._values: list[FloatArray] = []
        self._terms: list[tuple[IntArray, IntArray, FloatArray]] = []
        self._count = 0

    def add(self, values: FloatArray, weights: FloatArray, *terms: Term) -> None:
        rows = self._count + np.arange(len(values))
        self._count += len(values)
        self._values.append(values * weights)
        self._terms += [(rows, unknowns, slopes * weights) for unknowns, slopes in terms]

    def solved(self, unknowns: int) -> FloatArray:
        """Return the change (U,) of the unknowns that leaves the least squares."""
        rows, columns, slopes = (np.concatenate(each) for each in zip(*self._terms, strict=True))
        design = csr_array((slopes, (rows, columns)), shape=(self._count, unknowns))
        normal = (design.T @ design).tocsc()
        found: FloatArray = spsolve(normal, -(design.T @ np.concatenate(self._values)))
        return found


def adjusted(stated: Stated, links: Sequence[Link]) -> Adjusted:
    """Return the poses that agree best with links and statements."""
    cameras = int(stated.cameras.max(initial=0)) + 1
    poses = _Poses(stated.places, stated.headings_rad, np.zeros(cameras))
    for _ in range(STEPS):
        equations = _Equations()
        if links:
            _add_links(equations, stated, poses, links)
        _add_statements(equations, stated, poses)
        poses = poses.changed(equations.solved(3 * len(stated.places) + cameras))
    off = np.abs(_moved(stated, poses, links)[1]) if links else np.zeros(0)
    return Adjusted(poses.places, poses.headings_rad, np.exp(poses.scales), off)


def _moved(stated: Stated, poses: _Poses, links: Sequence[Link]) -> tuple[Places, Places]:
    """Return the links' moves (L,) in metres, and how far the second photos are from their ends."""
    first, second = _ends(links)
    scale = np.exp(poses.scales[stated.cameras[first]])
    shift = np.array([each.shift for each in links])
    moved = scale * stated.heights_m[first] * shift * np.exp(-1j * poses.headings_rad[first])
    return moved, poses.places[second] - poses.places[first] - moved


def _ends(links: Sequence[Link]) -> tuple[IntArray, IntArray]:
    first, second = np.array([(each.first, each.second) for each in links]).T
    return first, second


def _add_links(equations: _Equations, stated: Stated, poses: _Poses, links: Sequence[Link]) -> None:
    first, second = _ends(links)
    moved, off = _moved(stated, poses, links)
    turn = np.angle(np.array([each.turn for each in links]))
    turned = _wrapped(poses.headings_rad[second] - poses.headings_rad[first] + turn)
    sigma_m = np.hypot(LINK_M, LINK_SHARE * np.abs(moved))
    weights = _huber(np.hypot(np.abs(off) / sigma_m, turned / TURN_RAD))
    one, scale = np.ones(len(links)), 3 * len(stated.places) + stated.cameras[first]
    for axis, part in enumerate((np.real, np.imag)):
        equations.add(
            part(off),
            weights / sigma_m,
            (3 * second + axis, one),
            (3 * first + axis, -one),
            (3 * first + 2, part(1j * moved)),
            (scale, -part(moved)),
        )
    equations.add(turned, weights / TURN_RAD, (3 * second + 2, one), (3 * first + 2, -one))


def _add_statements(equations: _Equations, stated: Stated, poses: _Poses) -> None:
    count, cameras = len(stated.places), len(poses.scales)
    first, one = 3 * np.arange(count), np.ones(count)
    off = poses.places - stated.places
    weights = _huber(np.abs(off) / stated.place_m) / stated.place_m
    equations.add(off.real, weights, (first, one))
    equations.add(off.imag, weights, (first + 1, one))
    turned = _wrapped(poses.headings_rad - stated.headings_rad)
    weights = _huber(turned / stated.heading_rad) / stated.heading_rad
    equations.add(turned, weights, (first + 2, one))
    scales = 3 * count + np.arange(cameras)
    equations.add(poses.scales, np.full(cameras, 1.0 / SCALE_SHARE), (scales, np.ones(cameras)))


def _huber(sigmas: FloatArray) -> FloatArray:
    """Return the weights of residuals in standard deviations."""
    found: FloatArray = np.sqrt(HUBER / np.maximum(np.abs(sigmas), HUBER))
    return found


def _wrapped(angles_rad: FloatArray) -> FloatArray:
    found: FloatArray = (angles_rad + np.pi) % (2.0 * np.pi) - np.pi
    return found
