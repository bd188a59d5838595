"""Photos registered to each other: which way each looks, its place, and its field of view."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import pairwise
from math import degrees

import numpy as np
from scipy.spatial import KDTree

from recon.model.arrays import FloatArray, IntArray
from recon.product.footprint import PhotoView
from recon.product.headings import AIRCRAFT, GIMBAL, signed_deg
from recon.product.progress import Over, plainly
from recon.product.registration.adjustment import Adjusted, Stated, adjusted
from recon.product.registration.heading import (
    CameraHeading,
    Run,
    contradicts,
    heading_deg,
    heading_of,
    run_of,
)
from recon.product.registration.lines import (
    LEAST_COMMON,
    FlightLine,
    flight_lines,
    places_of,
    short_side_m,
)
from recon.product.registration.match import Features, GreyImage, Link, features_of, link
from recon.product.timing import TimedPhoto

Read = Callable[[TimedPhoto], GreyImage | None]
"""Reads a photo's grey picture; None where it cannot be read."""

MOST_READ = 100
"""Photos of a flight that are read to find its cameras' headings."""
FEWEST_OF_LINE, MOST_OF_LINE = 2, 4
ACROSS = 2
"""Photos of other flight lines that each photo is linked to."""
FARTHEST_OFF_M, FARTHEST_OFF_SHARE = 12.0, 0.3
"""A link that is so far off what two photos state, and by a share of it, is of similar ground."""
PLACE_M = 1.0
"""Standard deviation of a photo's place where it states none: GNSS of neighbours errs alike."""
LEAST_PLACE_M = 0.02
KEPT_SHARE = 0.9
HEADING_DEG, UNVERIFIED_DEG = 0.3, 10.0
"""Standard deviations of a heading beside its stated error, and of one not verified."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoRegistration:
    """The photos' poses after registration."""

    views: tuple[PhotoView, ...]
    """Of each photo, in the order given. The scale of a camera's pictures is in their heights above
    the ground: height, field of view and terrain cannot be told apart."""
    headings: tuple[CameraHeading, ...]
    """Of each camera on each vehicle."""
    residual_m: float
    """Of the links between photos, the root mean square without the worst tenth; NaN without
    links."""
    links: int

    @property
    def warnings(self) -> list[str]:
        """Return what contradicts the photos' statements, in sentences."""
        return [text for each in self.headings for text in each.warnings]


@dataclass(frozen=True, slots=True, eq=False)
class _Group:
    """One camera's photos on one vehicle, by index in the order of time, and their flight lines."""

    photos: IntArray
    lines: tuple[FlightLine, ...]


Links = dict[tuple[int, int], Link]


