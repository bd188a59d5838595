"""The station's shade maps and sun forecasts, scored against the simulator's sky.

Masks are (R, C), True in shade. Cells without a detected value count as wrong.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

import cv2
import numpy as np
import numpy.typing as npt

from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE, SURE, MaskMap, ShadeMap, SunForecast
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.score.scenario import NO_FORECAST, Scenario
from recon.score.settings import SCORE
from recon.sim.world import Sky
from recon.station.state.station import Station

FARTHEST_EDGE_M = 200.0
"""Edges farther apart than this do not belong to the same shadow; a missed or a false edge counts
with this distance."""


@dataclass(frozen=True, slots=True)
class Overlap:
    """Counts of cells that can be added up over maps."""

    both: int = 0
    """In shade both in truth and as detected."""
    either: int = 0

    def __add__(self, other: "Overlap") -> "Overlap":
        return Overlap(self.both + other.both, self.either + other.either)

    @property
    def iou(self) -> float | None:
        """Intersection over union; None where neither has any shade."""
        return self.both / self.either if self.either else None


def shade_or_wrong(shade: ShadeMap, is_shade: MaskMap) -> MaskMap:
    """Return a map's shade, and the opposite of the truth in cells without a value."""
    detected: MaskMap = np.where(shade.valid, ~shade.is_sunlit, ~is_shade)
    return detected


def overlap(detected: MaskMap, is_shade: MaskMap, is_counted: MaskMap) -> Overlap:
    """Return the overlap of two masks of shade over the counted cells."""
    both = int((detected & is_shade & is_counted).sum())
    return Overlap(both, int(((detected | is_shade) & is_counted).sum()))


def boundary_error_m(
    detected: MaskMap, is_shade: MaskMap, is_counted: MaskMap, cell_m: float
) -> float | None:
    """Return the mean distance between the edges of two masks, both ways.

    None where neither has an edge between counted cells.
    """
    edges = _edges(detected, is_counted), _edges(is_shade, is_counted)
    if not (edges[0].any() or edges[1].any()):
        return None
    if not (edges[0].any() and edges[1].any()):
        return FARTHEST_EDGE_M
    if np.array_equal(*edges):
        return 0.0
    far_m = [_from_m(edges[1], cell_m)[edges[0]], _from_m(edges[0], cell_m)[edges[1]]]
    return float(np.minimum(np.concatenate(far_m), FARTHEST_EDGE_M).mean())


def _edges(mask: MaskMap, is_counted: MaskMap) -> MaskMap:
    """(2 R - 1, 2 C - 1): cells, and between them True where two counted ones differ."""
    rows, cols = mask.shape
    edges = np.zeros((2 * rows - 1, 2 * cols - 1), dtype=np.bool_)
    across = is_counted[:, 1:] & is_counted[:, :-1]
    down = is_counted[1:] & is_counted[:-1]
    edges[::2, 1::2] = (mask[:, 1:] != mask[:, :-1]) & across
    edges[1::2, ::2] = (mask[1:] != mask[:-1]) & down
    return edges


