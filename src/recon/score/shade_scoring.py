"""The station's shade maps, forecasts and poses, scored against the simulator's truth."""

from dataclasses import dataclass, field

import numpy as np

from recon.geo import nearest_cells
from recon.model.arrays import FloatArray
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.shade import MaskMap, ShadeMap
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.score.change_figures import ChangeScore
from recon.score.forecast_figures import LeadScore
from recon.score.forecast_scoring import ForecastKey, ForecastScoring
from recon.score.methods import settings_of
from recon.score.scenario import NO_FORECAST, Scenario
from recon.score.score_grid import score_grid, scored_cells
from recon.score.settings import SCORE
from recon.score.shade_figures import ShadeFigures, map_figures
from recon.score.true_frames import Frames, registration_errors_m
from recon.sim.world import Sky
from recon.station.state.station import Station


@dataclass(slots=True)
class ImagerScore:
    """Sums of one run."""

    shade: ShadeFigures = field(default_factory=ShadeFigures)
    to_right_s: float | None = None
    """Time at which most cells were first known and right: `SCORE.right_share` of them."""
    registration_errors_m: list[FloatArray] = field(default_factory=list)
    """Errors of points of each ground image."""
    forecasts: dict[ForecastKey, LeadScore] = field(default_factory=dict)
    changes: ChangeScore = field(default_factory=ChangeScore)
    """Score of the times to shade that the station's own forecasts give."""


@dataclass(frozen=True, slots=True, eq=False)
class ScoredGround:
    """A grid and its scored cells (rows, cols)."""

    grid: GroundGrid
    counted: MaskMap

    def figures(self, shade: ShadeMap | None, sky: Sky, at_s: float) -> ShadeFigures:
        """Return the figures of a map on this ground; without one all cells are unknown."""
        truth = sky.on_grid(self.grid, at_s)
        if shade is None:
            unknown = np.zeros_like(self.counted)
            return map_figures(truth, unknown, truth, self.counted, self.grid.cell_m)
        rows, cols, is_on = nearest_cells(shade.grid, self.grid)
        known = shade.valid[rows, cols] & is_on
        transmittance = shade.transmittance[rows, cols]
        return map_figures(transmittance, known, truth, self.counted, self.grid.cell_m)


def scored_ground(scenario: Scenario, *, is_coarse: bool = False) -> ScoredGround:
    """Return the ground on which a scenario's maps are scored; coarse: in cells of 12 m."""
    grid = score_grid(scenario)
    if is_coarse:
        grid = score_grid(scenario, SCORE.coarse_cell_m)
    return ScoredGround(grid, scored_cells(grid, scenario))


@dataclass(slots=True)
class ShadeScoring:
    """Scores the station's newest map and forecast at fixed intervals, poses of all its images."""

    scenario: Scenario
    sky: Sky
    frames: Frames
    score: ImagerScore = field(default_factory=ImagerScore)
    _maps_due_s: float = SCORE.score_maps_every_s
    _map_number: int = 0
    _images: dict[str, GroundImage] = field(default_factory=dict)
    _ground: ScoredGround = field(init=False)
    _coarse: ScoredGround = field(init=False)
    _forecasts: ForecastScoring | None = None

    def __post_init__(self) -> None:
        self._ground = scored_ground(self.scenario)
        self._coarse = scored_ground(self.scenario, is_coarse=True)
        methods, ground = self.scenario.methods, self._ground
        if methods.forecast != NO_FORECAST:
            self._forecasts = ForecastScoring(
                self.sky,
                ground.grid,
                ground.counted,
                methods.forecast,
                tuple(name for name in methods.compared if name != methods.forecast),
                settings_of(self.scenario).forecast,
                sums=self.score.forecasts,
            )

    def update(self, station: Station, now_ns: int) -> None:
        """Score the station's present map, forecast and image, if due or new."""
        now_s = now_ns / NS_PER_S
        line = station.shade
        if now_s >= self._maps_due_s:
            self._maps_due_s += SCORE.score_maps_every_s
            oldest_ns = now_ns - seconds_to_ns(SCORE.oldest_map_s)
            shade = line.followed
            is_new = shade is not None and shade.captured_at_ns >= oldest_ns
            self._score_map(shade if is_new else None, now_s)
        if self.score.to_right_s is None and line.number != self._map_number:
            self._map_number = line.number
            self._note_right(line.shade, now_s)
        if self._forecasts is not None:
            self._forecasts.update(line, now_s)
            self.score.changes = self._forecasts.changes
        for imager in station.imaging.imagers.values():
            self._score_pose(imager.ground_image)

    def _score_map(self, shade: ShadeMap | None, now_s: float) -> None:
        at_s = now_s if shade is None else shade.captured_at_ns / NS_PER_S
        self.score.shade += self._ground.figures(shade, self.sky, at_s)

    def _note_right(self, shade: ShadeMap | None, now_s: float) -> None:
        if shade is None:
            return
        found = self._coarse.figures(shade, self.sky, shade.captured_at_ns / NS_PER_S)
        if found.right_share >= SCORE.right_share:
            self.score.to_right_s = now_s

    def _score_pose(self, image: GroundImage | None) -> None:
        if image is None or image is self._images.get(image.serial):
            return
        self._images[image.serial] = image
        true = self.frames.of_image(image)
        if true is not None:
            errors_m = registration_errors_m(true.pose, image.pose)
            self.score.registration_errors_m.append(errors_m)
