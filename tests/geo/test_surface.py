"""The bilinear ground against dense sampling and shapes whose extremes are known."""

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.geo import Surface
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame

FRAME = LocalFrame(GeoPoint(42.0, -93.6, 270.0))


def surface(heights: object, cell_m: float = 10.0) -> Surface:
    """Its upper-left middle is at (0, 0), columns go east and rows south."""
    values = np.asarray(heights, dtype=np.float64)
    rows, cols = values.shape
    return Surface(GroundGrid(FRAME, -cell_m / 2, cell_m / 2, cell_m, rows, cols), values)


SADDLE = surface([[0.0, 8.0], [8.0, 0.0]])


def test_heights_between_the_middles() -> None:
    ground = surface([[0.0, 10.0, 20.0], [4.0, 14.0, 24.0]])
    points = [[0, 0], [10, 0], [5, 0], [20, -10], [15, -5], [-0.1, 0], [20.1, 0], [5, -10.1]]
    expected = [0.0, 10.0, 5.0, 24.0, 17.0, np.nan, np.nan, np.nan]
    assert ground.heights_m(points) == pytest.approx(expected, nan_ok=True)


def thin(starts: npt.ArrayLike, ends: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return the triangles (N, 3, 2) without area that straight legs are."""
    return np.stack([np.asarray(starts), np.asarray(ends), np.asarray(ends)], axis=1)


def test_a_saddle_has_its_top_between_the_ends_of_a_leg() -> None:
    """From corner to corner of a cell the height is 16 s (1 - s): 4 in the middle."""
    leg = ([[0.0, 0.0]], [[10.0, -10.0]])
    assert SADDLE.highest_within_m(thin(*leg)) == pytest.approx([4.0])
    assert SADDLE.lowest_within_m(thin(*leg)) == pytest.approx([0.0])
    across = ([[10.0, 0.0]], [[0.0, -10.0]])
    assert SADDLE.highest_within_m(thin(*across)) == pytest.approx([8.0])
    assert SADDLE.lowest_within_m(thin(*across)) == pytest.approx([4.0])


def test_a_peak_inside_a_triangle_counts_and_one_beside_a_leg_does_not() -> None:
    heights = np.zeros((9, 9))
    heights[4, 4] = 50.0
    ground = surface(heights)
    triangle = [[[0, 0], [80, 0], [40, -80]]]
    assert ground.highest_within_m(triangle) == pytest.approx([50.0])
    assert ground.lowest_within_m(triangle) == pytest.approx([0.0])
    leg = [[[0, 0], [80, 0], [80, 0]]]
    assert ground.highest_within_m(leg) == pytest.approx([0.0])
    in_line_with_it = [[[0, -40], [20, -40], [20, -40]]]
    assert ground.highest_within_m(in_line_with_it) == pytest.approx([0.0])


def test_unknown_ground_gives_the_safe_answer() -> None:
    heights = np.zeros((4, 4))
    heights[1, 1] = np.nan
    ground = surface(heights)
    known, hole, outside = (
        [[[20, -20], [30, -30], [20, -30]]],
        [[[0, 0], [5, 0], [5, -5]]],
        [[[0, 0], [5, 0], [0, 1]]],
    )
    assert ground.highest_within_m(known) == pytest.approx([0.0])
    for triangle in (hole, outside):
        assert ground.highest_within_m(triangle).tolist() == [np.inf]
        assert ground.lowest_within_m(triangle).tolist() == [-np.inf]
        assert not ground.is_below(triangle, np.array([1e9])).any()
        assert not ground.is_above(triangle, np.array([-1e9])).any()
    around_it = [[[0, 0], [30, 0], [0, -30]]]
    assert ground.highest_within_m(around_it).tolist() == [np.inf]
    assert np.isnan(ground.heights_m([[5, -5]])).all()


@pytest.mark.parametrize("shape", [(1, 5), (5, 1), (2, 3)])
def test_an_invalid_surface_is_refused(shape: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="at least 2 each way"):
        Surface(GroundGrid(FRAME, 0.0, 0.0, 1.0, 2, 2), np.zeros(shape))


@given(seed=st.integers(0, 10_000))
def test_extremes_are_those_of_dense_samples(seed: int) -> None:
    random = np.random.default_rng(seed)
    rows, cols = random.integers(2, 20, 2)
    heights = random.uniform(-20.0, 20.0, (rows, cols))
    ground = surface(heights, cell_m=7.0)
    size_m = np.array([(cols - 1) * 7.0, -(rows - 1) * 7.0])
    triangles = random.uniform(0.0, 1.0, (5, 3, 2)) * size_m
    triangles[4, 2] = triangles[4, 1]
    highest, lowest = ground.highest_within_m(triangles), ground.lowest_within_m(triangles)
    weights = random.dirichlet([0.6, 0.6, 0.6], 4_000)
    for triangle, high, low in zip(triangles, highest, lowest, strict=True):
        samples = ground.heights_m(weights @ triangle)
        assert (samples <= high + 1e-9).all()
        assert (samples >= low - 1e-9).all()
        # No height changes by more than 40 m over a cell; 4,000 samples are close to any place.
        assert high - samples.max() < 25.0
        assert samples.min() - low < 25.0
    legs = triangles[:, 0], triangles[:, 1]
    along = np.linspace(0.0, 1.0, 5_001)[:, np.newaxis]
    highest, lowest = ground.highest_within_m(thin(*legs)), ground.lowest_within_m(thin(*legs))
    for start, end, high, low in zip(*legs, highest, lowest, strict=True):
        samples = ground.heights_m(start + along * (end - start))
        assert samples.max() <= high + 1e-9
        assert samples.min() >= low - 1e-9
        assert high - samples.max() < 0.05
        assert samples.min() - low < 0.05


@given(seed=st.integers(0, 10_000), height=st.floats(-25.0, 25.0))
def test_the_fast_answer_is_the_exact_one(seed: int, height: float) -> None:
    random = np.random.default_rng(seed)
    ground = surface(random.uniform(-20.0, 20.0, (17, 23)))
    triangles = random.uniform(-0.05, 1.05, (12, 3, 2)) * np.array([220.0, -160.0])
    triangles[:6] = triangles[:6, :1] + random.uniform(-15.0, 15.0, (6, 3, 2))
    heights = np.full(12, height)
    below, above = ground.is_below(triangles, heights), ground.is_above(triangles, heights)
    assert below.tolist() == (ground.highest_within_m(triangles) <= height).tolist()
    assert above.tolist() == (ground.lowest_within_m(triangles) >= height).tolist()


def test_empty_input_gives_empty_output() -> None:
    none = np.zeros((0, 3, 2))
    assert len(SADDLE.highest_within_m(none)) == 0
    assert len(SADDLE.is_below(none, np.zeros(0))) == 0
