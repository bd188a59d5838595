"""A region of the site that has been surveyed: its rows, and when each of its cells was imaged.

One is kept for each way to survey a region: what decides how photos look (height, camera, overlaps)
is in its key. Times are seconds since 1970, by the station's clock.
"""

import json
from dataclasses import dataclass, replace
from hashlib import sha256

import numpy as np
import numpy.typing as npt

from recon.model.arrays import BoolArray
from recon.model.flown_before import FlownCells, KeptLattice, StateArray
from recon.model.geo import GroundGrid
from recon.model.survey import CellState, Survey, planner_goal

SecondsArray = npt.NDArray[np.uint32]
NEVER_S = 0


@dataclass(frozen=True, slots=True, eq=False)
class FlownRegion:
    """A surveyed region; arrays are (R, C) on `grid` and never written to.

    `imaged_s` and `in_sun_s` are when a cell was imaged last, and last in sun, or `NEVER_S`.
    """

    survey: Survey
    """As it was started last."""
    lattice: KeptLattice
    grid: GroundGrid
    is_reached: BoolArray
    is_light_known: BoolArray
    imaged_s: SecondsArray
    in_sun_s: SecondsArray
    begun_s: int
    """When the survey was begun that the last start continued, or that start itself."""
    started_s: int
    is_simulated: bool

    @property
    def key(self) -> str:
        """Its identity, fit for a file's name."""
        return region_key(self.survey, is_simulated=self.is_simulated)

    def done_s(self) -> SecondsArray:
        """Return (R, C): when a cell was last imaged as the survey's planner wants it."""
        is_sun_wanted = planner_goal(self.survey.planner) == CellState.IN_SUN
        return self.in_sun_s if is_sun_wanted else self.imaged_s

    def is_left(self, since_s: int) -> BoolArray:
        """Return (R, C): the reached cells that have not been imaged as wanted since a moment."""
        is_left: BoolArray = self.is_reached & (self.done_s() < max(1, since_s))
        return is_left

    def cells_since(self, since_s: int) -> FlownCells:
        """Return what has been imaged since a moment, and need not be flown again."""
        least_s = max(1, since_s)
        state = np.full(self.imaged_s.shape, CellState.NOT_YET, dtype=np.uint8)
        state[self.imaged_s >= least_s] = CellState.IN_SHADE
        state[self.in_sun_s >= least_s] = CellState.IN_SUN
        return FlownCells(self.grid, state, self.is_light_known, since_s, self.is_simulated)

    def with_imaged(
        self, before: StateArray, after: StateArray, is_light_known: BoolArray, now_s: int
    ) -> "FlownRegion":
        """Return it with the cells that have risen between two states of a survey, as of now."""
        has_risen = after > before
        if not has_risen.any():
            return self
        is_in_sun = has_risen & (after == CellState.IN_SUN)
        return replace(
            self,
            imaged_s=np.where(has_risen, np.uint32(now_s), self.imaged_s),
            in_sun_s=np.where(is_in_sun, np.uint32(now_s), self.in_sun_s),
            is_light_known=np.where(has_risen, is_light_known, self.is_light_known),
        )


def region_key(survey: Survey, *, is_simulated: bool) -> str:
    """Return what identifies a region surveyed in one way, by real or by simulated drones."""
    camera = survey.camera
    way = (
        survey.region_name,
        is_simulated,
        *(survey.height_above_takeoff_m, survey.height_above_ground_m),
        *(camera.across_deg, camera.along_deg, camera.across_px),
        *(survey.front_overlap, survey.side_overlap),
    )
    # A whole number asked for may come as 40 or 40.0.
    alike = [float(each) if type(each) is int else each for each in way]
    return sha256(json.dumps(alike).encode()).hexdigest()[:16]
