"""A region cut into rows: straight pieces on one lattice from which all of it is seen.

A row answers for its band, half the spacing to both sides. Where the region reaches into the band,
however slanted its edge, the row is flown; so the row may run outside a slanted edge, but never
farther from the region than `Piece`s say: half the spacing across, and the lead along.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, floor

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.guidance.survey.lattice import RowLattice, Swath, axes
from recon.guidance.survey.settings import SurveySettings
from recon.model.arrays import FloatArray
from recon.model.flown_before import KeptLattice

Span = tuple[float, float]
ROUNDING_M = 1e-6

MOST_ROWS = 2_000
"""More rows than this come from a wrong height or region."""

OUTLINE_SLACK_M = 0.05
"""An outline that is read again from a file is off by the rounding of its coordinates."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A piece of a row, from `start_m` to `end_m` along the lattice, start < end.

    What lies beside it in its band is seen for sure when it is flown with the swath's lead.
    """

    row: int
    start_m: float
    end_m: float

    @property
    def length_m(self) -> float:
        """Return the length without lead."""
        return self.end_m - self.start_m


def lattice_over(
    area: shapely.Geometry, bearing_deg: float, swath: Swath, settings: SurveySettings
) -> RowLattice:
    """Return the lattice that covers an area in east-north metres with the fewest rows.

    The rows' bands fit its width exactly, so the spacing is at most what the overlap allows.
    """
    west, south, _east, north = turned(area, bearing_deg).bounds
    count = max(1, ceil((north - south) / swath.widest_spacing_m - ROUNDING_M))
    spacing_m = (north - south) / count
    photos = max(1, ceil(settings.least_mark_m / swath.photo_m - ROUNDING_M))
    return RowLattice(
        bearing_deg, south + spacing_m / 2.0, spacing_m, count, west, photos * swath.photo_m
    )


def lattice_again(
    kept: KeptLattice, area: shapely.Geometry, swath: Swath, settings: SurveySettings
) -> RowLattice | str:
    """Return the lattice of an earlier survey over an area, or why it does not fit.

    Each row lies where it lay; if the area has grown there are more of them. Marks are of the
    present distance between photos.
    """
    if kept.spacing_m > swath.widest_spacing_m + ROUNDING_M:
        return (
            f"the rows of the earlier survey are {kept.spacing_m:.1f} m apart, and this height and "
            f"side overlap need {swath.widest_spacing_m:.1f} m: choose those of then, or new rows"
        )
    fresh = lattice_over(area, kept.bearing_deg, swath, settings)
    edge_m = kept.first_row_m - kept.spacing_m / 2.0
    _west, south, _east, north = turned(area, kept.bearing_deg).bounds
    if (north - south) / kept.spacing_m > MOST_ROWS:
        return f"rows {kept.spacing_m:.2g} m apart are more than {MOST_ROWS}: choose new rows"
    first = floor((south - edge_m + OUTLINE_SLACK_M) / kept.spacing_m)
    end = max(first + 1, ceil((north - edge_m - OUTLINE_SLACK_M) / kept.spacing_m))
    return RowLattice(
        kept.bearing_deg,
        kept.first_row_m + first * kept.spacing_m,
        kept.spacing_m,
        end - first,
        kept.first_mark_m,
        fresh.mark_m,
    )


def turned(area: shapely.Geometry, bearing_deg: float) -> shapely.Geometry:
    """Return an area in metres along (x) and across (y) rows of a bearing."""
    turn = axes(bearing_deg)
    return shapely.transform(area, lambda points: points @ turn.T)


def row_pieces(
    area: shapely.Geometry,
    lattice: RowLattice,
    swath: Swath,
    settings: SurveySettings,
    flyable: shapely.Geometry | None = None,
) -> tuple[Piece, ...]:
    """Return the pieces of all rows, by row and then along; areas in east-north metres.

    Where rows would leave `flyable` they are cut, and what they would have seen is not.
    """
    lying = turned(area, lattice.bearing_deg)
    pieces = tuple(_pieces(lying, lattice, swath, settings))
    if flyable is None:
        return pieces
    return tuple(_inside(pieces, turned(flyable, lattice.bearing_deg), lattice, swath))


def _pieces(
    lying: shapely.Geometry, lattice: RowLattice, swath: Swath, settings: SurveySettings
) -> Iterator[Piece]:
    west, _south, east, _north = lying.bounds
    across_m = lattice.rows_across_m
    half_m = lattice.spacing_m / 2.0
    shapely.prepare(lying)
    bands = shapely.intersection(
        lying, shapely.box(west - 1.0, across_m - half_m, east + 1.0, across_m + half_m)
    )
    chords = shapely.intersection(lying, lines_along(west, east, across_m))
    for row in range(lattice.rows):
        reached = _merged(_spans(bands[row], settings.sliver_m))
        flown = _spans(chords[row], 0.0)
        for span in reached:
            yield _piece(row, span, flown, swath)


def _piece(row: int, span: Span, chords: Sequence[Span], swath: Swath) -> Piece:
    """The piece that sees a span: along the region's own chord, and beyond it where it must."""
    start_m, end_m = span
    within = [c for c in chords if c[0] >= start_m - ROUNDING_M and c[1] <= end_m + ROUNDING_M]
    start_m = min([start_m + swath.beyond_m, *(chord[0] for chord in within)])
    end_m = max([end_m - swath.beyond_m, *(chord[1] for chord in within)])
    short_m = swath.least_row_m - 2.0 * swath.lead_m - (end_m - start_m)
    if short_m > 0.0:
        start_m, end_m = start_m - short_m / 2.0, end_m + short_m / 2.0
    return Piece(row, start_m, end_m)


