"""Speed of one frame's shade, beside plain numpy over the same history; the bound asserted.

uv run python -m pytest benches/detection -s
"""

from time import process_time

import cv2
import numpy as np
import pytest
from tests.detection.shaded_field import FRAME, DriftingShade, Imager, Land

from recon.detection import DETECTORS, DetectionSettings, DetectionState
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap

MOST_MS = 30.0
GRID = GroundGrid(FRAME, -256.0, 256.0, 1.0, 512, 512)
EVERY_S = 1.25
"""Every fourth frame is kept as a sample, which is the dearest step."""


@pytest.mark.parametrize("method", sorted(DETECTORS))
def test_a_frame_of_512_by_512_takes_under_30_ms(
    method: str, capsys: pytest.CaptureFixture[str]
) -> None:
    cv2.setNumThreads(1)
    imager, land, shade = Imager(grid=GRID), Land(1), DriftingShade(1)
    images = [imager.see(land, shade, EVERY_S * i) for i in range(120)]
    stack = np.stack([image.rgb[..., 1] for image in images[:24]]).astype(np.float32)
    settings, state = DetectionSettings(), DetectionState()
    taken_ms, copy_ms, percentile_ms = [], [], []
    for i, image in enumerate(images):
        start = process_time()
        state, found = DETECTORS[method](state, image, settings)
        taken_ms.append((process_time() - start) * 1e3)
        assert isinstance(found, ShadeMap)
        start = process_time()
        image.rgb.astype(np.float32)
        copy_ms.append((process_time() - start) * 1e3)
        if i % 40 == 0:
            start = process_time()
            np.percentile(stack, 90.0, axis=0)
            percentile_ms.append((process_time() - start) * 1e3)
    # The history is full from the 96th frame on.
    full_ms = np.array(taken_ms[96:])
    with capsys.disabled():
        print(
            f"\n{method}, 512x512 frame: {np.median(full_ms):.2f} ms (worst of 24 "
            f"{full_ms.max():.2f}); {np.median(full_ms) / np.median(copy_ms):.1f}x a copy of the "
            f"frame as floats ({np.median(copy_ms):.2f} ms), "
            f"{np.median(percentile_ms) / np.median(full_ms):.0f}x as fast as numpy's percentile "
            f"over 24 whole frames ({np.median(percentile_ms):.0f} ms)",
            flush=True,
        )
    assert np.median(full_ms) < MOST_MS
    assert np.median(full_ms) < np.median(percentile_ms)
