"""What stands in a record: read by the libraries' own readers, compared with the flight."""

import json
import os
import queue
import signal
from collections import defaultdict
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import cv2
import msgspec
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from tests.detection.shaded_field import FIELD
from tests.examples import family
from tests.forecast.moving_shade import shade_map
from tests.record.mcap.test_record_writer import until
from tests.replay.flights import FOLDER, pictures_in_two, survey_in_two
from tests.replay.record_flight import Audits, recording
from tests.station.station_world import square_mission, world
from tests.station.surveyed_world import asked

from recon import wire
from recon.link.tap import Direction
from recon.model.command import FlyMission, Hover, LandNow
from recon.model.event import LinkClosed, PacketReceived, RecordFailed, Tick
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.report import ImageReport
from recon.model.shade import ShadeMap, SunForecast
from recon.model.units import seconds_to_ns
from recon.product.flight_reader import read_flight
from recon.record.mcap import foxglove
from recon.record.mcap.flight_messages import FlightMessages
from recon.record.mcap.items import BULK_BYTES, HEAD, STEP_HEAD, Beginning, Item, ItemKind
from recon.record.mcap.link_bytes import LINKS_TOPIC, link_bytes
from recon.record.mcap.mcap_file import STEPS_TOPIC
from recon.record.mcap.mcap_read import MAGIC, McapReading, RecordMessage
from recon.record.mcap.record_process import NICENESS, RecordProcess
from recon.record.mcap.record_writer import RecordWriter
from recon.site import Site
from recon.station.host import run
from recon.station.kernel.step import step
from recon.station.recording import recording as recording_of_kernel
from recon.station.recording.keyframe import EVERYTHING, RecordDetail
from recon.station.recording.recording import (
    RESTART_AFTER_S,
    RESTART_WITHIN_S,
    Recorder,
    is_flying,
)
from recon.station.recording.replay import check
from recon.station.state.imaging import ShadePipeline
from recon.station.state.station import Station
from recon.station.state.steps import StepTaken

GRID = GroundGrid(LocalFrame(GeoPoint(45.0, -93.0, 300.0)), -20.0, 10.0, 5.0, 4, 6)


def decoded(path: Path) -> dict[str, list[Any]]:
    """The messages in Foxglove's schemas, by topic, as Foxglove's own decoder reads them."""
    found = defaultdict(list)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        topics = [f"/{t}" for t in ("log", "shade", "forecast")]
        summary = reader.get_summary()
        assert summary is not None
        topics += [c.topic for c in summary.channels.values() if c.topic.startswith("/vehicles")]
        for each in reader.iter_decoded_messages(topics=topics):
            found[each.channel.topic].append(each.decoded_message)
    return dict(found)


def test_a_flight_opens_with_the_libraries_own_readers(tmp_path: Path) -> None:
    scene = world(1, keeps_log=False)
    sent: list[tuple[Direction, bytes]] = []
    with recording(scene.driver, Site("test"), tmp_path) as record:
        tap = scene.driver.tap
        assert tap is not None

        def both(link_id: int, direction: Direction, data: bytes, at_ns: int) -> None:
            sent.append((direction, data))
            tap(link_id, direction, data, at_ns)

        scene.driver.tap = both
        scene.run_for(3.0)
        order = scene.order("SIM-1", FlyMission(square_mission()))
        scene.run_for(1.0)
    assert scene.record(order).refusal is None, scene.record(order).refusal
    found = decoded(record.path)
    vehicle = scene.vehicle("SIM-1").position.value
    assert vehicle is not None
    fix = found["/vehicles/SIM-1/location"][-1]
    assert (fix.latitude, fix.longitude) == (vehicle.latitude_deg, vehicle.longitude_deg)
    assert fix.timestamp.ToNanoseconds() <= scene.driver.now_ns
    (plan,) = found["/vehicles/SIM-1/mission"]
    line = json.loads(plan.geojson)["geometry"]
    flown = square_mission().waypoints
    assert line["type"] == "LineString"
    assert line["coordinates"][0][:2] == [flown[0].longitude_deg, flown[0].latitude_deg]
    assert any("SIM-1" in each.message or "mission" in each.message for each in found["/log"])
    with record.path.open("rb") as file:
        kept = [
            msgspec.msgpack.decode(item.data)
            for item in McapReading(file).items()
            if isinstance(item, RecordMessage) and item.topic == LINKS_TOPIC
        ]
    is_from_app = {Direction.FROM_APP: True, Direction.TO_APP: False}
    assert [(m["from_app"], m["data"]) for m in kept] == [(is_from_app[d], b) for d, b in sent]
    assert any(not m["from_app"] for m in kept)


