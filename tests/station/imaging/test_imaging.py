"""Which telemetry a frame of the imaging drone is projected with."""

from dataclasses import replace

import numpy as np
import pytest

from recon.camera.motion import TelemetryReference
from recon.camera.registration import RegistrationState
from recon.model.event import Event, ImagerMarked
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.imagery import CameraPose, Frame, GroundImage, Outlook, Registration
from recon.model.units import NS_PER_S, Stamped
from recon.model.vehicle import Attitude, VehicleState
from recon.station.alarms.conditions import conditions
from recon.station.imaging.frames import (
    LOST_FOR_S,
    PROJECT_FRAME,
    started,
    with_frame,
    with_sample,
)
from recon.station.imaging.projection import ProjectedFrame
from recon.station.kernel.step import step
from recon.station.state.imaging import ImagerFrames, Imaging, LayMarkedFrame, ProjectFrame
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


def frame(captured_at_s: float, serial: str = "IMAGER") -> Frame:
    captured_at_ns = round(captured_at_s * NS_PER_S)
    return Frame(1, serial, captured_at_ns, captured_at_ns, 0.25, rgb=np.zeros((2, 2, 3), np.uint8))


def observed(seconds: int, kept: int = 50) -> ImagerFrames:
    """Ten samples a second; the height identifies them."""
    seen = ImagerFrames("IMAGER", MARKED, is_reference_assumed=False)
    for tick in range(10 * seconds):
        seen = with_sample(seen, imager(tick / 10), tick * NS_PER_S // 10, kept)
    return seen


def station_of(*imagers: ImagerFrames) -> Station:
    return Station(imaging=Imaging({each.serial: each for each in imagers}))


def offered(
    station: Station, captured_at_s: float, *, is_flying: bool = True, serial: str = "IMAGER"
) -> tuple[Station, Job[ProjectFrame, ProjectedFrame] | None]:
    """Return the station after a frame, and the job that it starts."""
    seen = with_frame(station.imaging.imagers[serial], frame(captured_at_s, serial), is_flying)
    imagers = {**station.imaging.imagers, serial: seen}
    station, outputs = started(station, replace(station.imaging, imagers=imagers))
    return station, next((job for job in outputs if isinstance(job, Job)), None)


def only(station: Station) -> ImagerFrames:
    (seen,) = station.imaging.imagers.values()
    return seen


@pytest.mark.parametrize("captured_at_s", [4.0, 3.52, 2.16])
def test_the_telemetry_at_capture_is_taken_not_the_newest(captured_at_s: float) -> None:
    _, work = offered(station_of(observed(5)), captured_at_s)
    assert work is not None
    height_m = work.input.telemetry.height_above_takeoff_m
    assert height_m == pytest.approx(captured_at_s, abs=0.051)


@pytest.mark.parametrize("kept", [1, 2, 50])
def test_samples_are_bounded(kept: int) -> None:
    seen = observed(20, kept)
    assert len(seen.samples) == kept
    assert seen.samples[-1].at_ns == round(19.9 * NS_PER_S)


def test_incomplete_telemetry_is_not_kept() -> None:
    seen = ImagerFrames("IMAGER", MARKED)
    assert with_sample(seen, imager(None), 0, 50) is seen


def test_a_frame_far_from_all_telemetry_is_an_error() -> None:
    station, work = offered(station_of(observed(5)), 60.0)
    assert work is None
    error = only(station).latest_error
    assert error is not None
    assert "no telemetry" in error


def test_a_short_dropout_is_bridged() -> None:
    _, work = offered(station_of(observed(5)), 7.0)
    assert work is not None


def test_without_a_marked_frame_the_first_in_flight_takes_its_place() -> None:
    unmarked = ImagerFrames("IMAGER", samples=observed(5).samples)
    on_ground, work = offered(station_of(unmarked), 4.0, is_flying=False)
    assert work is None
    assert only(on_ground).reference is None
    seen, first = offered(on_ground, 4.0)
    seen = replace(seen, imaging=replace(seen.imaging, job_id=None))
    seen, second = offered(seen, 4.9)
    assert first is not None
    assert second is not None
    assert only(seen).is_reference_assumed
    assert first.input.reference == first.input.telemetry
    assert second.input.reference == first.input.reference
    assert second.id == first.id + 1


def test_one_frame_at_a_time_and_the_newest_of_the_others_waits() -> None:
    """What registration keeps must come back before the next frame is aligned."""
    station, first = offered(station_of(observed(5)), 4.0)
    assert first is not None
    for captured_at_s in (4.2, 4.4, 4.6):
        station, job = offered(station, captured_at_s)
        assert job is None
    assert only(station).frames_dropped == 2
    kept = RegistrationState(turn=7)
    projected = ProjectedFrame(image(Registration.REGISTERED), kept)
    station, outputs = step(station, JobDone(first.id, PROJECT_FRAME, projected), 0)
    (waited,) = (job for job in outputs if isinstance(job, Job) and job.kind is PROJECT_FRAME)
    assert waited.input.frame.captured_at_ns == round(4.6 * NS_PER_S)
    assert waited.input.registration is kept
    assert only(station).waiting is None


@pytest.mark.parametrize(
    "ends", [JobFailed(1, PROJECT_FRAME, "damaged"), JobDropped(1, PROJECT_FRAME)]
)
def test_a_frame_that_fails_holds_up_none_after_it(ends: Event) -> None:
    station, _ = offered(station_of(observed(5)), 4.0)
    station, _ = offered(station, 4.5)
    station, outputs = step(station, ends, 0)
    assert [job.id for job in outputs if isinstance(job, Job)] == [2]
    station, _ = step(station, JobFailed(2, PROJECT_FRAME, "damaged"), 0)
    _, third = offered(station, 4.9)
    assert third is not None


def test_a_lost_registration_is_an_alarm_with_its_reason_until_it_is_found() -> None:
    station, _ = offered(station_of(observed(5)), 4.0)
    projected = ProjectedFrame(
        image(Registration.LOST), problem="5 of 200 features in view found again"
    )
    station, _ = step(station, JobDone(1, PROJECT_FRAME, projected), 0)
    (alarm,) = (each for each in conditions(station, 0) if each.rule == "registration")
    assert "5 of 200 features" in alarm.text
    assert alarm.after_s == LOST_FOR_S
    station, _ = offered(station, 4.9)
    landed, _ = step(station, JobFailed(2, PROJECT_FRAME, "the camera is on the ground"), 0)
    assert [each for each in conditions(landed, 0) if each.rule == "registration"] == []
    found = ProjectedFrame(image(Registration.REGISTERED, captured_at_s=5.0))
    station, _ = step(station, JobDone(2, PROJECT_FRAME, found), 0)
    assert [each for each in conditions(station, 0) if each.rule == "registration"] == []


def test_an_older_image_and_the_failure_of_another_job_change_nothing() -> None:
    station, _ = offered(station_of(observed(5)), 4.0)
    for ends in (JobFailed(7, PROJECT_FRAME, "damaged"), JobDropped(7, PROJECT_FRAME)):
        assert step(station, ends, 0)[0].imaging is station.imaging
    newest = image(Registration.REGISTERED, captured_at_s=4.0)
    station, _ = step(station, JobDone(1, PROJECT_FRAME, ProjectedFrame(newest)), 0)
    station, _ = offered(station, 4.5)
    older = ProjectedFrame(image(Registration.REGISTERED, captured_at_s=3.0))
    station, outputs = step(station, JobDone(2, PROJECT_FRAME, older), 0)
    assert only(station).ground_image is newest
    assert outputs == ()


class TestSeveral:
    """One job at a time for all imaging drones; each has its own memory."""

    @staticmethod
    def two() -> Station:
        return station_of(observed(5), replace(observed(5), serial="OTHER"))

    def test_the_one_that_waits_longest_is_next(self) -> None:
        station, first = offered(self.two(), 4.0)
        station, _ = offered(station, 4.1, serial="OTHER")
        station, _ = offered(station, 4.2)
        assert first is not None
        kept = RegistrationState(turn=7)
        projected = ProjectedFrame(image(Registration.REGISTERED), kept)
        station, outputs = step(station, JobDone(first.id, PROJECT_FRAME, projected), 0)
        (second,) = (job for job in outputs if isinstance(job, Job) and job.kind is PROJECT_FRAME)
        assert second.input.frame.serial == "OTHER"
        assert second.input.registration is not kept
        station, outputs = step(station, JobFailed(second.id, PROJECT_FRAME, "damaged"), 0)
        (third,) = (job for job in outputs if isinstance(job, Job) and job.kind is PROJECT_FRAME)
        assert third.input.frame.serial == "IMAGER"
        assert third.input.registration is kept

    def test_each_has_its_own_alarm(self) -> None:
        station, _ = offered(self.two(), 60.0, serial="OTHER")
        (alarm,) = (each for each in conditions(station, 0) if each.rule == "imaging")
        assert alarm.serial == "OTHER"
        station, _ = offered(station, 60.0)
        keys = {each.key for each in conditions(station, 0) if each.rule == "imaging"}
        assert len(keys) == 2


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
        serial="IMAGER",
    )


def test_a_new_marked_frame_places_the_next_frame_and_begins_registration_anew() -> None:
    station = station_of(replace(observed(5), reference=TelemetryReference(0.0, 0.0, 100.0, 0.0)))
    station, _ = offered(station, 2.0)
    assert station.imaging.job_id is not None
    marked = TelemetryReference(45.0, 9.0, 80.0, 10.0)
    pose = CameraPose(np.eye(3), np.array([1.0, 2.0, 80.0]))
    event = ImagerMarked("IMAGER", pose, marked, Outlook(1.0), 0.5, "anna")
    before = station
    station, _ = step(station, event, NS_PER_S)
    imager_now = only(station)
    assert (imager_now.reference, imager_now.is_reference_assumed) == (marked, False)
    # The running job aligns by the old pose: the next frame does not wait for it.
    station, job = offered(station, 4.0)
    assert job is not None
    assert isinstance(job.input, LayMarkedFrame)
    assert (job.input.marked_pose, job.input.reference) == (pose, marked)
    other = replace(event, serial="SIM-9")
    assert step(before, other, NS_PER_S)[0].imaging is before.imaging
