"""How high a survey above ground is wanted: a smooth surface over the site's elevation model.

The wanted height at a place is the larger of

- the height above the mean ground of `terrain_mean_m` around it: what a photo shows is the ground
  of a whole footprint, and a plant or one bad cell of the model must not move the aircraft;
- `least_clearance` of the height above the highest ground near it: what stands higher than a plant
  (a row of trees, a wall) raises the aircraft, and is reached at its height beforehand.

It is kept on a lattice of `terrain_cell_m`, bilinear between its nodes and level beyond its edges.
Heights are up of the site's frame: ellipsoidal, minus that of the frame's origin.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import ceil, floor

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import Surface, cell_centres_m, geo_from_enu, shape_of
from recon.guidance.survey.lattice import EastNorth
from recon.guidance.survey.leg_profile import ProfileLimits, Vertex, leg_profile
from recon.guidance.survey.settings import SurveySettings
from recon.model.airspace import ElevationModel, FlightLimits
from recon.model.arrays import BoolArray, FloatArray
from recon.model.geo import GroundGrid
from recon.model.survey import Survey
from recon.model.units import HECTARE_M2

ROUNDING_M = 1e-6

MOST_LEGS_KEPT = 4_096
"""Legs whose waypoints are remembered: a survey has up to some hundred rows and paths."""

LEAST_CLIMB_M = 5.0
"""Least climb along one leg where the site's height limits leave less: then the gate decides."""

STEEPEST = 0.5
"""Steepest slope from a corner at which the next step's waypoint is within the limits."""

CLIMB_SPARE_M = 1.0
"""Margin to the site's height limits along a leg."""


@dataclass(frozen=True, eq=False)
class Terrain:
    """The wanted heights of one survey, (rows, cols) at the centres of `grid`'s cells.

    Raises `ValueError` for other heights than one finite number for each cell.
    """

    grid: GroundGrid
    wanted_up_m: FloatArray
    limits: ProfileLimits
    lowest_above_ground_m: float
    highest_above_ground_m: float
    """Largest wanted height above the ground over the region."""

    def __post_init__(self) -> None:
        shape = self.grid.rows, self.grid.cols
        if self.wanted_up_m.shape != shape or not np.isfinite(self.wanted_up_m).all():
            raise ValueError(
                f"expected {shape} finite heights, got an array of {self.wanted_up_m.shape}"
            )

    def up_m(self, places_m: npt.ArrayLike) -> FloatArray:
        """Return the wanted heights (N,) at (N, 2) east-north places; beyond the lattice, that of
        its nearest edge."""
        places = np.asarray(places_m, dtype=np.float64).reshape(-1, 2)
        half_m = self.grid.cell_m / 2.0 + ROUNDING_M
        least = np.array([self.grid.west_m, self.grid.south_m]) + half_m
        most = np.array([self.grid.east_m, self.grid.north_m]) - half_m
        return self._surface.heights_m(np.clip(places, least, most))

    def up_at_m(self, place_m: EastNorth) -> float:
        """Return the wanted height at one place."""
        return float(self.up_m([place_m])[0])

    def corner_up_m(self, place_m: EastNorth) -> float:
        """Return the height of a corner: the wanted one, and near steep ground higher, so that no
        leg from it begins too low."""
        wanted_m = self.up_m(np.array(place_m) + self._disc_m)
        return float((wanted_m - STEEPEST * np.hypot(*self._disc_m.T)).max())

    def between(self, start_m: EastNorth, end_m: EastNorth) -> tuple[Vertex, ...]:
        """Return the waypoints needed along a straight leg, without its ends: the fewest.

        They are the same to and fro.
        """
        if end_m < start_m:
            return self.between(end_m, start_m)[::-1]
        leg = start_m, end_m
        found = self._profiles.get(leg)
        if found is None:
            ends_up_m = self.corner_up_m(start_m), self.corner_up_m(end_m)
            found = leg_profile(start_m, end_m, ends_up_m, self.up_m, self.limits)
            # Previews ask on other threads: what they look up may be gone a moment later.
            if len(self._profiles) >= MOST_LEGS_KEPT:
                self._profiles.clear()
            self._profiles[leg] = found
        return found

    @cached_property
    def _profiles(self) -> dict[tuple[EastNorth, EastNorth], tuple[Vertex, ...]]:
        """What was worked out already; no field, since it is no part of the value."""
        return {}

    @cached_property
    def highest_up_m(self) -> float:
        """The highest of all wanted heights."""
        return float(self.wanted_up_m.max())

    @property
    def is_near_height_limits(self) -> bool:
        """Whether legs would have to climb or sink more than the site's height limits leave."""
        relief_m = self.highest_up_m - float(self.wanted_up_m.min())
        return self.limits.climb_m <= LEAST_CLIMB_M < relief_m

    @cached_property
    def _disc_m(self) -> FloatArray:
        """Places up to a step of a leg away, (N, 2), the middle among them."""
        step_m = self.limits.step_m
        axis_m = np.linspace(-step_m, step_m, 11)
        square_m = np.stack(np.meshgrid(axis_m, axis_m), axis=-1).reshape(-1, 2)
        disc_m: FloatArray = square_m[np.hypot(*square_m.T) <= step_m]
        return disc_m

    @cached_property
    def _surface(self) -> Surface:
        return Surface(self.grid, self.wanted_up_m)