def test_frames_maps_and_forecasts_are_in_it() -> None:
    found = decoded(FOLDER / "pictures.mcap")
    (topic,) = (each for each in found if each.endswith("/jpeg"))
    for image in found[topic]:
        assert image.format == "jpeg"
        assert cv2.imdecode(np.frombuffer(image.data, np.uint8), cv2.IMREAD_COLOR).shape[2] == 3
    assert len(found["/shade"]) == len(found["/forecast"]) >= 1
    assert found["/shade"][0].fields[0].name == "transmittance"
    assert found["/forecast"][0].fields[0].name == "sun_in_0_s"


def test_a_map_begins_at_its_lower_left_corner() -> None:
    transmittance = np.arange(24, dtype=np.float32).reshape(4, 6) / 24
    valid = np.ones((4, 6), bool)
    valid[0, 0] = False
    ones = np.ones((4, 6), np.float32)
    grid = foxglove.shade_grid(ShadeMap(GRID, 7, (), transmittance, valid, ones, ones))
    assert grid.timestamp.nanos == 7
    cells = np.frombuffer(grid.data, "<f4").reshape(4, 6, 3)
    assert (grid.pose.position.x, grid.pose.position.y) == (-20.0, 10.0 - 4 * 5.0)
    assert (grid.cell_size.x, grid.column_count, grid.row_stride) == (5.0, 6, 72)
    assert cells[0, 0, 0] == transmittance[3, 0]
    assert np.isnan(cells[3, 0, 0])
    assert cells[3, 5, 0] == transmittance[0, 5]
    leads = np.arange(48, dtype=np.uint8).reshape(2, 4, 6)
    horizon = np.arange(24, dtype=np.float32).reshape(4, 6)
    sun = SunForecast(GRID, 0, np.array([0.0, 60.0]), leads, horizon, 0.5, "test")
    grid = foxglove.forecast_grid(sun)
    cells = np.frombuffer(grid.data, np.uint8).reshape(4, 6, 2 + 4)
    assert (cells[..., 2:].view("<f4")[..., 0] == horizon[::-1]).all()
    assert [field.name for field in grid.fields] == ["sun_in_0_s", "sun_in_60_s", "horizon_s"]
    assert (cells[0, 2, :2] == leads[:, 3, 2]).all()


class FullProcess(RecordProcess):
    """A process whose disk takes nothing: what is put waits."""

    def __init__(self, folder: Path, room_bytes: int) -> None:
        super().__init__(folder, "test")
        self.left_bytes = room_bytes
        self.items: list[Item] = []

    def start(self) -> None:
        pass

    @property
    def room_bytes(self) -> int:
        return self.left_bytes

    @property
    def bulk_room_bytes(self) -> int:
        return self.left_bytes - 20_000

    def put(self, parts: Any) -> None:
        data = b"".join(parts)
        self.left_bytes -= len(data)
        while data:
            kind, size = HEAD.unpack_from(data)
            self.items.append(Item(ItemKind(kind), data[HEAD.size : HEAD.size + size]))
            data = data[HEAD.size + size :]


def taken(event: Any, now_ns: int = 5) -> StepTaken:
    before = Station()
    after, outputs = step(before, event, now_ns)
    return StepTaken(event, now_ns, before, after, outputs)


