"""What is sorted out before trajectories are compared piece by piece never meets."""

from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.safety.traffic import SETTINGS

from recon.safety.prediction.conflicts import first_conflict
from recon.safety.prediction.predicted_trajectories import may_conflict, trajectory_bounds
from recon.safety.prediction.trajectory import FlightPart, Trajectory, TrajectoryWriter
from recon.safety.separation_minima import SeparationMinima

NEED = SeparationMinima(horizontal_m=15.0, vertical_m=8.0)

places_m = st.floats(-120.0, 120.0)
heights_m = st.floats(20.0, 70.0)


@st.composite
def trajectories(draw: st.DrawFn) -> Trajectory:
    """Some straight pieces, with bands of heights and growing discs; at the end it stays."""
    height_m = draw(heights_m)
    writer = TrajectoryWriter(draw(places_m), draw(places_m), height_m, height_m)
    for _ in range(draw(st.integers(1, 4))):
        low_m = draw(heights_m)
        writer.moves(
            draw(places_m),
            draw(places_m),
            draw(st.floats(1.0, 20.0)),
            0,
            curve=draw(st.sampled_from([0.0, 0.001])),
            band_m=(low_m, low_m + draw(st.floats(0.0, 5.0))),
            radius_m=draw(st.sampled_from([None, 3.0, 10.0])),
        )
    if draw(st.booleans()):
        writer.stays(FlightPart.HOVERING)
    return writer.trajectory("SIM-1", "SIM-1")


@settings(max_examples=examples(300))
@given(trajectories(), trajectories())
def test_what_meets_is_never_sorted_out(own: Trajectory, other: Trajectory) -> None:
    if first_conflict(own, [other], NEED, SETTINGS) is not None:
        assert may_conflict(other, trajectory_bounds(own, NEED, SETTINGS))


def standing(east_m: float, up_m: float) -> Trajectory:
    writer = TrajectoryWriter(east_m, 0.0, up_m, up_m)
    writer.stays(FlightPart.HOVERING)
    return writer.trajectory("SIM-2", "SIM-2")


def test_what_is_elsewhere_or_at_other_heights_is_sorted_out() -> None:
    around = trajectory_bounds(standing(0.0, 40.0), NEED, SETTINGS)
    assert may_conflict(standing(14.9, 40.0), around)
    assert not may_conflict(standing(15.1, 40.0), around)
    assert may_conflict(standing(0.0, 47.9), around)
    assert not may_conflict(standing(0.0, 48.1), around)
    assert not may_conflict(standing(0.0, 31.9), around)


def test_what_is_nowhere_is_in_doubt() -> None:
    around = trajectory_bounds(standing(0.0, 40.0), NEED, SETTINGS)
    assert may_conflict(standing(float("nan"), 40.0), around)
    assert may_conflict(standing(0.0, float("nan")), around)