def terrain_over(
    survey: Survey,
    area: shapely.Geometry,
    elevation: ElevationModel | None,
    limits: FlightLimits,
    settings: SurveySettings,
) -> Terrain | str:
    """Return the wanted heights over all that a survey above ground may fly over, or why not."""
    if elevation is None:
        return (
            "a height above ground needs the site's elevation model: name one under [elevation] in "
            "site.toml, or give the height above takeoff"
        )
    grid = _lattice(area, elevation.grid, settings.terrain_cell_m)
    ground = _GroundAround(elevation, grid, settings)
    unknown = _unknown(survey, area, grid, ground.heights_at(_nodes(grid)))
    if unknown is not None:
        return unknown
    mean_m, highest_m = ground.mean_and_highest(grid)
    wanted_m = np.maximum(
        mean_m + survey.height_m, highest_m + settings.least_clearance * survey.height_m
    )
    above_m = wanted_m.ravel() - ground.heights_at(_nodes(grid))
    above_m = above_m[_inside(shape_of(survey.region), grid) & ~np.isnan(above_m)]
    return Terrain(
        grid,
        wanted_m,
        profile_limits(survey, limits, settings),
        float(above_m.min(initial=survey.height_m)),
        float(above_m.max(initial=survey.height_m)),
    )


def profile_limits(survey: Survey, limits: FlightLimits, settings: SurveySettings) -> ProfileLimits:
    """Return how the waypoints of a leg are chosen.

    The gate takes an aircraft to be anywhere between the heights of a leg's ends. So a leg climbs
    no more than leaves both the site's height limits.
    """
    below_m, above_m = settings.terrain_below_m, settings.terrain_above_m
    low_m = survey.height_m - below_m - limits.min_height_above_ground_m
    high_m = limits.max_height_above_ground_m - survey.height_m - above_m
    climb_m = max(min(low_m, high_m) - CLIMB_SPARE_M, LEAST_CLIMB_M)
    return ProfileLimits(below_m, above_m, climb_m, settings.terrain_step_m)


def ground_range_m(
    area: shapely.Geometry, elevation: ElevationModel | None, cell_m: float
) -> tuple[float, float] | None:
    """Return the lowest and the highest ground in an area, up of the frame; None: none is known."""
    if elevation is None:
        return None
    grid = _lattice(area, elevation.grid, cell_m)
    heights_m = ground_up_m(elevation, _nodes(grid)[_inside(area, grid)])
    known_m = heights_m[~np.isnan(heights_m)]
    return (float(known_m.min()), float(known_m.max())) if len(known_m) else None


def ground_up_m(elevation: ElevationModel, places_m: npt.ArrayLike) -> FloatArray:
    """Return the ground's heights (N,) at (N, 2) east-north places; NaN where unknown."""
    return Surface(elevation.grid, _up_m(elevation)).heights_m(places_m)


def _up_m(elevation: ElevationModel) -> FloatArray:
    origin = elevation.grid.frame.origin
    up_m: FloatArray = elevation.ellipsoid_height_m - origin.ellipsoid_height_m
    return up_m


def _lattice(area: shapely.Geometry, like: GroundGrid, cell_m: float) -> GroundGrid:
    """A grid whose cells' centres reach a cell beyond an area, at multiples of the cell's size."""
    west_m, south_m, east_m, north_m = shapely.bounds(area).tolist()
    left, top = floor(west_m / cell_m) - 1, ceil(north_m / cell_m) + 1
    cols, rows = ceil(east_m / cell_m) + 1 - left, top - floor(south_m / cell_m) + 1
    return GroundGrid(like.frame, left * cell_m, top * cell_m, cell_m, rows, cols)


def _nodes(grid: GroundGrid) -> FloatArray:
    """The centres of a grid's cells, (rows * cols, 2)."""
    east_m, north_m = np.meshgrid(*cell_centres_m(grid))
    return np.column_stack([east_m.ravel(), north_m.ravel()])


def _inside(area: shapely.Geometry, grid: GroundGrid) -> BoolArray:
    """Return which centres of a grid's cells lie in an area, (rows * cols,)."""
    inside: BoolArray = shapely.contains_xy(area, _nodes(grid))
    return inside


