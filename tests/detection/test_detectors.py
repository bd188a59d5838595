"""What holds of every method, on frames of any content."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.detection.shaded_field import FRAME, DriftingShade, Imager, Land
from tests.examples import examples

from recon.detection import DETECTORS, DetectionSettings, DetectionState, RejectedFrame
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.shade import SUNLIT_TRANSMITTANCE, ShadeMap

SMALL = GroundGrid(FRAME, -40.0, 40.0, 2.0, 40, 36)
SETTINGS = DetectionSettings(window_s=10.0, samples=5, least_samples=2)

methods = pytest.mark.parametrize("method", sorted(DETECTORS))


def drawn_image(rng: np.random.Generator, i: int) -> GroundImage:
    """Any levels between two bounds, any part of it seen, anywhere near."""
    low, high = sorted(rng.integers(0, 257, 2))
    levels = rng.integers(low, max(high, low + 1), (SMALL.rows, SMALL.cols, 3))
    valid = rng.random((SMALL.rows, SMALL.cols)) < rng.choice([0.0, 0.3, 0.9, 1.0])
    west_m, north_m = rng.uniform(-60.0, -20.0), rng.uniform(20.0, 60.0)
    grid = GroundGrid(FRAME, west_m, north_m, 2.0, SMALL.rows, SMALL.cols)
    at_ns = round(i * 1.3e9) - (2_000_000_000 if rng.random() < 0.1 else 0)
    pose = Imager(grid=SMALL).image(np.zeros((SMALL.rows, SMALL.cols, 3)), 0.0).pose
    rgb = np.where(valid[..., np.newaxis], levels, 0).astype(np.uint8)
    return GroundImage(grid, i, at_ns, rgb, valid, pose, serial="IMAGER")


def check(found: ShadeMap, image: GroundImage) -> None:
    shape = (found.grid.rows, found.grid.cols)
    assert found.captured_at_ns == image.captured_at_ns
    assert found.source_serials == ("IMAGER",)
    arrays = (found.transmittance, found.confidence, found.metres_per_pixel)
    assert all(array.shape == shape and array.dtype == np.float32 for array in arrays)
    assert found.valid.dtype == np.bool_
    known = found.transmittance[found.valid]
    assert ((known >= 0.0) & (known <= 1.0)).all()
    assert np.isnan(found.transmittance[~found.valid]).all()
    assert np.isnan(found.metres_per_pixel[~found.valid]).all()
    assert (found.metres_per_pixel[found.valid] > 0.0).all()
    assert ((found.confidence >= 0.0) & (found.confidence <= 1.0)).all()
    assert (found.confidence[~found.valid] == 0.0).all()
    assert not (found.is_sunlit & ~found.valid).any()


@methods
@settings(max_examples=examples(40))
@given(seed=st.integers(0, 2**32))
def test_any_frames_give_sound_and_repeatable_maps(method: str, seed: int) -> None:
    runs: list[list[ShadeMap | RejectedFrame]] = [[], []]
    for run in runs:
        rng = np.random.default_rng(seed)
        state = DetectionState()
        for i in range(12):
            image = drawn_image(rng, i)
            before = image.rgb.copy(), image.valid.copy()
            state, found = DETECTORS[method](state, image, SETTINGS)
            assert np.array_equal(before[0], image.rgb)
            assert np.array_equal(before[1], image.valid)
            if isinstance(found, ShadeMap):
                check(found, image)
            run.append(found)
    for one, other in zip(*runs, strict=True):
        if isinstance(one, RejectedFrame) or isinstance(other, RejectedFrame):
            assert one == other
        else:
            assert np.array_equal(one.transmittance, other.transmittance, equal_nan=True)
            assert np.array_equal(one.confidence, other.confidence)
            assert np.array_equal(one.valid, other.valid)


@methods
def test_a_step_from_an_old_state_gives_the_same_again(method: str) -> None:
    """States are values: what came after does not reach back into them."""
    step, imager, land, shade = DETECTORS[method], Imager(grid=SMALL), Land(8), DriftingShade(8)
    settings_ = DetectionSettings(least_samples=1, cell_m=4.0)
    states = [DetectionState()]
    maps = []
    for i in range(6):
        state, found = step(states[-1], imager.see(land, shade, 6.0 * i), settings_)
        assert isinstance(found, ShadeMap)
        states.append(state)
        maps.append(found)
    for i in (4, 1):
        _, again = step(states[i], imager.see(land, shade, 6.0 * i), settings_)
        assert isinstance(again, ShadeMap)
        assert np.array_equal(again.transmittance, maps[i].transmittance, equal_nan=True)


@methods
def test_a_dark_and_bluer_patch_that_appears_is_shade(method: str) -> None:
    """On even ground, where any method must see it; corners may be rounded."""
    rng = np.random.default_rng(3)
    state, imager = DetectionState(), Imager(grid=SMALL)
    for i in range(9):
        levels = rng.normal(150.0, 3.0, (SMALL.rows, SMALL.cols, 3))
        if i >= 7:
            levels[10:26, 10:26] *= (0.5, 0.6, 0.7)
        image = imager.image(np.rint(levels).astype(np.uint8), 5.0 * i)
        state, found = DETECTORS[method](state, image, DetectionSettings())
    assert isinstance(found, ShadeMap)
    expected = np.zeros((20, 18), bool)
    expected[5:13, 5:13] = True
    wrong = (found.valid & (found.transmittance < SUNLIT_TRANSMITTANCE)) != expected
    assert np.count_nonzero(wrong) <= 12
    assert not wrong[6:12, 6:12].any()