def with_headings(
    photos: Sequence[TimedPhoto], read: Read, over: Over = plainly, workers: int = 1
) -> tuple[list[TimedPhoto], list[CameraHeading]]:
    """Return the photos with the headings that their pictures show, and how those were found.

    A few neighbours of each flight line are registered. `read` is called in so many threads;
    `over` shows progress over the photos that are read.
    """
    groups = _groups(photos)
    lines = sum(len(line.steps) > 1 for group in groups for line in group.lines)
    each = min(MOST_OF_LINE, max(FEWEST_OF_LINE, MOST_READ // max(lines, 1)))
    runs = [[line.middle(each) for line in group.lines] for group in groups]
    all_runs = [run for of_group in runs for run in of_group if len(run) > 1]
    read_runs = _spread(all_runs, MOST_READ // each)
    links = _links(photos, _pairs(read_runs), read, over, workers)
    found = [
        _heading(photos, group, [[run] for run in of_group], links)
        for group, of_group in zip(groups, runs, strict=True)
    ]
    headings, found = _headings_deg(photos, groups, found)
    scales = np.array([each.scale for each in found])[_numbers(groups, len(photos))]
    turned = [
        replace(each, view=_posed(each.view, heading, scale))
        for each, heading, scale in zip(photos, headings.tolist(), scales.tolist(), strict=True)
    ]
    return turned, found


def register(
    photos: Sequence[TimedPhoto], read: Read, over: Over = plainly, workers: int = 1
) -> PhotoRegistration:
    """Return the poses of all photos, registered to their neighbours along and across lines.

    Each photo is read once: `read` is called in so many threads; `over` shows progress. Errors of
    GNSS that all photos share remain.
    """
    groups = _groups(photos)
    runs = [[line.runs() for line in group.lines] for group in groups]
    along = _pairs(run for group in runs for line in group for run in line)
    wanted = along | _pairs(group.photos for group in groups) | _across(photos, groups)
    links = _links(photos, wanted, read, over, workers)
    found = [
        _heading(photos, group, of_group, links)
        for group, of_group in zip(groups, runs, strict=True)
    ]
    headings, found = _headings_deg(photos, groups, found)
    poses, links_used = _adjusted(photos, groups, found, headings, links)
    numbers = _numbers(groups, len(photos))
    views = tuple(
        _posed(timed.view, degrees(heading_rad), float(poses.scales[number]), place)
        for timed, place, heading_rad, number in zip(
            photos, poses.places.tolist(), poses.headings_rad.tolist(), numbers, strict=True
        )
    )
    scaled = tuple(
        replace(each, scale=float(scale)) for each, scale in zip(found, poses.scales, strict=True)
    )
    return PhotoRegistration(views, scaled, _typical_m(poses.residuals_m), links_used)


def _groups(photos: Sequence[TimedPhoto]) -> list[_Group]:
    by_camera: dict[tuple[tuple[str, str, str], str], list[int]] = {}
    for index, each in enumerate(photos):
        by_camera.setdefault((each.photo.camera, each.serial), []).append(index)
    groups = []
    for indices in by_camera.values():
        indices.sort(key=lambda index: photos[index].at_ns)
        of_camera = np.array(indices)
        lines = tuple(
            FlightLine(of_camera[line.photos], of_camera[line.steps])
            for line in flight_lines([photos[index] for index in indices])
        )
        groups.append(_Group(of_camera, lines))
    return groups


def _spread(runs: Sequence[IntArray], most: int) -> list[IntArray]:
    """Return so many of the runs at most, from the whole flight."""
    chosen = np.linspace(0, len(runs) - 1, min(len(runs), most)).astype(np.int64)
    return [runs[number] for number in chosen.tolist()]


def _pairs(runs: Iterable[IntArray]) -> set[tuple[int, int]]:
    return {pair for run in runs for pair in pairwise(run.tolist())}


def _across(photos: Sequence[TimedPhoto], groups: Sequence[_Group]) -> set[tuple[int, int]]:
    """Return each photo with the nearest ones of other flight lines that show the same ground."""
    places = places_of(photos)
    line_of = np.zeros(len(photos), dtype=np.int64)
    for number, line in enumerate(line for group in groups for line in group.lines):
        line_of[line.photos] = number
    tree = KDTree(np.column_stack([places.real, places.imag]))
    found: set[tuple[int, int]] = set()
    for index, timed in enumerate(photos):
        reach_m = (1.0 - LEAST_COMMON) * short_side_m(timed)
        near = np.array(tree.query_ball_point([places[index].real, places[index].imag], reach_m))
        others = near[line_of[near] != line_of[index]]
        nearest = others[np.argsort(np.abs(places[others] - places[index]))][:ACROSS]
        found |= {(min(index, other), max(index, other)) for other in nearest.tolist()}
    return found


def _links(
    photos: Sequence[TimedPhoto],
    pairs: Iterable[tuple[int, int]],
    read: Read,
    over: Over,
    workers: int,
) -> Links:
    """Return the links of those pairs of photos that could be registered."""
    ordered = sorted(pairs)
    needed = sorted({index for pair in ordered for index in pair})

    def features(timed: TimedPhoto) -> Features | None:
        grey = read(timed)
        return None if grey is None else features_of(grey, timed.view)

    def linked(pair: tuple[int, int]) -> Link | None:
        first, second = (found[index] for index in pair)
        return None if first is None or second is None else link(first, second, pair)

    with ThreadPoolExecutor(workers) as pool:
        wanted = [photos[index] for index in needed]
        results = pool.map(features, wanted)
        read_ones = over(results, "registering photos", len(wanted))
        found = dict(zip(needed, read_ones, strict=True))
        links = [each for each in pool.map(linked, ordered) if each is not None]
    return {(each.first, each.second): each for each in links}


def _heading(
    photos: Sequence[TimedPhoto],
    group: _Group,
    runs: Sequence[Sequence[IntArray]],
    links: Links,
) -> CameraHeading:
    """Return a camera's heading from the runs of each of its flight lines."""
    places = places_of(photos)
    found: list[Run] = []
    for number, of_line in enumerate(runs):
        for chain in (chain for run in of_line for chain in _chains(run, links)):
            laid = run_of(photos, places, chain, number)
            found += [] if laid is None else [laid]
    return heading_of(photos, group.photos, found)


def _chains(run: IntArray, links: Links) -> list[list[Link]]:
    """Return a run's links, parted where two neighbours have none."""
    chains: list[list[Link]] = [[]]
    for pair in pairwise(run.tolist()):
        if pair in links:
            chains[-1].append(links[pair])
        elif chains[-1]:
            chains.append([])
    return [chain for chain in chains if chain]


def _headings_deg(
    photos: Sequence[TimedPhoto], groups: Sequence[_Group], found: Sequence[CameraHeading]
) -> tuple[FloatArray, list[CameraHeading]]:
    """Return the photos' headings, and what was found with the number of those turned."""
    headings, counted = np.zeros(len(photos)), list[CameraHeading]()
    for group, heading in zip(groups, found, strict=True):
        for number, line in enumerate(group.lines):
            for index in line.photos.tolist():
                headings[index] = heading_deg(photos[index], number, heading)
        timed = [photos[index] for index in group.photos.tolist()]
        turned = {
            name: sum(contradicts(each, heading, name) for each in timed)
            for name in (GIMBAL, AIRCRAFT)
        }
        counted.append(replace(heading, turned={n: each for n, each in turned.items() if each}))
    return headings, counted


def _numbers(groups: Sequence[_Group], count: int) -> IntArray:
    """Return the number of each photo's group."""
    numbers = np.zeros(count, dtype=np.int64)
    for number, group in enumerate(groups):
        numbers[group.photos] = number
    return numbers


def _adjusted(
    photos: Sequence[TimedPhoto],
    groups: Sequence[_Group],
    found: Sequence[CameraHeading],
    headings_deg: FloatArray,
    links: Links,
) -> tuple[Adjusted, int]:
    """Return the adjusted poses, and how many links they rest on."""
    numbers = _numbers(groups, len(photos))
    errors_deg = np.array([e.error_deg + HEADING_DEG if e.pairs else UNVERIFIED_DEG for e in found])
    stated = Stated(
        places_of(photos),
        np.array([_place_m(each) for each in photos]),
        np.deg2rad(headings_deg),
        np.deg2rad(errors_deg)[numbers],
        np.array([abs(each.view.aim.height_m) for each in photos]),
        numbers,
    )
    scales = np.array([each.scale for each in found])[numbers]
    used = [each for each in links.values() if _is_likely(each, stated, scales)]
    return adjusted(stated, used), len(used)


def _place_m(timed: TimedPhoto) -> float:
    stated_m = timed.photo.horizontal_sigma_m
    return PLACE_M if stated_m is None else max(stated_m, LEAST_PLACE_M)


def _is_likely(link: Link, stated: Stated, scales: FloatArray) -> bool:
    """Return whether a link agrees roughly with what the photos state."""
    base = stated.places[link.second] - stated.places[link.first]
    height_m = stated.heights_m[link.first] * scales[link.first]
    moved = height_m * link.shift * np.exp(-1j * stated.headings_rad[link.first])
    return bool(abs(moved - base) < FARTHEST_OFF_M + FARTHEST_OFF_SHARE * abs(base))


def _posed(
    view: PhotoView, heading_deg: float, scale: float, place: complex | None = None
) -> PhotoView:
    """Return a view with another heading, place, and height by a factor of the ground shown."""
    aim = replace(view.aim, yaw_deg=signed_deg(heading_deg), height_m=scale * view.aim.height_m)
    if place is not None:
        aim = replace(aim, east_m=place.real, north_m=place.imag)
    return replace(view, aim=aim)


def _typical_m(residuals_m: FloatArray) -> float:
    if not len(residuals_m):
        return float("nan")
    kept = np.sort(residuals_m)[: max(1, round(KEPT_SHARE * len(residuals_m)))]
    return float(np.sqrt((kept**2).mean()))