class Restarts:
    """A recorder whose processes are given; each tick's file has begun, or cannot."""

    def __init__(self, *processes: FullProcess, detail: RecordDetail = EVERYTHING) -> None:
        self.alarms: list[str | None] = []
        left = list(processes)

        def handle(event: Any) -> None:
            self.alarms.append(event.problem)

        self.recorder = Recorder(lambda: left.pop(0), handle, Audits(), Site("test"), detail=detail)
        self.recorder.start(Station(), 0)

    def tick(self, now_s: float) -> None:
        if self.recorder._encoding is not None:
            self.recorder._encoding.join()
        self.recorder.take(taken(Tick(), seconds_to_ns(now_s)))

    def see_map(self, number: int, at_s: float) -> None:
        """A tick at which the station has a new shade map."""
        if self.recorder._encoding is not None:
            self.recorder._encoding.join()
        step = taken(Tick(), seconds_to_ns(at_s))
        shade = shade_map(np.ones((FIELD.rows, FIELD.cols)), at_s)
        line = ShadePipeline(number=number, shade=shade)
        self.recorder.take(replace(step, after=replace(step.after, shade=line)))


def steps_of(process: FullProcess) -> list[int]:
    steps = [item.content for item in process.items if item.kind is ItemKind.STEP]
    return [STEP_HEAD.unpack_from(content)[0] for content in steps]


def test_a_file_has_nothing_from_before_its_state(tmp_path: Path) -> None:
    """The process dies before the first file's beginning could be handed over."""
    first, second = FullProcess(tmp_path, 0), FullProcess(tmp_path, 10**8)
    scene = Restarts(first, second)
    scene.recorder.tap(1, Direction.FROM_APP, b"before", 5)
    for _ in range(7):
        scene.tick(1.0)
    first.is_dead = True
    for now_s in (1.0, RESTART_AFTER_S + 1.0):
        scene.recorder.tap(1, Direction.FROM_APP, b"before", 5)
        scene.tick(now_s)
    scene.tick(RESTART_AFTER_S + 1.1)
    assert [item.kind for item in second.items] == [ItemKind.BEGIN, ItemKind.STEP]
    assert steps_of(second) == [1]
    assert scene.recorder.dropped_bytes == 3 * len(b"before")


def test_a_process_that_cannot_be_started_is_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def start() -> None:
        raise OSError(11, "Resource temporarily unavailable")

    first, second, third = (FullProcess(tmp_path, 10**8) for _ in range(3))
    monkeypatch.setattr(second, "start", start)
    scene = Restarts(first, second, third)
    scene.tick(1.0)
    first.is_dead = True
    for now_s in (1.0, 6.0, 10.0):
        scene.tick(now_s)
    assert scene.recorder.process is first
    assert scene.alarms == [f"the process that writes the record to {tmp_path} has ended"]
    scene.tick(11.0)
    scene.tick(11.1)
    assert scene.alarms[1:] == [None]
    assert steps_of(third) == [1]


def test_a_restart_does_not_wait_for_jobs_that_never_pause(tmp_path: Path) -> None:
    first, second = FullProcess(tmp_path, 10**8), FullProcess(tmp_path, 10**8)
    scene = Restarts(first, second)
    scene.recorder._jobs.add(("images", 1))
    scene.tick(1.0)
    first.is_dead = True
    scene.tick(1.0)
    scene.tick(RESTART_WITHIN_S)
    assert scene.recorder.process is first
    scene.tick(RESTART_WITHIN_S + 1.0)
    scene.tick(RESTART_WITHIN_S + 1.1)
    begins = msgspec.msgpack.decode(second.items[0].content, type=Beginning)
    assert json.loads(begins.about)["running_jobs"] == 1


