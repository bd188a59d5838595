"""The study of shade methods on real ground, on a few small frames."""

import argparse
from pathlib import Path

from studies.real_footage import figures
from tests.real_footage.footage import FootageSettings


def test_the_study_scores_a_method(fisheye_data: Path) -> None:
    options = argparse.Namespace(cols=320, frames=9, telemetry=False)
    found = figures(fisheye_data, "elgin-5", "otsu", FootageSettings(seed=3), options)
    # Three frames are scored: those from 30 s on. Each shows most of 128 x 128 cells.
    assert 3 * 9_000 < found.cells <= 3 * 128 * 128
    assert found.iou is not None
    assert found.iou > 0.3
