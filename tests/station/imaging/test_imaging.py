"""Which telemetry a frame of the imaging drone is projected with."""

from dataclasses import replace

import numpy as np
import pytest

from recon.camera.motion import TelemetryReference
from recon.camera.registration import RegistrationState
from recon.model.event import Event
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.imagery import CameraPose, Frame, GroundImage, Registration
from recon.model.units import NS_PER_S, Stamped
from recon.model.vehicle import Attitude, VehicleState
from recon.station.alarms.conditions import conditions
from recon.station.imaging.frames import LAY_FRAME, LOST_FOR_S, lay_job, with_sample
from recon.station.imaging.projection import LaidFrame
from recon.station.kernel.step import step
from recon.station.state.imaging import Imaging
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobDone, JobDropped, JobFailed

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
    seen = replace(seen, job_id=None)
    seen, second = lay_job(seen, frame(4.9), is_flying=True)
    assert first is not None
    assert second is not None
    assert seen.is_reference_assumed
    assert first.input.reference == first.input.telemetry
    assert second.input.reference == first.input.reference
    assert second.id == first.id + 1


def test_one_frame_at_a_time_and_the_newest_of_the_others_waits() -> None:
    """What registration keeps must come back before the next frame is aligned."""
    imaging, first = lay_job(observed(5), frame(4.0), is_flying=True)
    assert first is not None
    for captured_at_s in (4.2, 4.4, 4.6):
        imaging, job = lay_job(imaging, frame(captured_at_s), is_flying=True)
        assert job is None
    assert imaging.frames_dropped == 2
    kept = RegistrationState(turn=7)
    laid = LaidFrame(image(Registration.REGISTERED), kept)
    station, outputs = step(Station(imaging=imaging), JobDone(first.id, LAY_FRAME, laid), 0)
    (waited,) = (job for job in outputs if isinstance(job, Job) and job.kind is LAY_FRAME)
    assert waited.input.frame.captured_at_ns == round(4.6 * NS_PER_S)
    assert waited.input.registration is kept
    assert station.imaging.waiting is None


@pytest.mark.parametrize("ends", [JobFailed(1, LAY_FRAME, "damaged"), JobDropped(1, LAY_FRAME)])
def test_a_frame_that_fails_holds_up_none_after_it(ends: Event) -> None:
    imaging, _ = lay_job(observed(5), frame(4.0), is_flying=True)
    imaging, _ = lay_job(imaging, frame(4.5), is_flying=True)
    station, outputs = step(Station(imaging=imaging), ends, 0)
    assert [job.id for job in outputs if isinstance(job, Job)] == [2]
    station, _ = step(station, JobFailed(2, LAY_FRAME, "damaged"), 0)
    _, third = lay_job(station.imaging, frame(4.9), is_flying=True)
    assert third is not None


def test_a_lost_registration_is_an_alarm_with_its_reason_until_it_is_found() -> None:
    imaging, _ = lay_job(observed(5), frame(4.0), is_flying=True)
    laid = LaidFrame(image(Registration.LOST), problem="5 of 200 features in view found again")
    station, _ = step(Station(imaging=imaging), JobDone(1, LAY_FRAME, laid), 0)
    (alarm,) = (each for each in conditions(station, 0) if each.rule == "registration")
    assert "5 of 200 features" in alarm.text
    assert alarm.after_s == LOST_FOR_S
    landed, _ = step(station, JobFailed(2, LAY_FRAME, "the camera is on the ground"), 0)
    assert [each for each in conditions(landed, 0) if each.rule == "registration"] == []
    found = LaidFrame(image(Registration.REGISTERED, captured_at_s=5.0))
    station, _ = step(station, JobDone(2, LAY_FRAME, found), 0)
    assert [each for each in conditions(station, 0) if each.rule == "registration"] == []


def image(registration: Registration, captured_at_s: float = 4.0) -> GroundImage:
    grid = GroundGrid(LocalFrame(GeoPoint(41.9, -93.6, 300.0)), -8.0, 8.0, 1.0, 16, 16)
    return GroundImage(
        grid,
        1,
        round(captured_at_s * NS_PER_S),
        np.zeros((16, 16, 3), np.uint8),
        np.ones((16, 16), np.bool_),
        CameraPose(np.eye(3), np.array([0.0, 0.0, 120.0])),
        registration,
    )
