"""Next change of the light of a cell: its time to shade, or its time to sun.

Theory of operation: members follow the shadows upwind, each with a velocity of its own around the
measured one, and with an error of its own in what it reads there, as wide as the transition from
shade to sun of shade that is followed. A member's change is the first lead at which what it reads
is on the other side of one half than the cell is now. Leads count within the cell's horizon: beyond
it nothing that will be over the cell is seen. The members' share is the chance of a change, and
their times are its median and spread: what a forecast of one moment cannot say.
"""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
import numpy.typing as npt

from recon.forecast.settings import ForecastSettings
from recon.forecast.upwind import Cells, nearest_seen
from recon.model.arrays import FloatArray
from recon.model.shade import SUNLIT_TRANSMITTANCE, FloatMap, MaskMap, ShadeMap, SunForecast

MEMBERS = 20
STEP_S = 5.0
CHANGED_SHARE = 0.5
"""Share of the members for a change to be predicted."""
SPREAD = 0.1, 0.9
SEED = 12
WIDEST = 30_000
"""Cells read at once: images have fewer than 2^15 columns."""


@dataclass(frozen=True, slots=True, eq=False)
class NextChange:
    """The next change of light of N cells; all arrays (N,)."""

    is_sunlit: MaskMap
    """Now: the change is to shade where true, else to sun."""
    horizon_s: FloatArray
    """Time until which changes are seen coming; 0 where nothing is known."""
    chance: FloatArray
    """Probability of a change before the horizon."""
    after_s: FloatArray
    """Median time until then; NaN where none is predicted."""
    early_s: FloatArray
    late_s: FloatArray
    """SPREAD of that time."""

    @property
    def is_predicted(self) -> MaskMap:
        """Return where a change is likelier than none before the horizon."""
        return np.isfinite(self.after_s)


def next_change(
    shade: ShadeMap, sun: SunForecast, cells: Cells, settings: ForecastSettings
) -> NextChange:
    """Return the next change of light of `cells` (N, 2), rows and columns of the map.

    `sun` is the forecast from the map. Without a motion, and off the map, nothing is predicted.
    """
    rows, cols = cells[:, 0], cells[:, 1]
    is_on = (rows >= 0) & (rows < shade.grid.rows) & (cols >= 0) & (cols < shade.grid.cols)
    rows, cols = rows * is_on, cols * is_on
    is_known = is_on & shade.valid[rows, cols] & (sun.velocity_mps is not None)
    horizon_s = np.where(is_known, np.nan_to_num(sun.horizon_s[rows, cols]), 0.0)
    is_sunlit = shade.is_sunlit[rows, cols] & is_on
    times_s = np.full((MEMBERS, len(cells)), np.nan)
    if sun.velocity_mps is not None and is_known.any():
        members = _Members.of(shade, sun.velocity_mps, settings)
        for first in range(0, len(cells), WIDEST):
            part = slice(first, first + WIDEST)
            times_s[:, part] = members.changes_s(
                rows[part], cols[part], is_sunlit[part], horizon_s[part]
            )
    chance = np.isfinite(times_s).mean(axis=0)
    # No change comes last, so that NaN sorts after all times.
    ordered = np.sort(times_s, axis=0)
    changed = np.isfinite(ordered).sum(axis=0)
    found = [
        np.where(chance >= CHANGED_SHARE, _quantile(ordered, changed, share), np.nan)
        for share in (0.5, *SPREAD)
    ]
    return NextChange(is_sunlit, horizon_s, chance, *found)


def _quantile(ordered: FloatArray, count: npt.NDArray[np.intp], share: float) -> FloatArray:
    """Return a quantile (N,) of the first `count` of each column's values."""
    index = np.rint(share * np.maximum(count - 1, 0)).astype(np.intp)
    found: FloatArray = ordered[index, np.arange(ordered.shape[1])]
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Members:
    """What all members read, and how each moves and errs."""

    transmittance: FloatMap
    """(R, C); that of the nearest seen cell where nothing was seen."""
    right: FloatMap
    down: FloatMap
    """Velocities (M, 1) in cells per second."""
    error: FloatMap
    """(M, 1) in [-1, 1], of the width of the transition from shade to sun."""
    settings: ForecastSettings

    @staticmethod
    def of(
        shade: ShadeMap, velocity_mps: tuple[float, float], settings: ForecastSettings
    ) -> "_Members":
        normal, error = _drawn()
        velocity = np.array(velocity_mps) + settings.least_spread_mps * normal
        right, down = (velocity / shade.grid.cell_m * (1.0, -1.0)).astype(np.float32).T
        return _Members(
            shade.transmittance[nearest_seen(shade.valid)],
            right[:, np.newaxis],
            down[:, np.newaxis],
            error[:, np.newaxis],
            settings,
        )

    def changes_s(
        self, rows: Cells, cols: Cells, is_sunlit: MaskMap, horizon_s: FloatArray
    ) -> FloatArray:
        """Return each member's time of change (M, N); NaN where it sees none."""
        times_s = np.full((len(self.error), len(rows)), np.nan)
        at_row, at_col = rows.astype(np.float32), cols.astype(np.float32)
        error = self.error * np.float32(self.settings.least_soft_edge)
        steps = np.arange(STEP_S, float(horizon_s.max(initial=0.0)) + 0.5 * STEP_S, STEP_S)
        for lead_s in steps.tolist():
            there = cv2.remap(
                self.transmittance,
                at_col - self.right * np.float32(lead_s),
                at_row - self.down * np.float32(lead_s),
                cv2.INTER_LINEAR,
                borderMode=cv2.BORDER_REPLICATE,
            )
            is_lit = there + error >= SUNLIT_TRANSMITTANCE
            is_new = np.isnan(times_s) & (is_lit != is_sunlit) & (lead_s <= horizon_s)
            times_s[is_new] = lead_s
        return times_s


@lru_cache(maxsize=1)
def _drawn() -> tuple[FloatArray, FloatMap]:
    """Return the members' deviations of velocity (M, 2), normal, and errors (M,), evenly spread."""
    rng = np.random.default_rng(SEED)
    normal = rng.standard_normal((MEMBERS, 2))
    normal = (normal - normal.mean(axis=0)) / normal.std(axis=0)
    even = (2.0 * np.arange(MEMBERS) + 1.0) / MEMBERS - 1.0
    return normal, rng.permutation(even).astype(np.float32)
