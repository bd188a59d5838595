"""How well shade is found on drawn fields under drawn shadows, method beside method.

uv run python -m pytest benches/detection/test_detection_agreement.py -s
"""

import numpy as np
import pytest
from tests.detection.flights import Watch, shade_of

from recon.detection import DETECTORS

SEEDS = range(20_000, 20_008)
SCENES = {
    "few shadows": {"cover": 0.15},
    "many shadows": {"cover": 0.4},
    "frames placed 2 m off": {"cover": 0.4, "placed_m": 2.0},
    "exposure halves every 30 s": {"cover": 0.4, "gains": (1.0, 0.5)},
}


@pytest.mark.parametrize("scene", SCENES)
def test_shade_iou(scene: str, capsys: pytest.CaptureFixture[str]) -> None:
    found: dict[str, list[float]] = {method: [] for method in DETECTORS}
    for seed in SEEDS:
        watch = Watch(seed, **SCENES[scene])  # type: ignore[arg-type]
        images = watch.images()
        for method in DETECTORS:
            found[method].append(watch.mean_iou(shade_of(images, method)))
    with capsys.disabled():
        scores_text = ", ".join(
            f"{method} {np.mean(ious):.2f} ({min(ious):.2f} to {max(ious):.2f})"
            for method, ious in found.items()
        )
        print(f"\nshade IoU, {scene}, {len(SEEDS)} seeds: {scores_text}", flush=True)
    assert np.mean(found["brightness_ratio"]) > np.mean(found["otsu"])
