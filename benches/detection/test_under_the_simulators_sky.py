"""Where the plain method ends: the simulator's clouds, whose shade often outlasts two minutes.

uv run python -m pytest benches/detection/test_under_the_simulators_sky.py -s
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
from tests.detection.flights import shade_of
from tests.detection.shaded_field import FIELD, FOOTPRINT, DriftingShade, Imager, Land

from recon.detection import DetectionSettings
from recon.model.geo import GroundGrid
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.sim.world.settings import LayerSettings, SkySettings
from recon.sim.world.sky import Sky

SEEDS = range(22_000, 22_010)
TIMES_S = np.arange(0.0, 600.0, 5.0)
COUNTED_FROM = 24
SETTINGS = {
    "brightness_ratio": DetectionSettings(),
    "brightness_ratio, ten minutes": DetectionSettings(window_s=600.0, samples=48),
    "otsu": DetectionSettings(),
}


@dataclass
class SkyShade(DriftingShade):
    """The simulator's sky in place of the drawn one."""

    def __post_init__(self) -> None:
        """Nothing to draw."""

    @cached_property
    def sky(self) -> Sky:
        return Sky(SkySettings(self.seed, layers=(LayerSettings(cover=self.cover),)))

    def transmittance(self, grid: GroundGrid, time_s: float) -> np.ndarray:
        return self.sky.on_grid(grid, time_s)


@pytest.mark.parametrize("cover", [0.2, 0.4])
def test_share_of_wrong_cells(cover: float, capsys: pytest.CaptureFixture[str]) -> None:
    wrong: dict[str, list[float]] = {name: [] for name in SETTINGS}
    covers = []
    for seed in SEEDS:
        shade = SkyShade(seed, cover=cover)
        images = [Imager().see(Land(seed), shade, float(at_s)) for at_s in TIMES_S]
        is_shade = [shade.transmittance(FIELD, float(t)) < SUNLIT_TRANSMITTANCE for t in TIMES_S]
        covers.append(np.mean([truth[FOOTPRINT].mean() for truth in is_shade]))
        for name, settings in SETTINGS.items():
            maps = shade_of(images, name.split(",")[0], settings)
            pairs = list(zip(maps, is_shade, strict=True))[COUNTED_FROM:]
            right = [(m.is_sunlit == truth)[FOOTPRINT].mean() for m, truth in pairs]
            wrong[name].append(float(np.mean(right)))
    with capsys.disabled():
        summary = "; ".join(
            f"{name} {np.mean(shares):.1%} ({min(shares):.1%} to {max(shares):.1%})"
            for name, shares in wrong.items()
        )
        print(f"\nwrong, cover {cover} (there: {np.mean(covers):.2f}): {summary}", flush=True)
    assert np.mean(wrong["brightness_ratio, ten minutes"]) < np.mean(wrong["otsu"])
