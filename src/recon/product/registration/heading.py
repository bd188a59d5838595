"""Which statement of the heading of a camera's pictures is right, by registered neighbours.

A run of neighbours, each linked to the next, is laid on the places that the photos state: that
turns and scales it. So the heading of each picture's top is measured, though by metres of GNSS over
the run's length. The statement that agrees with most of them is used for all photos of the camera,
plus a constant offset, plus one of its own for a flight line that is turned.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from recon.model.arrays import FloatArray, IntArray
from recon.product.headings import (
    APART_DEG,
    SOURCES,
    best_guess_deg,
    middle_deg,
    signed_deg,
    signed_degs,
)
from recon.product.registration.match import Link, Places
from recon.product.timing import TimedPhoto

AIM_DEG = 3.0
"""A heading that is surer is good: at a footprint's corner it is a few per cent of its size."""
TURNED_DEG = 5.0
"""A flight line off by more than GNSS can feign has an offset of its own."""
PLAIN_SHARE, OWN_DEG = 0.05, 2.0
"""Among sources that agree alike one without an offset is preferred: 20 degrees of offset count as
one of error, flight lines with offsets of their own as two."""
CONTRADICTS_DEG = 10.0
"""A source so far off the heading is named."""
MOST_COUNTED_DEG = 20.0
LARGEST_SCALE = 2.0
LARGEST_SCALE_SHARE = 0.2
"""Between runs of one camera: GNSS, and ground that is not level."""
SHORTEST_RUN = 0.1
"""In heights: over a shorter one GNSS tells no direction."""
WITHIN = 0.68
FEWEST_SCALED, SCALE_SHARE = 3, 0.05
"""Runs that tell a camera's scale, and how far off it is worth a warning."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """Neighbours that are linked one to the next: headings (N,) of their tops as measured, and
    `scale`: true ground in a picture over that by its height and field."""

    photos: IntArray
    headings_deg: FloatArray
    scale: float
    line: int


@dataclass(frozen=True, slots=True, eq=False)
class CameraHeading:
    """Which heading of a camera's pictures is used, and how good it is."""

    camera: str
    serial: str
    source: str
    offset_deg: float = 0.0
    """Added to what the source states."""
    error_deg: float = float("nan")
    """Two thirds of the measured headings lie within; NaN where none was measured."""
    pairs: int = 0
    """Of neighbours that were registered."""
    lines: Mapping[int, float] = field(default_factory=dict)
    """Offsets of the flight lines that have their own."""
    scale: float = 1.0
    """True ground in a picture over that by its height and field; 1 where too few tell."""
    turned: Mapping[str, int] = field(default_factory=dict)
    """Photos whose statement by a source contradicts the other sources."""
    off_deg: Mapping[str, float] = field(default_factory=dict)
    """How far off each source is: what it states minus the heading, the median."""

    @property
    def is_verified(self) -> bool:
        """Return whether the heading was measured, and within 3 degrees of the source's."""
        return self.error_deg <= AIM_DEG

    def __str__(self) -> str:
        name = f"{self.camera}: heading of the picture's top by {self.source}"
        if not self.pairs:
            return f"{name}, unverified"
        offset = f" {self.offset_deg:+.0f} degrees" if abs(self.offset_deg) >= 1.0 else ""
        return (
            f"{name}{offset}, within {self.error_deg:.1f} degrees by {self.pairs} pairs of "
            "neighbours"
        )

    @property
    def warnings(self) -> list[str]:
        """Return what contradicts the heading, in sentences."""
        if not self.pairs:
            return [
                f"{self.camera}: no two neighbouring photos could be registered: the heading of "
                f"the picture's top, by {self.source}, is unverified"
            ]
        found = [
            f"{self.camera}: {name} is {abs(off):.0f} degrees off the heading of the picture's top"
            for name, off in self.off_deg.items()
            if abs(off) > CONTRADICTS_DEG
        ]
        turned = [
            f"{off:+.0f}"
            for own in self.lines.values()
            if abs(off := signed_deg(own - self.offset_deg)) > CONTRADICTS_DEG
        ]
        if turned:
            found.append(
                f"{self.camera}: on some flight lines the picture's top is turned by "
                f"{', '.join(turned)} degrees against the others"
            )
        found += [
            f"{self.camera}: in {count} photos {name} contradicts the other sources and is not used"
            for name, count in self.turned.items()
        ]
        if abs(self.scale - 1.0) > SCALE_SHARE:
            found.append(
                f"{self.camera}: the pictures show {self.scale:.2f} times the ground that height "
                "and field of view state; that is used"
            )
        if not self.is_verified:
            found.append(
                f"{self.camera}: the heading of the picture's top is known to "
                f"{self.error_deg:.1f} degrees only"
            )
        return found


