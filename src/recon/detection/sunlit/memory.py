"""What the method remembers from frame to frame; bounded, and never changed in place."""

from dataclasses import dataclass, replace

import numpy as np

from recon.detection.sunlit.belief import Belief
from recon.detection.sunlit.colour import CellColour, upsampled
from recon.detection.sunlit.drift import Drift
from recon.detection.sunlit.earlier import AdoptedReference
from recon.detection.sunlit.keyframes import Keyframe, SunlitLand
from recon.detection.sunlit.levels import UNCHANGED, Level
from recon.model.shade import FloatMap

DETAIL_FRAMES = 40
"""Frames over which the detail inside coarse cells is averaged."""


@dataclass(frozen=True, slots=True, eq=False)
class Detail:
    """Mean difference (R, C) of the field's cells from the coarse cells around; light and colour.

    Shade has no edges as sharp as a cell, so the detail is the land's in sun and shade alike.
    """

    light: FloatMap
    colour: FloatMap
    frames: int = 0

    def with_frame(self, fine: CellColour, coarse: CellColour) -> "Detail":
        """Return the detail with a frame added."""
        share = np.float32(1.0 / min(self.frames + 1, DETAIL_FRAMES))
        parts = []
        for mean, cells, means in (
            (self.light, fine.light, coarse.light),
            (self.colour, fine.colour, coarse.colour),
        ):
            new = cells - upsampled(means, cells.shape)
            blended = np.where(np.isfinite(mean), mean + share * (new - mean), new)
            parts.append(np.where(np.isfinite(new), blended, mean).astype(np.float32))
        return Detail(parts[0], parts[1], self.frames + 1)


@dataclass(frozen=True, slots=True, eq=False)
class SunlitMemory:
    """Keyframes, the land in full sun, and the level of sun in the latest frame."""

    adopted: AdoptedReference
    """What an earlier flight knew of the land."""
    keyframes: tuple[Keyframe, ...] = ()
    land: SunlitLand | None = None
    """None while nothing shows which is sun and which shade."""
    detail: Detail | None = None
    belief: Belief | None = None
    """Belief in the level of sun, in the latest frame that was read."""
    believed_at_ns: int = 0
    correction: Level = UNCHANGED
    """Correction of the belief's level of sun, found with the newest keyframe."""
    belief_drift: Level = UNCHANGED
    """The total drift then."""
    level: Level | None = None
    """Level of sun in the latest frame; None while it is undecided."""
    drift: Drift | None = None
    lock_problem: str = ""
    """What has shown that a camera stated to be locked is not; from there on it is not trusted."""

    def with_detail(self, fine: CellColour, coarse: CellColour) -> "SunlitMemory":
        """Return the memory with a frame's detail."""
        nothing = np.full(fine.light.shape, np.nan, dtype=np.float32)
        detail = self.detail or Detail(nothing, nothing)
        return replace(self, detail=detail.with_frame(fine, coarse))
