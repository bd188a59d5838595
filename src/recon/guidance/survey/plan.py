"""Survey feasibility checks with operator-readable reasons, and the plan: rows and cells."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import dist, hypot

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import region_fault, shape_of
from recon.guidance.survey.cells import CoverageCells, cells_over
from recon.guidance.survey.imaging import longest_photo_m
from recon.guidance.survey.lattice import EastNorth, RowLattice, Swath, swath_of
from recon.guidance.survey.missions import Track, track_of
from recon.guidance.survey.region_paths import RegionPaths
from recon.guidance.survey.route import Route, RowLeg
from recon.guidance.survey.rows import (
    MOST_ROWS,
    Piece,
    best_bearing_deg,
    lattice_again,
    lattice_over,
    row_pieces,
)
from recon.guidance.survey.settings import DEFAULT, SurveySettings
from recon.guidance.survey.terrain import Terrain, ground_range_m, terrain_over
from recon.model.airspace import Airspace, ElevationModel, FlightLimits, Region, ZoneKind
from recon.model.arrays import BoolArray
from recon.model.command import Refusal
from recon.model.geo import LocalFrame
from recon.model.mission import DJI
from recon.model.survey import Survey
from recon.model.units import is_finite

MOST_CELLS = 4_000_000
"""400 ha in cells of 1 m: more takes too much memory."""

SLOWEST_MPS = 0.5
"""Slowest speed along rows: a survey this slow takes all day."""

HEIGHT_FAULT = (
    "give one height: either height_above_takeoff_m, above each vehicle's takeoff point, or "
    "height_above_ground_m, above the ground of the site's elevation model"
)


def survey_fault(survey: Survey) -> str | None:
    """Return why a survey cannot be flown and what to change; None when it can."""
    return next(_faults(survey), None)


def _faults(survey: Survey) -> Iterator[str]:
    fault = region_fault(survey.region)
    if fault is not None:
        yield f"the region {survey.name} cannot be surveyed: {fault}"
        return
    yield from _number_faults(survey)
    yield from _overlap_faults(survey)
    yield from _size_faults(survey)


def _number_faults(survey: Survey) -> Iterator[str]:
    camera = survey.camera
    if (survey.height_above_takeoff_m is None) == (survey.height_above_ground_m is None):
        yield HEIGHT_FAULT
        return
    numbers = (
        ("height", survey.height_m, 1.0, 500.0, " m"),
        ("speed", survey.speed_mps, SLOWEST_MPS, DJI.max_speed_mps, " m/s"),
        ("camera's field of view across", camera.across_deg, 5.0, 150.0, " degrees"),
        ("camera's field of view along", camera.along_deg, 5.0, 150.0, " degrees"),
        ("camera's interval", camera.interval_s, 0.1, 60.0, " s"),
        ("front overlap", survey.front_overlap, 0.0, 0.95, ""),
        ("side overlap", survey.side_overlap, 0.0, 0.95, ""),
        ("cell", survey.cell_m, 0.5, 50.0, " m"),
        ("row bearing", survey.row_bearing_deg or 0.0, -360.0, 360.0, " degrees"),
    )
    for name, value, least, most, unit in numbers:
        if not (is_finite(value) and least <= value <= most):
            yield f"the {name} is {value:g}{unit}: {least:g} to {most:g}{unit} are possible"
    budget = survey.budget
    if budget.rounds < 1:
        yield f"{budget.rounds} rounds are allowed: at least 1 is needed"
    for name, limit, unit in (("time", budget.time_s, "s"), ("distance", budget.flown_m, "m")):
        if limit is not None and not (is_finite(limit) and limit > 0.0):
            yield f"the {name} budget is {limit:g} {unit}: expected more than 0, or none"


def _overlap_faults(survey: Survey) -> Iterator[str]:
    camera, height_m = survey.camera, survey.height_m
    slack_m = 2.0 * DEFAULT.place_slack_m
    across_m, along_m = camera.across_m(height_m), camera.along_m(height_m)
    if min(across_m, along_m) < 2.0 * slack_m:
        yield (
            f"from {height_m:g} m a photo shows {across_m:.1f} x {along_m:.1f} m, too little "
            f"beside the {slack_m:g} m that a drone may be off its place: fly higher"
        )
        return
    photo_m = survey.speed_mps * camera.interval_s
    longest_m = longest_photo_m(
        camera, height_m, survey.front_overlap, stops_in_rows=survey.is_above_ground
    )
    if photo_m > longest_m * (1.0 + 1e-9):
        yield (
            f"at {survey.speed_mps:g} m/s a photo every {camera.interval_s:g} s comes every "
            f"{photo_m:.1f} m; {survey.front_overlap:.0%} front overlap from {height_m:g} m needs "
            f"one every {longest_m:.1f} m: fly at {longest_m / camera.interval_s:.1f} m/s at most"
        )


def _size_faults(survey: Survey) -> Iterator[str]:
    outline_m = survey.region.outline_m
    wide_m, high_m = outline_m.max(axis=0) - outline_m.min(axis=0)
    if wide_m * high_m / survey.cell_m**2 > MOST_CELLS:
        yield (
            f"the region is {wide_m / 1000:.1f} x {high_m / 1000:.1f} km: too large for cells of "
            f"{survey.cell_m:g} m: divide it"
        )
    area_m2 = shape_of(survey.region).area
    if area_m2 < survey.cell_m**2:
        yield (
            f"the region {survey.name} is {area_m2:.2g} m², less than a cell of "
            f"{survey.cell_m**2:g} m²: draw its outline again"
        )
    spacing_m = swath_of(survey, DEFAULT).widest_spacing_m
    if max(wide_m, high_m) / spacing_m > MOST_ROWS:
        yield f"rows {spacing_m:.1f} m apart are more than {MOST_ROWS} in this region"


RULE = "survey"


@dataclass(frozen=True, slots=True, eq=False)
class SurveySurroundings:
    """What a site leaves to fly over; rows and the paths between them keep `margin_m` to it.

    The gate's other rules (heights, paths to the first row and home) are not checked here.
    """

    boundary: Region | None = None
    keep_out: tuple[Region, ...] = ()
    margin_m: float = 5.0
    elevation: ElevationModel | None = None
    limits: FlightLimits = field(default_factory=FlightLimits)


def surroundings_of(air: Airspace) -> SurveySurroundings:
    """Return a site's boundary, all its keep-out zones, whatever their heights, and its ground."""
    keep_out = tuple(zone.region for zone in air.zones if zone.kind is ZoneKind.KEEP_OUT)
    margin_m = air.limits.boundary_margin_m
    return SurveySurroundings(air.boundary, keep_out, margin_m, air.elevation, air.limits)


