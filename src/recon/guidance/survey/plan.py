"""A survey made ready to be flown: rows, ways between them, cells."""

from dataclasses import dataclass, replace
from math import hypot

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.guidance.survey.cells import BoolArray, SurveyCells, cells_over
from recon.guidance.survey.check import survey_fault
from recon.guidance.survey.direction import best_bearing_deg
from recon.guidance.survey.lattice import RowLattice
from recon.guidance.survey.route import Leg, Place
from recon.guidance.survey.rows import Piece, lattice_over, row_pieces
from recon.guidance.survey.settings import DEFAULT, SurveySettings
from recon.guidance.survey.swath import Swath, swath_of
from recon.guidance.survey.ways import Ways
from recon.model.command import Refusal
from recon.model.geo import LocalFrame
from recon.model.survey import Survey
from recon.model.zone import Region

RULE = "survey"


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """What a site leaves to fly over; rows and the ways between them keep `margin_m` to it.

    What the gate asks besides (heights, ways to the first row and home) is not looked at here.
    """

    boundary: Region | None = None
    keep_out: tuple[Region, ...] = ()
    margin_m: float = 5.0


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
    ways: Ways
    cells: SurveyCells

    @property
    def rows_m(self) -> tuple[tuple[Place, Place], ...]:
        """From where to where each row is flown, lead and all, in east-north metres; to show."""
        lattice, lead_m = self.lattice, self.swath.lead_m
        legs = [Leg(piece, False).ends_m(lattice, lead_m) for piece in self.pieces]
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
        return tuple(self._long_enough(index, piece) for index, piece in wanted)

    def _long_enough(self, index: int, part: Piece) -> Piece:
        """A part made long enough for a photo, inside its whole piece as far as that is."""
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
    surroundings: Surroundings | None = None,
    settings: SurveySettings = DEFAULT,
) -> SurveyPlan | Refusal:
    """Return the plan of a survey, or why there is none. Takes tens of milliseconds."""
    fault = survey_fault(survey, settings)
    if fault is not None:
        return Refusal(RULE, fault)
    area, swath = _area(survey.region), swath_of(survey, settings)
    bearing_deg = survey.row_bearing_deg
    if bearing_deg is None:
        bearing_deg = best_bearing_deg(area, swath, settings)
    lattice = lattice_over(area, bearing_deg % 180.0, swath, settings)
    flyable = shapely.buffer(area, row_reach_m(lattice, swath) + settings.kept_off_m)
    if surroundings is not None:
        flyable = _left(flyable, surroundings, settings)
    limits = None if surroundings is None else flyable
    pieces = row_pieces(area, lattice, swath, settings, limits)
    if not pieces:
        return Refusal(RULE, _no_rows(survey, surroundings))
    ways = Ways(flyable)
    cells = cells_over(area, frame, survey.cell_m, lattice, pieces, swath)
    counted = _counted(survey, swath, lattice, settings)
    return SurveyPlan(survey, frame, settings, lattice, swath, counted, pieces, ways, cells)


def row_reach_m(lattice: RowLattice, swath: Swath) -> float:
    """Return how far rows may run from the region: half a spacing across, and the lead along."""
    along_m = max(swath.lead_m, swath.least_row_m / 2.0)
    return hypot(lattice.spacing_m / 2.0, along_m)


def _counted(survey: Survey, swath: Swath, lattice: RowLattice, settings: SurveySettings) -> Swath:
    if survey.counts_neighbours:
        return swath
    # A vehicle that is as far off its row as it may be still counts for the whole band.
    own_m = lattice.spacing_m / 2.0 + settings.place_slack_m
    return replace(swath, half_across_m=min(swath.half_across_m, own_m))


def _left(
    flyable: shapely.Geometry, surroundings: Surroundings, settings: SurveySettings
) -> shapely.Geometry:
    margin_m = surroundings.margin_m + settings.kept_off_m
    if surroundings.boundary is not None:
        inside = shapely.buffer(_area(surroundings.boundary), -margin_m)
        flyable = shapely.intersection(flyable, inside)
    shut = [shapely.buffer(_area(region), margin_m) for region in surroundings.keep_out]
    return shapely.difference(flyable, shapely.union_all(shut))


def _area(region: Region) -> shapely.Polygon:
    return shapely.Polygon(region.outline_m, list(region.holes_m))


def _no_rows(survey: Survey, surroundings: Surroundings | None) -> str:
    if surroundings is None:
        return f"the region {survey.name} is too small for a row"
    return (
        f"no row of the region {survey.name} stays {surroundings.margin_m:g} m inside the site's "
        "boundary and off its keep-out zones: move the region or the zones"
    )
