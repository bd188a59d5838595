"""Which telemetry a frame of the imaging drone is projected with."""

import numpy as np
import pytest

from recon.camera.motion import TelemetryReference
from recon.model.geo import LatLon
from recon.model.imagery import Frame
from recon.model.units import NS_PER_S, Stamped
from recon.model.vehicle import Attitude, VehicleState
from recon.station.imaging.frames import lay_job, with_sample
from recon.station.state.imaging import Imaging

MARKED = TelemetryReference(41.9, -93.6, 130.0, 0.0, 0.0, 0.0)


def imager(height_m: float | None) -> VehicleState:
    return VehicleState(
        serial="IMAGER",
        position=Stamped(LatLon(41.9, -93.6), 0),
        height_above_takeoff_m=Stamped(height_m, 0),
        attitude=Stamped(Attitude(0.0, 0.0, 0.0), 0),
    )


def frame(captured_at_s: float) -> Frame:
    captured_at_ns = round(captured_at_s * NS_PER_S)
    return Frame(
        1, "IMAGER", captured_at_ns, captured_at_ns, 0.25, rgb=np.zeros((2, 2, 3), np.uint8)
    )


def observed(seconds: int, kept: int = 50) -> Imaging:
    """Ten samples a second; the height identifies them."""
    imaging = Imaging("IMAGER", MARKED, is_reference_assumed=False)
    for tick in range(10 * seconds):
        imaging = with_sample(imaging, imager(tick / 10), tick * NS_PER_S // 10, kept)
    return imaging


@pytest.mark.parametrize("captured_at_s", [4.0, 3.52, 2.16])
def test_the_telemetry_at_capture_is_taken_not_the_newest(captured_at_s: float) -> None:
    _, work = lay_job(observed(5), frame(captured_at_s), is_flying=True)
    assert work is not None
    height_m = work.input.telemetry.height_above_takeoff_m
    assert height_m == pytest.approx(captured_at_s, abs=0.051)


@pytest.mark.parametrize("kept", [1, 2, 50])
def test_samples_are_bounded(kept: int) -> None:
    imaging = observed(20, kept)
    assert len(imaging.samples) == kept
    assert imaging.samples[-1].at_ns == round(19.9 * NS_PER_S)


def test_incomplete_telemetry_is_not_kept() -> None:
    imaging = Imaging("IMAGER", MARKED)
    assert with_sample(imaging, imager(None), 0, 50) is imaging


def test_a_frame_far_from_all_telemetry_is_an_error() -> None:
    imaging, work = lay_job(observed(5), frame(60.0), is_flying=True)
    assert work is None
    assert imaging.latest_error is not None
    assert "no telemetry" in imaging.latest_error


def test_a_short_dropout_is_bridged() -> None:
    _, work = lay_job(observed(5), frame(7.0), is_flying=True)
    assert work is not None


def test_without_a_marked_frame_the_first_in_flight_takes_its_place() -> None:
    imaging = observed(5)
    unmarked = Imaging("IMAGER", samples=imaging.samples)
    on_ground, work = lay_job(unmarked, frame(4.0), is_flying=False)
    assert work is None
    assert on_ground.reference is None
    seen, first = lay_job(on_ground, frame(4.0), is_flying=True)
    _, second = lay_job(seen, frame(4.9), is_flying=True)
    assert first is not None
    assert second is not None
    assert seen.is_reference_assumed
    assert first.input.reference == first.input.telemetry
    assert second.input.reference == first.input.reference
    assert second.id == first.id + 1