def test_what_waits_for_a_beginning_is_bounded_by_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording_of_kernel, "WAITING_BYTES", 200_000)
    monkeypatch.setattr(recording_of_kernel, "WAITING_BULK_BYTES", 100_000)
    process = FullProcess(tmp_path, 0)
    scene = Restarts(process)
    monkeypatch.setattr(scene.recorder._keyframes, "due", lambda *_: ())
    for _ in range(20):
        scene.recorder.tap(1, Direction.FROM_APP, bytes(BULK_BYTES), 5)
        scene.recorder.tap(1, Direction.TO_APP, b"order", 5)
        scene.tick(1.0)
    kept_bytes = 100_000 // BULK_BYTES * BULK_BYTES
    assert process.dropped_bytes == 20 * BULK_BYTES - kept_bytes
    assert process.dropped_steps == 0
    process.left_bytes = 10**8
    scene.tick(1.0)
    assert len(steps_of(process)) == 21
    assert [i.kind for i in process.items].count(ItemKind.LINK) == 20 + kept_bytes // BULK_BYTES


def test_a_full_ring_gets_no_more_than_its_room(tmp_path: Path) -> None:
    process = FullProcess(tmp_path, 10**8)
    scene = Restarts(process)
    scene.tick(1.0)
    process.left_bytes = 4
    scene.recorder._reports_flown = True
    scene.tick(1.1)
    assert process.left_bytes == 4
    process.left_bytes = 10**8
    scene.tick(1.2)
    assert [item.kind for item in process.items[-4:]] == [
        ItemKind.FLOWN,
        ItemKind.KEYFRAME,
        ItemKind.STEP,
        ItemKind.STEP,
    ]


def test_a_keyframe_takes_some_ticks_and_keeps_its_place(tmp_path: Path) -> None:
    process = FullProcess(tmp_path, 10**8)
    scene = Restarts(process)
    scene.tick(1.0)
    scene.tick(1.1)
    assert [item.kind for item in process.items] == [ItemKind.BEGIN, ItemKind.STEP]
    scene.tick(1.2)
    assert [item.kind for item in process.items[2:]] == [ItemKind.KEYFRAME, *2 * [ItemKind.STEP]]
    assert steps_of(process) == [1, 2, 3]


def test_a_demo_records_the_maps_of_keyframes_alone(tmp_path: Path) -> None:
    detail = RecordDetail(keyframe_s=4.0, has_all_maps=False, is_demo=True)
    found = {}
    for name, each in (("demo", detail), ("flight", EVERYTHING)):
        process = FullProcess(tmp_path, 10**8)
        scene = Restarts(process, detail=each)
        for number in range(1, 20):
            scene.see_map(number, 0.5 * number)
        scene.recorder.close()
        found[name] = [item.kind for item in process.items]
        about = msgspec.msgpack.decode(process.items[0].content, type=Beginning).about
        assert json.loads(about)["is_demo"] is each.is_demo
        for before, after in pairwise(found[name]):
            assert after is not ItemKind.KEYFRAME or before in (ItemKind.SHADE, ItemKind.STEP)
    counts = {
        name: (k.count(ItemKind.SHADE), k.count(ItemKind.KEYFRAME)) for name, k in found.items()
    }
    assert counts == {"demo": (3, 3), "flight": (19, 5)}


def test_a_long_flight_goes_on_in_a_new_file_when_no_survey_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording_of_kernel, "is_flying", lambda _station: True)
    process = FullProcess(tmp_path, 10**8)
    scene = Restarts(process, detail=RecordDetail(flight_file_s=60.0))
    for number in range(1, 15):
        scene.tick(10.0 * number)
    scene.recorder.close()
    kinds = [item.kind for item in process.items]
    assert kinds.count(ItemKind.BEGIN) == kinds.count(ItemKind.FLOWN) == 3


def test_the_end_waits_for_no_further_tick_of_a_keyframe(tmp_path: Path) -> None:
    process = FullProcess(tmp_path, 10**8)
    scene = Restarts(process)
    scene.tick(1.0)
    scene.recorder.take(taken(LinkClosed(1, "closed")))
    scene.recorder.close()
    assert [item.kind for item in process.items[2:]] == [ItemKind.KEYFRAME, ItemKind.STEP]


