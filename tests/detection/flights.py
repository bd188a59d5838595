"""Whole flights of the imaging drone over a field, through one method."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from tests.detection.shaded_field import FIELD, FOOTPRINT, DriftingShade, Imager, Land, shade_iou

from recon.detection import DETECTORS, DetectionSettings, DetectionState
from recon.model.imagery import GroundImage
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap

FRAME_EVERY_S = 4.0
BEGINS_TO_COUNT_S = 60.0


def shade_of(
    images: Iterable[GroundImage], method: str, settings: DetectionSettings | None = None
) -> list[ShadeMap]:
    """The shade map of every image; a rejected one is an error of the test."""
    state, maps = DetectionState(), []
    for image in images:
        state, found = DETECTORS[method](state, image, settings or DetectionSettings())
        assert isinstance(found, ShadeMap), found
        maps.append(found)
    return maps


@dataclass(frozen=True, slots=True)
class Watch:
    """One flight: a field, its shade, what the camera's exposure does."""

    seed: int
    cover: float = 0.35
    lasts_s: float = 120.0
    gains: tuple[float, ...] = (1.0,)
    """Taken in turns of 30 s each."""
    placed_m: float = 0.0
    """Standard deviation of each frame's place."""

    def images(self) -> list[GroundImage]:
        land, shade = Land(self.seed), self.shade()
        wrong_m = np.random.default_rng(self.seed).normal(0.0, self.placed_m, (1_000, 2))
        times_s = np.arange(0.0, self.lasts_s, FRAME_EVERY_S)
        return [
            Imager(offset_m=tuple(wrong_m[i])).see(
                land, shade, at_s, self.gains[int(at_s // 30.0) % len(self.gains)]
            )
            for i, at_s in enumerate(times_s)
        ]

    def shade(self) -> DriftingShade:
        return DriftingShade(self.seed + 50_000, self.cover)

    def is_shade(self, found: ShadeMap) -> np.ndarray:
        """The truth at a map's moment."""
        direct = self.shade().transmittance(FIELD, found.captured_at_ns / 1e9)
        return direct < SUNLIT_TRANSMITTANCE

    def mean_iou(self, maps: list[ShadeMap]) -> float:
        """Of the maps after the first minute."""
        counted = [m for m in maps if m.captured_at_ns >= BEGINS_TO_COUNT_S * 1e9]
        assert counted
        return float(np.mean([shade_iou(m.is_sunlit, m.valid, self.is_shade(m)) for m in counted]))

    def wrong_share(self, found: ShadeMap, where: np.ndarray) -> float:
        """Return the share of the footprint's cells `where` that is wrong."""
        wrong = found.is_sunlit == self.is_shade(found)
        return float(wrong[where & FOOTPRINT].mean())