def _from_m(edges: MaskMap, cell_m: float) -> npt.NDArray[np.float32]:
    """How far each half cell is from the nearest edge."""
    far = cv2.distanceTransform((~edges).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.asarray(far * np.float32(cell_m / 2.0), dtype=np.float32)


FloatArray = npt.NDArray[np.float64]


class HorizonCells(Enum):
    """Which cells count: those whose horizon reaches the lead, the others, or all."""

    WITHIN = "within horizon"
    BEYOND = "beyond horizon"
    ALL = "all"


@dataclass(frozen=True, slots=True)
class LeadScore:
    """Sums over the cells of one lead; they add up over forecasts."""

    squares: float = 0.0
    cells: int = 0
    shade: Overlap = field(default_factory=Overlap)

    def __add__(self, other: "LeadScore") -> "LeadScore":
        return LeadScore(
            self.squares + other.squares, self.cells + other.cells, self.shade + other.shade
        )

    @property
    def brier(self) -> float | None:
        """Mean squared error of the probability (Brier 1950): 0 is best, 0.25 is always predicting
        one half; None without cells."""
        return self.squares / self.cells if self.cells else None


def score_lead(
    forecast: SunForecast, lead_s: float, is_sunlit: MaskMap, is_counted: MaskMap
) -> Mapping[HorizonCells, LeadScore]:
    """Return the score of one of a forecast's leads against the truth at that moment.

    A cell counts as predicted in shade below a probability of sun of one half. Raises `ValueError`
    for a lead that the forecast does not have.
    """
    index = np.flatnonzero(forecast.lead_s == lead_s)
    if index.size != 1:
        raise ValueError(f"expected a lead of {forecast.lead_s.tolist()} s, got {lead_s}")
    probability = forecast.sun_probability[int(index[0])] / SURE
    is_within = forecast.horizon_s >= lead_s
    if lead_s == 0.0:
        is_within = forecast.horizon_s > 0.0
    chosen = {HorizonCells.WITHIN: is_within, HorizonCells.BEYOND: ~is_within}
    found = {
        ahead: _score(probability, is_sunlit, cells & is_counted) for ahead, cells in chosen.items()
    }
    return {**found, HorizonCells.ALL: found[HorizonCells.WITHIN] + found[HorizonCells.BEYOND]}


def _score(probability: FloatArray, is_sunlit: MaskMap, cells: MaskMap) -> LeadScore:
    squares = float(((probability - is_sunlit)[cells] ** 2).sum())
    shade = overlap(probability < 0.5, ~is_sunlit, cells)
    return LeadScore(squares, int(cells.sum()), shade)


@dataclass(slots=True)
class ImagerScore:
    """Sums of one run."""

    shade: Overlap = field(default_factory=Overlap)
    boundary_errors_m: list[float] = field(default_factory=list)
    known_shares: list[float] = field(default_factory=list)
    shade_shares: list[float] = field(default_factory=list)
    """Of the footprint, in truth."""
    leads: dict[tuple[float, HorizonCells], LeadScore] = field(default_factory=dict)


@dataclass(slots=True)
class ShadeScoring:
    """Scores the station's newest map and forecast at fixed intervals."""

    scenario: Scenario
    sky: Sky
    footprint: MaskMap
    """On `grid`; used while the station has no map."""
    grid: GroundGrid
    score: ImagerScore = field(default_factory=ImagerScore)
    _maps_due_s: float = SCORE.score_maps_every_s
    _forecasts_due_s: float = SCORE.score_forecasts_every_s

    def update(self, station: Station, now_ns: int) -> None:
        """Score the station's present map and forecast, if due."""
        now_s = now_ns / NS_PER_S
        line = station.shade
        if now_s >= self._maps_due_s:
            self._maps_due_s += SCORE.score_maps_every_s
            oldest_ns = now_ns - seconds_to_ns(SCORE.oldest_map_s)
            shade = line.shade
            is_new = shade is not None and shade.captured_at_ns >= oldest_ns
            self._score_map(shade if is_new else None, now_s)
        has_forecast = self.scenario.methods.forecast != NO_FORECAST
        if has_forecast and now_s >= self._forecasts_due_s and line.sun is not None:
            self._forecasts_due_s = now_s + SCORE.score_forecasts_every_s
            self._score_forecast(line.sun)

    def _score_map(self, shade: ShadeMap | None, now_s: float) -> None:
        grid = self.grid if shade is None else shade.grid
        at_s = now_s if shade is None else shade.captured_at_ns / NS_PER_S
        counted = self.footprint if shade is None else footprint_on(grid, self.scenario)
        is_shade: MaskMap = self.sky.on_grid(grid, at_s) < SUNLIT_TRANSMITTANCE
        detected = ~is_shade if shade is None else shade_or_wrong(shade, is_shade)
        self.score.shade += overlap(detected, is_shade, counted)
        error_m = boundary_error_m(detected, is_shade, counted, grid.cell_m)
        if error_m is not None:
            self.score.boundary_errors_m.append(error_m)
        known = 0.0 if shade is None else float(shade.valid[counted].mean())
        self.score.known_shares.append(known)
        self.score.shade_shares.append(float(is_shade[counted].mean()))

    def _score_forecast(self, sun: SunForecast) -> None:
        counted = footprint_on(sun.grid, self.scenario)
        for lead_s in SCORE.lead_s:
            if lead_s not in sun.lead_s:
                continue
            at_s = sun.issued_at_ns / NS_PER_S + lead_s
            is_sunlit: MaskMap = self.sky.on_grid(sun.grid, at_s) >= SUNLIT_TRANSMITTANCE
            for ahead, found in score_lead(sun, lead_s, is_sunlit, counted).items():
                before = self.score.leads.get((lead_s, ahead), LeadScore())
                self.score.leads[lead_s, ahead] = before + found


def footprint_on(grid: GroundGrid, scenario: Scenario) -> MaskMap:
    """Return the cells of a grid within the imaging drone's radius (rows, cols)."""
    imager = scenario.imager
    east_m = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m - imager.over_m[0]
    north_m = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m - imager.over_m[1]
    inside: MaskMap = np.hypot.outer(north_m, east_m) <= imager.radius_m
    return inside