def test_links_that_closed_take_no_memory(tmp_path: Path) -> None:
    scene = Restarts(FullProcess(tmp_path, 10**8))
    for link_id in range(5):
        scene.recorder.tap(link_id, Direction.FROM_APP, b"telemetry", 5)
        scene.recorder.tap(link_id, Direction.TO_APP, b"order", 5)
        scene.recorder.take(taken(LinkClosed(link_id, "closed")))
    assert scene.recorder._ends == {}


def test_a_file_without_its_start_is_a_problem_until_it_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(_start: Any) -> Any:
        raise ValueError("no text")

    monkeypatch.setattr(recording_of_kernel, "GROUND_FILE_S", 5.0)
    with monkeypatch.context() as patch:
        patch.setattr(recording_of_kernel, "_about", fails)
        scene = Restarts(FullProcess(tmp_path, 10**8))
        scene.tick(1.0)
    assert scene.alarms[-1] is not None
    assert "without the station's state" in scene.alarms[-1]
    scene.tick(6.0)
    assert scene.alarms[-1] is None


def test_when_the_disk_is_slow_images_go_first(tmp_path: Path) -> None:
    process = FullProcess(tmp_path, 100_000)
    recorder = Recorder(lambda: process, lambda _event: None, Audits(), Site("test"))
    recorder.start(Station(), 0)
    assert recorder._encoding is not None
    recorder._encoding.join()
    read = bytes(BULK_BYTES)
    while process.dropped_bytes < len(read):
        recorder.tap(1, Direction.FROM_APP, read, 5)
        recorder.take(taken(Tick()))
    assert process.bulk_room_bytes < len(read) + 100
    recorder.tap(1, Direction.FROM_APP, b"telemetry", 5)
    recorder.tap(1, Direction.TO_APP, b"order", 5)
    recorder.take(taken(Tick()))
    assert [each.kind for each in process.items[-3:]] == [
        ItemKind.LINK,
        ItemKind.LINK,
        ItemKind.STEP,
    ]
    assert process.dropped_steps == 0
    assert process.problem is not None
    assert process.problem.endswith("the record lacks images")
    process.left_bytes = 0
    recorder.take(taken(Tick()))
    assert process.dropped_steps == 1
    assert process.problem.endswith("the record lacks steps")


def written(process: FullProcess, folder: Path, free_bytes: int = 10**12) -> RecordWriter:
    """Return a writer that has written what a process was handed."""
    inbox: queue.SimpleQueue[Item | None] = queue.SimpleQueue()
    for item in (*process.items, None):
        inbox.put(item)
    writer = RecordWriter(
        folder,
        FlightMessages(),
        inbox,
        "test",
        begins=lambda item: item.kind is ItemKind.BEGIN,
        free_bytes=lambda _folder: free_bytes,
    )
    writer._look_at_disk()
    writer.run()
    return writer


def test_many_small_images_of_one_read_are_all_in_the_record(tmp_path: Path) -> None:
    process = FullProcess(tmp_path, 10**9)
    recorder = Recorder(lambda: process, lambda _event: None, Audits(), Site("test"))
    recorder.start(Station(), 0)
    jpegs = [b"\xff\xd8" + bytes([number]) for number in range(70)]
    packets = [wire.encode(wire.CompressedImage(target_fps_hz=1.0, jpeg=jpeg)) for jpeg in jpegs]
    recorder.tap(1, Direction.FROM_APP, b"".join(packets), 5)
    end = 0
    for jpeg, packet in zip(jpegs, packets, strict=True):
        start, end = end, end + len(packet)
        recorder.take(taken(PacketReceived(1, ImageReport(1.0, jpeg=jpeg), 5, start, end)))
    recorder.take(taken(Tick()))
    recorder.close()
    path = written(process, tmp_path).path
    assert path is not None
    found = check(path)
    assert (found.differences, found.trouble, found.steps) == ([], "", 71)
    with path.open("rb") as file:
        file.read(len(MAGIC))
        assert b"".join(each.data for each in link_bytes(file)) == b"".join(packets)