def _unknown(
    survey: Survey, area: shapely.Geometry, grid: GroundGrid, heights_m: FloatArray
) -> str | None:
    """Return a sentence for ground under the rows that the model does not know."""
    nodes = _nodes(grid)
    flown = _inside(area, grid)
    unknown = flown & np.isnan(heights_m)
    if not unknown.any():
        return None
    middle = nodes[unknown].mean(axis=0)
    nearest = nodes[unknown][np.hypot(*(nodes[unknown] - middle).T).argmin()]
    latitude, longitude, _ = geo_from_enu(grid.frame, np.array([[*nearest, 0.0]]))
    ha = grid.cell_m**2 / HECTARE_M2
    return (
        f"the site's elevation model has no height for {unknown.sum() * ha:.2f} ha of the "
        f"{flown.sum() * ha:.2f} ha that the survey {survey.name} flies over, around "
        f"{latitude[0]:.6f}, {longitude[0]:.6f}: use a model that covers it, move the region, or "
        "give the height above takeoff"
    )


class _GroundAround:
    """The part of an elevation model around a lattice, on cells no coarser than the lattice's.

    Cells that are finer stay as they are, so that no single one is missed.
    """

    def __init__(
        self, elevation: ElevationModel, lattice: GroundGrid, settings: SurveySettings
    ) -> None:
        self._model = Surface(elevation.grid, _up_m(elevation))
        cell_m = min(elevation.grid.cell_m, lattice.cell_m)
        mean = floor(settings.terrain_mean_m / cell_m + ROUNDING_M)
        # The mean of the highest ground is then nowhere lower than the ground within a cell.
        reach = mean + ceil(lattice.cell_m / cell_m)
        self._sizes = 2 * mean + 1, 2 * reach + 1
        self._grid = _part(elevation.grid, lattice, cell_m, (mean + reach + 1) * cell_m)
        heights_m = self._model.heights_m(_nodes(self._grid))
        self._heights_m = _filled(heights_m.reshape(self._grid.rows, self._grid.cols))

    def heights_at(self, places_m: FloatArray) -> FloatArray:
        """The model's own heights (N,), NaN where unknown."""
        return self._model.heights_m(places_m)

    def mean_and_highest(self, lattice: GroundGrid) -> tuple[FloatArray, FloatArray]:
        """The mean ground around each node of a lattice, and the mean of the highest near it."""
        from scipy import ndimage

        mean, highest = self._sizes
        means_m = ndimage.uniform_filter(self._heights_m, mean, mode="nearest")
        tops_m = ndimage.maximum_filter(self._heights_m, highest, mode="nearest")
        tops_m = ndimage.uniform_filter(tops_m, mean, mode="nearest")
        nodes, shape = _nodes(lattice), (lattice.rows, lattice.cols)
        mean_m, highest_m = (
            Surface(self._grid, each).heights_m(nodes).reshape(shape) for each in (means_m, tops_m)
        )
        return mean_m, highest_m


def _part(model: GroundGrid, lattice: GroundGrid, cell_m: float, around_m: float) -> GroundGrid:
    """Return the cells of a model, or finer ones, that reach around a lattice."""
    left = floor((lattice.west_m - around_m - model.west_m) / cell_m)
    top = floor((model.north_m - lattice.north_m - around_m) / cell_m)
    cols = ceil((lattice.east_m + around_m - model.west_m) / cell_m) - left
    rows = ceil((model.north_m - lattice.south_m + around_m) / cell_m) - top
    west_m, north_m = model.west_m + left * cell_m, model.north_m - top * cell_m
    return GroundGrid(model.frame, west_m, north_m, cell_m, rows, cols)


def _filled(heights_m: FloatArray) -> FloatArray:
    """Heights with the nearest known one where none is known; 0 without any."""
    is_unknown = np.isnan(heights_m)
    if is_unknown.all():
        return np.zeros_like(heights_m)
    if not is_unknown.any():
        return heights_m
    from scipy import ndimage

    nearest = ndimage.distance_transform_edt(
        is_unknown, return_distances=False, return_indices=True
    )
    filled: FloatArray = heights_m[tuple(nearest)]
    return filled


def vertices_of(
    corners_m: Sequence[EastNorth], terrain: Terrain
) -> tuple[tuple[EastNorth, ...], tuple[float, ...]]:
    """Return a track's corners with the waypoints needed between them, and the height at each."""
    places: list[EastNorth] = []
    up_m: list[float] = []
    for index, corner_m in enumerate(corners_m):
        if index:
            for place_m, height_m in terrain.between(corners_m[index - 1], corner_m):
                places.append(place_m)
                up_m.append(height_m)
        places.append(corner_m)
        up_m.append(terrain.corner_up_m(corner_m))
    return tuple(places), tuple(up_m)