@dataclass(frozen=True, slots=True, eq=False)
class SurveyPlan:
    """A survey's rows and cells; `pieces` are by row, and along within a row."""

    survey: Survey
    frame: LocalFrame
    settings: SurveySettings
    lattice: RowLattice
    swath: Swath
    counted_swath: Swath
    """What of the swath counts as imaged: all of it, or the row's own band."""
    pieces: tuple[Piece, ...]
    paths: RegionPaths
    cells: CoverageCells
    terrain: Terrain | None = None
    """The wanted heights of a survey above ground; None: it is above takeoff."""
    ground_range_m: tuple[float, float] | None = None
    """The region's lowest and highest ground, up of the frame; None: not known."""
    stops_per_m: float = 0.0
    """Waypoints within rows that follow the ground, on average."""

    def track(self, route: Route) -> Track | None:
        """Return where a route leads; None where no path leads from a row to the next."""
        return track_of(route, self.lattice, self.swath.lead_m, self.paths, self.terrain)

    def height_above_takeoff_m(
        self, place_m: EastNorth, takeoff_up_m: float | None
    ) -> float | None:
        """Return the wanted height at a place above a takeoff point; None: where that is, counts
        and is not known."""
        if self.terrain is None:
            return self.survey.height_m
        return None if takeoff_up_m is None else self.terrain.up_at_m(place_m) - takeoff_up_m

    def height_off_m(
        self, place_m: EastNorth, height_above_takeoff_m: float, takeoff_up_m: float | None
    ) -> float | None:
        """Return how far a height is above the wanted one; negative: below it."""
        wanted_m = self.height_above_takeoff_m(place_m, takeoff_up_m)
        return None if wanted_m is None else height_above_takeoff_m - wanted_m

    def is_at_rows_height(
        self, place_m: EastNorth, height_above_takeoff_m: float, takeoff_up_m: float | None
    ) -> bool:
        """Return whether a height is that of rows there; waypoints that follow the ground may be
        off the wanted height."""
        off_m = self.height_off_m(place_m, height_above_takeoff_m, takeoff_up_m)
        slack_m = self.settings.level_m
        if self.terrain is not None:
            slack_m += self.settings.terrain_above_m
        return off_m is not None and abs(off_m) < slack_m

    def above_ground_m(self, takeoff_up_m: float) -> tuple[float, float] | None:
        """Return the least and the largest height above the region's ground that a vehicle of this
        takeoff point has on its rows; None: the ground is not known."""
        if self.terrain is not None:
            return self.terrain.lowest_above_ground_m, self.terrain.highest_above_ground_m
        if self.ground_range_m is None:
            return None
        up_m = takeoff_up_m + self.survey.height_m
        return up_m - self.ground_range_m[1], up_m - self.ground_range_m[0]

    @property
    def row_count(self) -> int:
        """Return the number of rows; one that is cut by a hole or a zone is one row."""
        return len({piece.row for piece in self.pieces})

    @property
    def rows_m(self) -> tuple[tuple[EastNorth, EastNorth], ...]:
        """Return the ends of each row as flown, lead included, in east-north metres; to show."""
        lattice, lead_m = self.lattice, self.swath.lead_m
        legs = [RowLeg(piece, False).ends_m(lattice, lead_m) for piece in self.pieces]
        ends = lattice.east_north_m(np.array(legs).reshape(-1, 2)).reshape(-1, 2, 2).tolist()
        return tuple(((a[0], a[1]), (b[0], b[1])) for a, b in ends)

    def pieces_over(self, is_wanted: BoolArray) -> tuple[Piece, ...]:
        """Return what of the pieces must be flown for these cells (R, C), cut at marks.

        Where two of them are near, what lies between is flown as well.
        """
        stretch = self.cells.stretch[is_wanted & self.cells.is_reached]
        wanted: list[tuple[int, Piece]] = []
        for index in np.unique(stretch):
            each = self.cells.stretches[int(index)]
            row = self.pieces[each.piece].row
            previous = wanted[-1] if wanted else None
            if (
                previous is not None
                and previous[0] == each.piece
                and each.start_m - previous[1].end_m <= self.settings.join_gap_m
            ):
                wanted[-1] = (each.piece, Piece(row, previous[1].start_m, each.end_m))
            else:
                wanted.append((each.piece, Piece(row, each.start_m, each.end_m)))
        return tuple(self.long_enough(index, piece) for index, piece in wanted)

    def long_enough(self, index: int, part: Piece) -> Piece:
        """Return a part made long enough for a photo, inside its whole piece if that is."""
        whole = self.pieces[index]
        short_m = self.swath.least_row_m - 2.0 * self.swath.lead_m - part.length_m
        if short_m <= 0.0:
            return part
        start_m = max(part.start_m - short_m, whole.start_m)
        end_m = min(part.end_m + part.start_m - start_m, whole.end_m)
        end_m = min(max(end_m, start_m + part.length_m + short_m), whole.end_m)
        return Piece(part.row, start_m, end_m)