def _inside(
    pieces: Sequence[Piece], flyable: shapely.Geometry, lattice: RowLattice, swath: Swath
) -> Iterator[Piece]:
    """The parts of pieces whose flown path, lead and all, stays in what may be flown over."""
    shapely.prepare(flyable)
    for piece in pieces:
        across_m = lattice.row_across_m(piece.row)
        flown = shapely.LineString(
            [(piece.start_m - swath.lead_m, across_m), (piece.end_m + swath.lead_m, across_m)]
        )
        for start_m, end_m in sorted(_spans(shapely.intersection(flyable, flown), 0.0)):
            if end_m - start_m >= swath.least_row_m - ROUNDING_M:
                yield Piece(piece.row, start_m + swath.lead_m, end_m - swath.lead_m)


def lines_along(west: float, east: float, across_m: FloatArray) -> npt.NDArray[np.object_]:
    """Return a line for each of N rows, from before `west` to behind `east` along."""
    ends = np.stack(
        [np.full_like(across_m, west - 1.0), np.full_like(across_m, east + 1.0)], axis=1
    )
    lines: npt.NDArray[np.object_] = shapely.linestrings(
        ends, np.stack([across_m, across_m], axis=1)
    )
    return lines


def _spans(geometry: shapely.Geometry, least_m: float) -> list[Span]:
    """Return where each part begins and ends along; parts smaller both ways are skipped."""
    bounds = shapely.bounds(shapely.get_parts(geometry)).reshape(-1, 4)
    large = (bounds[:, 2:] - bounds[:, :2]).max(axis=1, initial=0.0) > least_m
    return [(float(west), float(east)) for west, _south, east, _north in bounds[large]]


def _merged(spans: Sequence[Span]) -> list[Span]:
    merged: list[Span] = []
    for start_m, end_m in sorted(spans):
        if merged and start_m <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(merged[-1][1], end_m))
        else:
            merged.append((start_m, end_m))
    return merged


STEP_DEG = 15.0
"""Step of the directions tried all round, besides those of the longest edges."""

MOST_EDGES = 16


def best_bearing_deg(area: shapely.Geometry, swath: Swath, settings: SurveySettings) -> float:
    """Return the bearing in [0, 180) whose rows are in the fewest pieces, then the shortest."""
    return min(_candidates_deg(area), key=lambda deg: (*_cost(area, deg, swath, settings), deg))


def _cost(
    area: shapely.Geometry, bearing_deg: float, swath: Swath, settings: SurveySettings
) -> tuple[int, float]:
    """How many pieces, and their length in whole metres, of the rows' middle lines in the area."""
    lattice = lattice_over(area, bearing_deg, swath, settings)
    lying = turned(area, bearing_deg)
    west, _south, east, _north = lying.bounds
    lines = lines_along(west, east, lattice.rows_across_m)
    parts = shapely.get_parts(shapely.intersection(lying, lines))
    long_m = shapely.length(parts)
    return int((long_m > 0.0).sum()), round(float(long_m.sum()))


def _candidates_deg(area: shapely.Geometry) -> list[float]:
    """Round bearings, and those of the longest edges to a tenth of a degree."""
    edges = np.diff(shapely.get_coordinates(area.exterior), axis=0)
    longest = edges[np.argsort(-np.hypot(edges[:, 0], edges[:, 1]), kind="stable")][:MOST_EDGES]
    of_edges = np.rad2deg(np.arctan2(longest[:, 0], longest[:, 1]))
    bearings: FloatArray = np.concatenate([np.arange(0.0, 180.0, STEP_DEG), of_edges.round(1)])
    return sorted({float(deg) for deg in np.mod(bearings, 180.0)})
