"""What a detector remembers from frame to frame; bounded, and never changed in place."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt

from recon.detection.cells import CellSamples
from recon.detection.exposure import Exposure
from recon.detection.settings import DetectionSettings
from recon.detection.sunlit.memory import SunlitMemory
from recon.model.geo import GroundGrid
from recon.model.shade import FloatMap, SunlitReference
from recon.model.units import seconds_to_ns

DARK_QUANTILE = 0.1
"""Quantile of a cell's samples taken as its darkest light; below it is noise."""


@dataclass(frozen=True, slots=True, eq=False)
class LightHistory:
    """Light of the cells over the window, at the exposure of the first frame."""

    samples: tuple[tuple[int, FloatMap], ...]
    """(capture time, (R, C) light, NaN where not visible), oldest first."""
    sunlit: FloatMap
    """(R, C): the sunlit quantile of each cell's samples, NaN without samples."""
    dark: FloatMap
    """(R, C): the dark quantile."""
    count: npt.NDArray[np.int64]
    """(R, C): number of samples that show the cell."""

    @classmethod
    def with_sample(
        cls, history: Self | None, at_ns: int, light: FloatMap, settings: DetectionSettings
    ) -> Self:
        """Return the history with a frame added; only the first in each time slot is kept.

        Slots are fixed in time, so that the frame rate does not change which samples are kept.
        """
        kept = () if history is None else history.samples
        spacing_ns = seconds_to_ns(settings.window_s) // settings.samples
        if history is not None and at_ns // spacing_ns == kept[-1][0] // spacing_ns:
            return history
        oldest_ns = at_ns - seconds_to_ns(settings.window_s)
        # Old samples go by age, then by number: memory is bounded at any frame rate.
        recent = tuple(sample for sample in kept if sample[0] > oldest_ns)
        return cls._of((*recent, (at_ns, light))[-settings.samples :], settings)

    @classmethod
    def _of(cls, samples: tuple[tuple[int, FloatMap], ...], settings: DetectionSettings) -> Self:
        # NaN sorts last, so each cell's samples come first in their order.
        ordered = np.sort(np.stack([light for _, light in samples]), axis=0)
        count = np.count_nonzero(np.isfinite(ordered), axis=0)
        sunlit, dark = (
            _quantile(ordered, count, share) for share in (settings.sunlit_quantile, DARK_QUANTILE)
        )
        return cls(samples, sunlit, dark, count)


def _quantile(ordered: FloatMap, count: npt.NDArray[np.int64], share: float) -> FloatMap:
    """Return (R, C): the quantile of the first `count` of (N, R, C), with linear interpolation."""
    # Cells have different numbers of samples: the index of the quantile differs per cell.
    place = np.maximum(count - 1, 0) * share
    below = np.floor(place).astype(np.int64)
    above = np.minimum(below + 1, np.maximum(count - 1, 0))
    low, high = (np.take_along_axis(ordered, i[np.newaxis], axis=0)[0] for i in (below, above))
    found: FloatMap = (low + (high - low) * (place - below)).astype(np.float32)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class DetectionState:
    """One state for all methods, so that the method can be changed in flight."""

    grid: GroundGrid | None = None
    """The field grid, from the first frame on."""
    serial: str = ""
    """Serial of the vehicle whose camera the rest belongs to."""
    latest: CellSamples | None = None
    """The last accepted frame; `latest_ns` is its capture time."""
    latest_ns: int | None = None
    exposure: Exposure | None = None
    history: LightHistory | None = None
    sunlit: SunlitMemory | None = None
    references: tuple[SunlitReference, ...] = ()
    """References from earlier flights over the site."""