def test_without_images_damaged_frames_are_lost_too(tmp_path: Path) -> None:
    process = FullProcess(tmp_path, 10**9)
    recorder = Recorder(lambda: process, lambda _event: None, Audits(), Site("test"))
    recorder.start(Station(), 0)
    recorder.tap(1, Direction.FROM_APP, bytes(BULK_BYTES), 5)
    recorder.tap(1, Direction.FROM_APP, b"telemetry", 5)
    recorder.take(taken(Tick()))
    recorder.close()
    path = written(process, tmp_path, free_bytes=0).path
    assert path is not None
    with path.open("rb") as file:
        items = [i for i in McapReading(file).items() if isinstance(i, RecordMessage)]
    links = [msgspec.msgpack.decode(i.data) for i in items if i.topic == LINKS_TOPIC]
    assert [(m["data"], m.get("lost", 0)) for m in links] == [(b"", BULK_BYTES), (b"telemetry", 0)]


def test_without_images_telemetry_orders_and_audit_stay(tmp_path: Path) -> None:
    process = FullProcess(tmp_path, 10**9)
    seen: list[Any] = []
    recorder = Recorder(lambda: process, seen.append, Audits(), Site("test"))
    recorder.start(Station(), 0)
    jpeg = wire.encode(wire.CompressedImage(target_fps_hz=1.0, jpeg=bytes(1000)))
    core = wire.encode(wire.MessageString(type=1, text=b"hello"))
    recorder.tap(1, Direction.FROM_APP, core + jpeg + core, 5)
    recorder.tap(1, Direction.TO_APP, b"order", 5)
    start, end = len(core), len(core) + len(jpeg)
    recorder.take(taken(PacketReceived(1, ImageReport(1.0, jpeg=bytes(1000)), 5, start, end)))
    recorder.take(taken(Tick()))
    recorder.close()
    writer = written(process, tmp_path, free_bytes=0)
    assert writer.path is not None
    with writer.path.open("rb") as file:
        messages = [i for i in McapReading(file).items() if isinstance(i, RecordMessage)]
    by_topic = defaultdict(list)
    for message in messages:
        by_topic[message.topic].append(msgspec.msgpack.decode(message.data))
    assert not any(topic.endswith("/jpeg") for topic in by_topic)
    assert [m["event"]["_"] for m in by_topic[STEPS_TOPIC]] == ["PacketReceived", "Tick"]
    links = by_topic[LINKS_TOPIC]
    assert [m["data"] for m in links if not m["from_app"]] == [b"order"]
    from_app = [m for m in links if m["from_app"]]
    assert [m["data"] for m in from_app] == [core, b"", core]
    assert from_app[1]["lost"] == len(jpeg)
    assert writer.problem is not None
    assert "without images" in writer.problem


def test_a_dead_process_is_an_alarm_and_another_one_goes_on(tmp_path: Path) -> None:
    scene = world(2, keeps_log=False)
    with recording(scene.driver, Site("test"), tmp_path) as record:
        first = record.process

        def is_written() -> bool:
            scene.run_for(0.05)
            # By the takeoff it has another name, reported a moment later.
            with suppress(FileNotFoundError):
                return first.path is not None and first.path.stat().st_size > 60_000
            return False

        until(is_written)
        assert first.pid is not None
        assert os.getpriority(os.PRIO_PROCESS, first.pid) == min(19, os.nice(0) + NICENESS)
        group = Path(f"/proc/{first.pid}/autogroup")
        assert (
            not group.exists()
            or not group.read_text()
            or group.read_text().endswith(f" {NICENESS}\n")
        )
        os.kill(first.pid, signal.SIGKILL)
        until(lambda: first.is_dead)
        scene.run_for(0.2)
        alarms = scene.driver.station.alarms.alarms.values()
        (alarm,) = (each for each in alarms if each.condition.rule == "record")
        assert "the process that writes the record" in alarm.condition.text
        scene.run_for(RESTART_AFTER_S + 1.0)
        alarms = scene.driver.station.alarms.alarms.values()
        assert not any(each.is_active for each in alarms if each.condition.rule == "record")
        assert record.process is not first
        scene.order("SIM-1", Hover())
        scene.run_for(1.0)
    for path in tmp_path.iterdir():
        found = check(path)
        assert (found.differences, found.trouble) == ([], "")
        assert found.steps > 0
    assert len(list(tmp_path.iterdir())) == 2


