"""A first shade map: pictures of a field under drifting clouds, and the shade found in them.

Run: uv run python examples/07_first_shade_map.py
"""

from pathlib import Path

import numpy as np

from recon.detection import DETECTORS, DetectionSettings, DetectionState, RejectedFrame
from recon.geo import nearest_cells
from recon.model.imagery import CameraPose, GroundImage
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.model.units import seconds_to_ns
from recon.score import load_scenario
from recon.score.scenario_sky import sky_of

SCENARIO = Path(__file__).parents[1] / "scenarios/cumulus-40.toml"
SKYLIGHT = 0.25
"""Brightness of ground in shade, of that in sun."""


def main() -> None:
    """Draw a field for two minutes, detect its shade, and compare with the true sky."""
    scenario = load_scenario(SCENARIO)
    grid, sky = scenario.site.ground_grid, sky_of(scenario, seed=7)
    assert grid is not None
    ground = np.random.default_rng(1).integers(60, 200, (grid.rows, grid.cols, 3))
    seen = np.ones((grid.rows, grid.cols), dtype=np.bool_)
    pose = CameraPose(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 120.0]))

    detect, settings = DETECTORS["brightness_ratio"], DetectionSettings()
    state = DetectionState()
    for second in range(0, 126, 5):
        light = SKYLIGHT + (1.0 - SKYLIGHT) * sky.on_grid(grid, second)[..., np.newaxis]
        pixels = (ground * light ** (1.0 / 2.2)).astype(np.uint8)
        image = GroundImage(grid, second, seconds_to_ns(second), pixels, seen, pose)
        state, shade = detect(state, image, settings)

    assert not isinstance(shade, RejectedFrame)
    rows, cols, _ = nearest_cells(grid, shade.grid)
    true = sky.on_grid(grid, second)[rows, cols] < SUNLIT_TRANSMITTANCE
    found = shade.valid & (shade.transmittance < SUNLIT_TRANSMITTANCE)
    print(f"in shade: {true.mean():.0%} of the field, found {found.mean():.0%}")
    print(f"intersection over union: {(true & found).sum() / (true | found).sum():.2f}")


if __name__ == "__main__":
    main()
