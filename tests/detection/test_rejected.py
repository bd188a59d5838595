"""Frames that must not be read, each with its reason; the state stays as it was."""

from dataclasses import replace

import numpy as np
import pytest
from tests.detection.shaded_field import GRID, DriftingShade, Imager, Land

from recon.detection import (
    DETECTORS,
    DetectionSettings,
    DetectionState,
    Detector,
    FrameFault,
    RejectedFrame,
)
from recon.model.geo import GeoPoint, LocalFrame
from recon.model.imagery import GroundImage
from recon.model.shade import ShadeMap

SETTINGS = DetectionSettings()
LAND, SHADE, IMAGER = Land(7), DriftingShade(7), Imager()


@pytest.fixture(params=sorted(DETECTORS))
def detector(request: pytest.FixtureRequest) -> Detector:
    return DETECTORS[request.param]


@pytest.fixture
def flown(detector: Detector) -> DetectionState:
    """The state after a minute of good frames."""
    state = DetectionState()
    for i in range(12):
        state, found = detector(state, IMAGER.see(LAND, SHADE, 5.0 * i), SETTINGS)
        assert isinstance(found, ShadeMap)
    return state


def rejected(
    detector: Detector, state: DetectionState, image: GroundImage, fault: FrameFault
) -> str:
    after, found = detector(state, image, SETTINGS)
    assert isinstance(found, RejectedFrame)
    assert (found.frame_id, found.fault) == (image.frame_id, fault)
    assert after is state
    return found.reason


def good() -> GroundImage:
    return IMAGER.see(LAND, SHADE, 60.0)


def test_the_good_frame_itself_is_read(detector: Detector, flown: DetectionState) -> None:
    assert isinstance(detector(flown, good(), SETTINGS)[1], ShadeMap)


def test_black(detector: Detector, flown: DetectionState) -> None:
    noise = np.random.default_rng(1).integers(0, 9, (*good().valid.shape, 3), dtype=np.uint8)
    reason = rejected(detector, flown, IMAGER.image(noise, 60.0), FrameFault.BLACK)
    assert reason.startswith("expected an image, got black")


@pytest.mark.parametrize("filled_with", [128, 0, 255])
def test_torn(detector: Detector, flown: DetectionState, filled_with: int) -> None:
    rgb = good().rgb.copy()
    rgb[160:] = filled_with
    reason = rejected(detector, flown, IMAGER.image(rgb, 60.0), FrameFault.TORN)
    assert f"at level {filled_with} of 255" in reason


def test_repeated(detector: Detector, flown: DetectionState) -> None:
    again = IMAGER.image(IMAGER.see(LAND, SHADE, 55.0).rgb, 60.0)
    assert "a copy of the last one" in rejected(detector, flown, again, FrameFault.REPEATED)


@pytest.mark.parametrize("at_s", [55.0, 54.0, 0.0])
def test_not_newer(detector: Detector, flown: DetectionState, at_s: float) -> None:
    reason = rejected(detector, flown, IMAGER.see(LAND, SHADE, at_s), FrameFault.NOT_NEWER)
    assert f"taken {55.0 - at_s:.1f} s before" in reason


def test_of_another_place(detector: Detector, flown: DetectionState) -> None:
    elsewhere = replace(GRID, frame=LocalFrame(GeoPoint(44.6, -92.9, 320.0)))
    image = replace(good(), grid=elsewhere)
    assert "origin" in rejected(detector, flown, image, FrameFault.OTHER_PLACE)
    beside = replace(good(), grid=replace(GRID, west_m=GRID.west_m + 900.0))
    assert "got 0.0%" in rejected(detector, flown, beside, FrameFault.OTHER_PLACE)
    unseen = replace(good(), valid=np.zeros_like(good().valid))
    assert "without any valid pixel" in rejected(detector, flown, unseen, FrameFault.OTHER_PLACE)


def test_a_rejected_first_frame_leaves_the_state_unchanged(detector: Detector) -> None:
    start = DetectionState()
    black = IMAGER.image(np.zeros((*good().valid.shape, 3), np.uint8), 0.0)
    rejected(detector, start, black, FrameFault.BLACK)