def test_a_flights_file_ends_after_the_landing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording_of_kernel, "AFTER_LANDING_S", 3.0)
    monkeypatch.setattr(recording_of_kernel, "GROUND_FILE_S", 5.0)
    scene = world(1, keeps_log=False)
    with recording(scene.driver, Site("test"), tmp_path) as record:
        scene.run_for(2.0)
        assert is_flying(scene.driver.station)
        scene.order("SIM-1", LandNow())
        assert scene.driver.run_until(lambda station: not is_flying(station), 120.0)
        assert record.recorder._number > 20
        scene.run_for(2.0)
        assert record.recorder._has_flown
        scene.run_for(2.0)
        assert not record.recorder._has_flown
        scene.run_for(6.0)
    names = sorted(path.name.partition("-")[0] for path in tmp_path.iterdir())
    assert names == ["flight", "ground", "ground"]
    for path in tmp_path.iterdir():
        found = check(path)
        assert (found.differences, found.trouble) == ([], "")


@pytest.mark.parametrize("flight", family(survey_in_two, pictures_in_two))
def test_a_file_that_begins_in_flight_gives_the_same(flight: Any, tmp_path: Path) -> None:
    """Everything that the station remembers stands at its beginning."""
    flight(tmp_path)
    files = sorted(tmp_path.iterdir())
    assert len(files) == 2
    for path in files:
        found = check(path)
        assert (found.differences, found.trouble) == ([], "")
        assert found.jobs >= 2
        if flight is survey_in_two:
            (flown,) = read_flight(path).surveys
            want = asked()
            assert (flown.name, flown.camera) == (want.name, want.camera)
            assert flown.outline_m == tuple(map(tuple, want.region.outline_m.tolist()))
            assert flown.starts[0][1] == {"SIM-1", "SIM-2"}


def test_a_failed_record_is_an_alarm_until_it_is_written_again() -> None:
    scene = world(1)
    driver = scene.driver
    driver.handle(RecordFailed("less than 2 GiB are free on /: recording continues without images"))
    scene.run_for(0.2)
    (alarm,) = (a for a in driver.station.alarms.alarms.values() if a.condition.rule == "record")
    assert "without images. Flying continues: free disk space" in alarm.condition.text
    assert alarm.is_active
    driver.handle(RecordFailed(None))
    scene.run_for(0.2)
    found = [a for a in driver.station.alarms.alarms.values() if a.condition.rule == "record"]
    assert not any(each.is_active for each in found)


def test_windows_records_nothing_and_raises_the_alarm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "IS_SUPPORTED", False)
    config = run.RunConfig(Site("test"), record_folder=tmp_path, is_record_required=True)
    driver, unused = MagicMock(), MagicMock()
    assert run._start_record(config, driver, unused, unused, unused) is None
    assert driver.handle.call_args.args == (RecordFailed("flights are not recorded on Windows"),)


@pytest.mark.parametrize("shape", [(1, 1), (3, 5), (90, 160)])
def test_raw_frames_are_what_protobuf_would_write(shape: tuple[int, int]) -> None:
    rgb = np.random.default_rng(1).integers(0, 256, (*shape, 3), np.uint8)
    image = foxglove.RAW_IMAGE.FromString(foxglove.raw_image_bytes(rgb, "SIM-1", 7_000_000_001))
    assert (image.height, image.width, image.step) == (*shape, 3 * shape[1])
    assert (image.data, image.encoding, image.frame_id) == (rgb.tobytes(), "rgb8", "SIM-1")
    assert image.timestamp.ToNanoseconds() == 7_000_000_001