def plan_survey(
    survey: Survey,
    frame: LocalFrame,
    surroundings: SurveySurroundings | None = None,
) -> SurveyPlan | Refusal:
    """Return the plan of a survey, or a refusal with the reason. Takes tens of milliseconds."""
    fault, settings = survey_fault(survey), DEFAULT
    if fault is not None:
        return Refusal(RULE, fault)
    area, swath = shape_of(survey.region), swath_of(survey, settings)
    lattice = _lattice(survey, area, swath, settings)
    if isinstance(lattice, str):
        return Refusal(RULE, lattice)
    flyable = shapely.buffer(area, row_reach_m(lattice, swath) + settings.kept_off_m)
    if surroundings is not None:
        flyable = _without_closed(flyable, surroundings, settings)
    limits = None if surroundings is None else flyable
    pieces = row_pieces(area, lattice, swath, settings, limits)
    if not pieces:
        return Refusal(RULE, _no_rows(survey, surroundings))
    air = surroundings or SurveySurroundings()
    most_m = air.limits.max_height_above_ground_m
    if surroundings is not None and survey.height_m > most_m:
        # Above takeoff too: the climb to the rows begins over the ground of the takeoff point.
        return Refusal(
            RULE,
            f"the rows are at {survey.height_m:g} m, and the site allows {most_m:g} m above ground "
            "at most: fly lower, or change the limit in the site's folder",
        )
    terrain: Terrain | str | None = None
    if survey.is_above_ground:
        terrain = terrain_over(survey, flyable, air.elevation, air.limits, settings)
    if isinstance(terrain, str):
        return Refusal(RULE, terrain)
    paths = RegionPaths(flyable)
    cells = cells_over(area, frame, survey.cell_m, lattice, pieces, swath)
    if not cells.is_reached.any():
        return Refusal(
            RULE,
            f"no cell of {survey.cell_m:g} m of the region {survey.name} is on photos of its rows: "
            "draw it larger (or choose smaller cells, `cell_m` of the API)",
        )
    counted = _counted_swath(survey, swath, lattice, settings)
    ground_m = ground_range_m(area, air.elevation, settings.terrain_cell_m)
    plan = SurveyPlan(
        survey, frame, settings, lattice, swath, counted, pieces, paths, cells, terrain, ground_m
    )
    return plan if terrain is None else replace(plan, stops_per_m=_stops_per_m(plan, terrain))


