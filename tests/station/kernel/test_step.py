"""Frames and heavy work in the station's step."""

from typing import get_args

import numpy as np
from tests.fleet.reports import core, extended
from tests.station.commanded import CommandedStation
from tests.station.imagers import imager_of, with_imagers

from recon.model.event import Event, JobEnded
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, GroundImage
from recon.model.report import ImageReport, MessageReport, MessageSeverity
from recon.model.units import seconds_to_ns
from recon.station.imaging.frames import PROJECT_FRAME
from recon.station.imaging.projection import ProjectedFrame
from recon.station.kernel.step import HANDLERS
from recon.station.state.settings import StationSettings
from recon.station.state.station import Station
from recon.station.state.steps import JobDone, JobDropped, JobFailed

IMAGE = ImageReport(target_fps_hz=1.0, jpeg=b"x")


def imaging_scene(serial: str = "IMAGER") -> CommandedStation:
    scene = CommandedStation()
    scene.station = with_imagers(scene.station, serial)
    return scene


def ground_image(captured_at_ns: int) -> GroundImage:
    return GroundImage(
        grid=GroundGrid(LocalFrame(GeoPoint(42.0, -93.6, 275.0)), 0.0, 1.0, 1.0, 1, 1),
        frame_id=1,
        captured_at_ns=captured_at_ns,
        rgb=np.zeros((1, 1, 3), np.uint8),
        valid=np.ones((1, 1), np.bool_),
        pose=CameraPose(np.eye(3), np.zeros(3)),
        serial="IMAGER",
    )


def test_every_event_has_a_handler() -> None:
    events = {*get_args(Event)} - {JobEnded} | {JobDone, JobFailed, JobDropped}
    assert set(HANDLERS) == events


def test_the_newest_frame_of_each_vehicle_is_kept_with_its_capture_time() -> None:
    scene = CommandedStation().opens(1, core(), extended("A")).passes(1.0).receives(1, IMAGE, IMAGE)
    (frame,) = scene.station.frames.values()
    assert frame.id == 2
    assert frame.received_at_ns - frame.captured_at_ns == seconds_to_ns(0.5)
    assert frame.captured_sigma_s == 0.25


def test_only_so_many_frames_are_kept() -> None:
    scene = CommandedStation()
    scene.station = Station(settings=StationSettings(frames_kept=3))
    scene.opens(1)
    for number in range(10):
        scene.receives(1, extended(f"S{number}"), IMAGE)
    assert list(scene.station.frames) == ["S7", "S8", "S9"]


def test_a_frame_of_a_link_without_a_serial_is_not_kept() -> None:
    assert CommandedStation().opens(1, core(), IMAGE).station.frames == {}


def test_an_older_ground_image_never_replaces_a_newer_one() -> None:
    scene = imaging_scene()
    for captured_at_ns in (5, 9, 7):
        scene.happens(JobDone(1, PROJECT_FRAME, ProjectedFrame(ground_image(captured_at_ns))))
    image = imager_of(scene.station).ground_image
    assert image is not None
    assert image.captured_at_ns == 9


def test_failed_work_is_an_alarm_until_work_succeeds() -> None:
    scene = imaging_scene().happens(JobFailed(1, PROJECT_FRAME, "no pose")).passes(0.1)
    assert scene.alarms() == set()
    scene.passes(scene.station.settings.imaging_trouble_after_s)
    assert scene.alarms() == {"imaging"}
    scene.happens(JobDone(2, PROJECT_FRAME, ProjectedFrame(ground_image(1)))).passes(0.1)
    assert scene.alarms() == set()


def test_a_dropped_frame_is_counted() -> None:
    scene = imaging_scene().happens(JobDropped(1, PROJECT_FRAME))
    assert imager_of(scene.station).frames_dropped == 1


def test_the_imaging_drones_telemetry_is_kept_for_its_frames() -> None:
    scene = imaging_scene("A")
    scene.opens(1, extended("A"), core(), core(position=None))
    assert len(imager_of(scene.station).samples) == 1


class TestLostVehicles:
    def test_a_vehicle_without_a_serial_that_flew_when_its_link_ended_is_an_alarm(self) -> None:
        scene = CommandedStation().opens(1, core()).passes(0.5).closes(1).passes(1.0)
        assert "unidentified_lost" in scene.alarms()

    def test_one_that_stood_on_the_ground_raises_no_alarm(self) -> None:
        scene = CommandedStation().opens(1, core(flying=False)).passes(0.5).closes(1).passes(1.0)
        assert scene.alarms(active=False) == set()

    def test_a_silent_vehicle_without_a_serial_is_lost_like_any_other(self) -> None:
        scene = CommandedStation().opens(1, core()).passes(4.0)
        assert "link_lost" in scene.alarms()

    def test_a_talkative_app_leaves_room_for_others(self) -> None:
        scene = CommandedStation().opens(1, core(), extended("A")).opens(2, core(), extended("B"))
        for number in range(50):
            scene.receives(1, MessageReport(MessageSeverity.ERROR, f"trouble {number}"))
        scene.receives(2, MessageReport(MessageSeverity.ERROR, "one thing"))
        texts = [a.condition.text for a in scene.station.alarms.alarms.values()]
        assert sum("trouble" in text for text in texts) == 8
        assert any("one thing" in text for text in texts)
