"""Trajectories written row by row, in metres east and north in the plane and up."""

from hypothesis import strategies as st

from recon.safety.prediction import FlightPart, Trajectory
from recon.safety.prediction.trajectory import TrajectoryWriter
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
    return writer.trajectory("SIM-1")


def writer_at(east_m: float, north_m: float = 0.0, up_m: float = 40.0) -> TrajectoryWriter:
    return TrajectoryWriter(east_m, north_m, up_m, up_m)


def standing(east_m: float, up_m: float = 40.0, north_m: float = 0.0) -> Trajectory:
    writer = writer_at(east_m, north_m, up_m)
    writer.stays(FlightPart.HOVERING)
    return writer.trajectory("SIM-2")