def run_of(
    photos: Sequence[TimedPhoto], places: Places, links: Sequence[Link], line: int
) -> Run | None:
    """Return a run of links, each from the photo where the one before ended, laid on the places.

    None where the run is too short, or not as long as the photos' places state.
    """
    chain, turns = [0j], [1.0 + 0j]
    for each in links:
        chain.append(chain[-1] + turns[-1] * each.shift)
        turns.append(turns[-1] * each.turn)
    numbers = np.array([links[0].first, *(each.second for each in links)])
    laid, stated = (each - each.mean() for each in (np.array(chain), places[numbers]))
    height_m = abs(photos[links[0].first].view.aim.height_m)
    length = float(np.sqrt((np.abs(laid) ** 2).sum()))
    if length < SHORTEST_RUN * len(links) or height_m == 0.0:
        return None
    # The similarity that lays the chain on the places with the least squares.
    factor = (laid.conj() * stated).sum() / length**2
    scale = float(abs(factor)) / height_m
    if not 1.0 / LARGEST_SCALE < scale < LARGEST_SCALE:
        return None
    headings = -np.angle(factor * np.array(turns), deg=True)
    return Run(numbers, headings, scale, line)


def heading_of(photos: Sequence[TimedPhoto], group: IntArray, runs: Sequence[Run]) -> CameraHeading:
    """Return the heading of one camera's pictures on one vehicle, a group of the photos."""
    runs = _alike(runs)
    one = photos[group[0]]
    camera, serial = one.photo.camera_name, one.serial
    if not runs:
        return CameraHeading(camera, serial, _likeliest([photos[index] for index in group]))
    numbers = np.concatenate([run.photos for run in runs])
    lines = np.concatenate([np.full(len(run.photos), run.line) for run in runs])
    measured = np.concatenate([run.headings_deg for run in runs])
    fits = {
        name: _fit(measured - stated, lines)
        for name in SOURCES
        if np.isfinite(stated := _stated(photos, numbers, name)).all()
    }
    source = min(fits, key=lambda name: fits[name].cost)
    best = fits[source]
    return CameraHeading(
        camera,
        serial,
        source,
        best.offset_deg,
        best.error_deg,
        sum(len(run.photos) - 1 for run in runs),
        best.lines,
        _scale(runs),
        off_deg={name: -fit.offset_deg for name, fit in fits.items()},
    )


def heading_deg(timed: TimedPhoto, line: int, found: CameraHeading) -> float:
    """Return the heading of a photo's top, on a flight line.

    A single photo may state a yaw that is turned: where the source contradicts the others, all
    freed of their offsets, these count.
    """
    freed = _freed_deg(timed, found)
    if not freed:
        return timed.view.aim.yaw_deg
    turn_deg = found.lines.get(line, found.offset_deg) - found.offset_deg
    return signed_deg(_agreed_deg(freed, found.source) + turn_deg)


def contradicts(timed: TimedPhoto, found: CameraHeading, name: str) -> bool:
    """Return whether what a source states of a photo contradicts the other sources."""
    freed = _freed_deg(timed, found)
    return (
        name in freed
        and abs(signed_deg(freed[name] - _agreed_deg(freed, found.source))) >= APART_DEG
    )


def _freed_deg(timed: TimedPhoto, found: CameraHeading) -> dict[str, float]:
    """Return what the sources state of a photo, without their offsets; none if not measured."""
    return {
        name: signed_deg(timed.headings_deg[name] - off)
        for name, off in found.off_deg.items()
        if name in timed.headings_deg
    }


def _agreed_deg(freed: Mapping[str, float], source: str) -> float:
    guess_deg = best_guess_deg(freed)
    likely_deg = freed.get(source, guess_deg)
    return likely_deg if abs(signed_deg(likely_deg - guess_deg)) < APART_DEG else guess_deg


def _alike(runs: Sequence[Run]) -> list[Run]:
    """Return the runs without those of another scale than most: similar ground, wrongly matched."""
    middle = float(np.median([run.scale for run in runs])) if runs else 1.0
    return [run for run in runs if abs(run.scale / middle - 1.0) < LARGEST_SCALE_SHARE]


def _scale(runs: Sequence[Run]) -> float:
    return float(np.median([run.scale for run in runs])) if len(runs) >= FEWEST_SCALED else 1.0


def _likeliest(photos: Sequence[TimedPhoto]) -> str:
    """Return the source that most photos' best guess is of."""
    counts = {
        name: sum(each.headings_deg.get(name) == each.view.aim.yaw_deg for each in photos)
        for name in SOURCES
    }
    return max(counts, key=lambda name: counts[name])


def _stated(photos: Sequence[TimedPhoto], numbers: Iterable[int], name: str) -> FloatArray:
    return np.array([photos[each].headings_deg.get(name, np.nan) for each in numbers])


@dataclass(frozen=True, slots=True)
class _Fit:
    offset_deg: float
    lines: Mapping[int, float]
    error_deg: float
    cost: float


def _fit(off_deg: FloatArray, lines: IntArray) -> _Fit:
    """Return the offsets of a source from what was measured, and how badly it agrees."""
    offset = middle_deg(off_deg)
    own: dict[int, float] = {}
    rest = signed_degs(off_deg - offset)
    for line in np.unique(lines).tolist():
        turned = middle_deg(off_deg[lines == line])
        if (lines == line).sum() > 2 and abs(signed_deg(turned - offset)) > TURNED_DEG:
            own[line] = turned
            rest[lines == line] = signed_degs(off_deg[lines == line] - turned)
    plain, left = (
        np.minimum(np.abs(each), MOST_COUNTED_DEG).mean() for each in (signed_degs(off_deg), rest)
    )
    own_share = np.isin(lines, list(own)).mean()
    error = float(np.quantile(np.abs(rest), WITHIN))
    return _Fit(offset, own, error, float(left + PLAIN_SHARE * plain + OWN_DEG * own_share))