def _stops_per_m(plan: SurveyPlan, terrain: Terrain) -> float:
    stops = sum(len(terrain.between(*ends)) for ends in plan.rows_m)
    rows_m = sum(dist(a, b) for a, b in plan.rows_m)
    return stops / max(rows_m, 1.0)


def _lattice(
    survey: Survey, area: shapely.Geometry, swath: Swath, settings: SurveySettings
) -> RowLattice | str:
    """The rows of an earlier survey if it has them, else the best ones; a text: they do not fit."""
    if survey.lattice is not None:
        return lattice_again(survey.lattice, area, swath, settings)
    return lattice_over(area, row_bearing_deg(survey), swath, settings)


def row_bearing_deg(survey: Survey) -> float:
    """Return the bearing of the rows, 0 to 180, of a survey without a `survey_fault`."""
    if survey.lattice is not None:
        return survey.lattice.bearing_deg
    bearing_deg = survey.row_bearing_deg
    if bearing_deg is None:
        swath = swath_of(survey, DEFAULT)
        bearing_deg = best_bearing_deg(shape_of(survey.region), swath, DEFAULT)
    return bearing_deg % 180.0


def row_reach_m(lattice: RowLattice, swath: Swath) -> float:
    """Return how far rows may run from the region: half a spacing across, and the lead along."""
    along_m = max(swath.lead_m, swath.least_row_m / 2.0)
    return hypot(lattice.spacing_m / 2.0, along_m)


def _counted_swath(
    survey: Survey, swath: Swath, lattice: RowLattice, settings: SurveySettings
) -> Swath:
    if survey.counts_neighbours:
        return swath
    # A vehicle that is as far off its row as it may be still counts for the whole band.
    own_m = lattice.spacing_m / 2.0 + settings.place_slack_m
    return replace(swath, half_across_m=min(swath.half_across_m, own_m))


def _without_closed(
    flyable: shapely.Geometry, surroundings: SurveySurroundings, settings: SurveySettings
) -> shapely.Geometry:
    margin_m = surroundings.margin_m + settings.kept_off_m
    if surroundings.boundary is not None:
        inside = shapely.buffer(shape_of(surroundings.boundary), -margin_m)
        flyable = shapely.intersection(flyable, inside)
    closed = [shapely.buffer(shape_of(region), margin_m) for region in surroundings.keep_out]
    return shapely.difference(flyable, shapely.union_all(closed))


def _no_rows(survey: Survey, surroundings: SurveySurroundings | None) -> str:
    if surroundings is None:
        return f"the region {survey.name} is too small for a row"
    boundary = surroundings.boundary
    if boundary is not None and not shapely.intersects(shape_of(boundary), shape_of(survey.region)):
        return (
            f"the region {survey.name} lies outside the site's boundary: move the region, or the "
            "boundary in the site's folder"
        )
    return (
        f"no row of the region {survey.name} stays {surroundings.margin_m:g} m inside the site's "
        "boundary and off its keep-out zones: move the region or the zones"
    )
