"""A record's states by time: as they were, from wherever one comes; cut and foreign files."""

import asyncio
import io
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_type_hints

import msgspec
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader
from tests.replay.flights import FOLDER, skip_if_recorded_elsewhere
from tests.replay.record_flight import recording
from tests.replay.rounding import is_same, was_here
from tests.station.station_world import world

from recon.api.pictures import forecast_png, frame_jpeg, ground_png, shade_png
from recon.api.schema import ReplayTransport, ReplayView
from recon.api.security import LOCAL_PERSON
from recon.model.command import Hover
from recon.model.errors import RecordError
from recon.model.event import AllStopped
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.record.mcap.flight_messages import START_NAME
from recon.record.mcap.foxglove import SHADE_TOPIC, SUN_TOPIC
from recon.record.mcap.mcap_file import KEYFRAMES_TOPIC, STEPS_TOPIC, McapFile
from recon.record.mcap.mcap_read import McapReading, RecordMessage
from recon.site import Site
from recon.station.api_views.audit_service import audit_page, timeline
from recon.station.api_views.picture_routes import newest_shade
from recon.station.api_views.service import Service
from recon.station.host.replay_run import ReplayService, ReplayStation, replay_service
from recon.station.kernel.driver import AsyncioDriver
from recon.station.recording import recording as recording_of_kernel
from recon.station.recording.keyframe import (
    KEYFRAME_S,
    DueKeyframe,
    MapFacts,
    MapMessages,
    keyframe_pieces,
    maps_of,
    read_keyframe,
    restored,
)
from recon.station.recording.playback import Playback
from recon.station.recording.recorded_values import values_codec
from recon.station.recording.replay import Replay, check
from recon.station.state.station import Station

FLIGHTS = ("faults", "survey", "pictures")


def flight(name: str) -> Path:
    return FOLDER / f"{name}.mcap"


_OPEN: list[Playback] = []


@pytest.fixture(autouse=True)
def _closes_the_files() -> Iterator[None]:
    yield
    while _OPEN:
        _OPEN.pop().close()


def played(path: Path) -> Playback:
    _OPEN.append(Playback(path))
    return _OPEN[-1]


def opened(path: Path) -> tuple[ReplayStation, ReplayService]:
    replay = ReplayStation(path, played(path), lambda: 0.0)
    return replay, replay_service(replay)


def seek(replay: ReplayStation, at_s: float) -> ReplayView:
    return asyncio.run(replay.change(ReplayTransport(position_s=at_s)))


def keyframe_bytes(due: DueKeyframe) -> bytes:
    *_, data = keyframe_pieces(values_codec(), due)
    return data


def encoded(keyframe: bytes) -> dict[str, bytes]:
    """The fields of a keyframe as this version encodes them, with those that it lacks."""
    codec, hints = values_codec(), get_type_hints(Station)
    found = read_keyframe(codec, keyframe)
    seldom = {"settings", "airspace"} - found.parts.keys()
    values = {
        name: found.parts.get(name, getattr(Station(), name)) for name in hints.keys() - seldom
    }
    return {name: codec.encode(value, hints[name]) for name, value in values.items()} | {
        "maps": codec.encode(found.maps, MapFacts | None)
    }


def plain(fields: dict[str, bytes]) -> dict[str, Any]:
    return {name: msgspec.msgpack.decode(data) for name, data in fields.items()}


@pytest.mark.parametrize("name", FLIGHTS)
def test_each_keyframe_is_the_station_of_its_step(name: str) -> None:
    """Compared with the flight run again, jobs included."""
    on_start = skip_if_recorded_elsewhere if name == "pictures" else None
    again, codec, compared = Replay(on_start), values_codec(), 0
    with flight(name).open("rb") as file:
        for item in McapReading(file).items():
            again.take(item)
            if isinstance(item, RecordMessage) and item.topic == KEYFRAMES_TOPIC:
                assert item.sequence == again.found.steps
                maps = read_keyframe(codec, item.data).maps
                at_ns = None if maps is None else maps.at_ns
                due = DueKeyframe(item.sequence, item.log_ns, again.station, at_ns)
                now, recorded = encoded(keyframe_bytes(due)), encoded(item.data)
                is_here = was_here(again.found.start)
                assert now == recorded or (not is_here and is_same(plain(recorded), plain(now)))
                compared += 1
    assert compared >= again.found.lasted_s / KEYFRAME_S - 1


@pytest.mark.parametrize("name", FLIGHTS)
def test_the_screens_get_the_recorded_states(name: str) -> None:
    """At keyframes: everything that a console shows, with the ages of that moment."""
    replay, service = opened(flight(name))
    again, exact = Replay(), AsyncioDriver(Station(), lambda: replay.now_ns())
    recorded = Service.around(exact, replay.playback.start.site, None)
    with flight(name).open("rb") as file:
        for item in McapReading(file).items():
            again.take(item)
            if isinstance(item, RecordMessage) and item.topic == KEYFRAMES_TOPIC:
                exact.station = again.station
                recorded.numbers = service.numbers
                seek(replay, ns_to_seconds(item.log_ns - replay.started_at_ns))
                assert replay.now_ns() == item.log_ns
                excluded = {"station": True, "replay": True}
                now = service.state().model_dump(exclude=excluded)
                assert now == recorded.state().model_dump(exclude=excluded)
                _compare_pictures(service, recorded)


def _compare_pictures(service: ReplayService, recorded: Service) -> None:
    ground = recorded.ground_image()
    if ground is not None:
        projected = service.ground_image()
        assert projected is not None
        assert ground_png(projected) == ground_png(ground)
    line, again = recorded.driver.station.shade, service.driver.station.shade
    shade, replayed = newest_shade(line), newest_shade(again)
    if shade is not None and line.sun is not None:
        assert replayed is not None
        assert again.sun is not None
        assert shade_png(*replayed[1:]) == shade_png(*shade[1:])
        assert forecast_png(again.sun, 60.0) == forecast_png(line.sun, 60.0)
    for serial in recorded.driver.station.frames:
        frame, was = service.frame(serial), recorded.frame(serial)
        assert frame is not None
        assert was is not None
        assert frame_jpeg(frame) == frame_jpeg(was)


def test_wherever_one_comes_from_a_moment_is_the_same() -> None:
    playback, rng = played(flight("survey")), random.Random(5)

    def state_at(at_ns: int) -> bytes:
        return keyframe_bytes(DueKeyframe(0, at_ns, playback.move(at_ns).station))

    span_ns = playback.ends_ns - playback.begins_ns
    moments = [playback.begins_ns + rng.randrange(span_ns) for _ in range(6)]
    first = {at_ns: state_at(at_ns) for at_ns in sorted(moments)}
    for at_ns in moments:
        assert state_at(at_ns) == first[at_ns]


def test_between_keyframes_vehicles_move_with_every_packet() -> None:
    playback = played(flight("survey"))
    places = set()
    for tenths in range(200, 220):
        station = playback.move(playback.begins_ns + tenths * 100_000_000).station
        places.add(station.fleet.vehicles["SIM-1"].position.value)
    assert len(places) >= 15


def test_it_plays_fast_by_keyframes_and_never_backwards() -> None:
    playback = played(flight("survey"))
    at_ns = playback.begins_ns
    while at_ns < playback.ends_ns:
        to_ns = min(at_ns + seconds_to_ns(5.0), playback.ends_ns)
        moment = playback.move(to_ns, is_exact=False)
        assert at_ns < moment.at_ns <= to_ns
        at_ns = moment.at_ns


def test_a_keyframe_far_behind_is_found(tmp_path: Path) -> None:
    """Where the disk was too slow for all but the first one."""
    file, channels, kept = McapFile(tmp_path / "gap.mcap", "test"), dict[str, int](), 0
    with flight("survey").open("rb") as source:
        for item in McapReading(source).items():
            if not isinstance(item, RecordMessage):
                file.add_attachment(item.name, item.media_type, item.data, 0)
                continue
            kept += item.topic == KEYFRAMES_TOPIC
            if item.topic == KEYFRAMES_TOPIC and kept != 2:
                continue
            if item.topic not in channels:
                channels[item.topic] = file.add_channel(item.topic, item.encoding)
            file.add_message(channels[item.topic], item.sequence, item.log_ns, item.data)
            if item.topic == STEPS_TOPIC and item.sequence % 20 == 0:
                file.flush()
    file.finish()
    playback = played(tmp_path / "gap.mcap")
    moment = playback.move(playback.ends_ns, is_exact=False)
    assert moment.at_ns == pytest.approx(playback.begins_ns + seconds_to_ns(KEYFRAME_S), abs=1e8)
    assert moment.station.fleet.vehicles.keys() == {"SIM-1", "SIM-2"}


def test_a_replay_takes_no_event_and_ends_paused() -> None:
    replay, service = opened(flight("faults"))
    seek(replay, 5.0)
    before = replay.station
    replay.handle(AllStopped("anna"))
    service.orders.all_stop(LOCAL_PERSON)
    assert replay.station is before
    view = seek(replay, 1e6)
    assert view.position_s == view.duration_s
    assert not view.is_playing


def test_it_plays_by_the_computers_clock() -> None:
    now_s = 0.0
    replay = ReplayStation(flight("faults"), played(flight("faults")), lambda: now_s)

    async def plays() -> None:
        nonlocal now_s
        await replay.change(ReplayTransport(is_playing=True, speed=4.0))
        now_s = 2.0
        await replay.follow(is_exact=True)

    asyncio.run(plays())
    assert replay.view().position_s == pytest.approx(8.0)
    assert replay.view().is_playing
    now_s = 60.0
    assert not replay.view().is_playing


def test_it_begins_before_the_first_flight_unless_a_person_moved_it() -> None:
    replay, _ = opened(flight("survey"))
    replay.log.read()
    first_ns, begins_ns = replay.log.first_flight_ns, replay.playback.begins_ns
    assert first_ns is not None
    assert 0 <= first_ns - begins_ns < 1e8
    replay.log.first_flight_ns = begins_ns + 10**10
    asyncio.run(replay.go_to_takeoff())
    assert replay.view().position_s == 8.0
    seek(replay, 0.0)
    asyncio.run(replay.go_to_takeoff())
    assert replay.view().position_s == 0.0


def test_the_timeline_goes_up_to_the_moment_and_marks_over_all() -> None:
    replay, _ = opened(flight("survey"))
    replay.log.read()
    marks = replay.marks()
    assert marks.read_share == 1.0
    assert {mark.kind for mark in marks.marks} == {"alarm", "order"}
    middle_s = marks.marks[1].at_s
    seek(replay, middle_s)
    lines = timeline(replay.log, None, None, None, 100).entries
    assert lines
    assert lines[0].n == audit_page(replay.log, 0, 500).last_n
    last_n = audit_page(replay.log, 0, 1).last_n
    seek(replay, 1e6)
    assert audit_page(replay.log, 0, 1).last_n > last_n
    assert [each.n for each in audit_page(replay.log, last_n, 2).entries] == [
        last_n + 1,
        last_n + 2,
    ]
    (line,) = timeline(replay.log, "SIM-1", "orders", None, 1).entries
    assert line.serial == "SIM-1"
    assert line.kind.startswith(("order.", "authority.", "lease."))


def copied(
    path: Path, to: Path, excluded: str = "", start: bytes | None = None, later_ns: int = 0
) -> Path:
    """A copy of a record without a topic, with another start, or with later times."""
    file, channels = McapFile(to, "test"), dict[str, int]()
    with path.open("rb") as source:
        for item in McapReading(source).items():
            if not isinstance(item, RecordMessage):
                data = start if item.name == START_NAME and start is not None else item.data
                file.add_attachment(item.name, item.media_type, data, 0)
            elif item.topic != excluded:
                if item.topic not in channels:
                    channels[item.topic] = file.add_channel(item.topic, item.encoding)
                at_ns = item.log_ns + later_ns
                file.add_message(channels[item.topic], item.sequence, at_ns, item.data)
                if item.topic == STEPS_TOPIC and item.sequence % 20 == 0:
                    file.flush()
    file.finish()
    return to


def test_files_that_cannot_be_replayed_are_refused_with_a_sentence(tmp_path: Path) -> None:
    survey = flight("survey")
    text = tmp_path / "notes.mcap"
    text.write_text("not a record")
    foreign = McapFile(tmp_path / "foreign.mcap", "test")
    foreign.add_message(foreign.add_channel("/a", "json"), 1, 1, b"{}")
    foreign.finish()
    without = copied(survey, tmp_path / "old.mcap", KEYFRAMES_TOPIC)
    stepless = copied(survey, tmp_path / "stepless.mcap", STEPS_TOPIC)
    stateless = copied(survey, tmp_path / "stateless.mcap", start=b"")
    other = zstandard.ZstdCompressor().compress(msgspec.msgpack.encode({"from": "tomorrow"}))
    newer = copied(survey, tmp_path / "newer.mcap", start=other)
    damaged = copied(survey, tmp_path / "damaged.mcap", start=b"garbage")
    endless = copied(survey, tmp_path / "endless.mcap", later_ns=2**60)
    expected = {
        text: r"expected a flight record \(MCAP\), got one that begins with b'not a re'",
        tmp_path / "foreign.mcap": "expected a flight record of Recon, got another MCAP file",
        without: r"a record of version \S+ has no keyframes for the console; recon replay --check",
        stepless: "the record ends before its first event",
        stateless: "the record has no first state: it cannot be replayed",
        newer: r"a record of version \S+ cannot be replayed by this one",
        damaged: "the record's start is damaged",
        endless: "the record is damaged: it lasts for weeks",
    }
    for path, sentence in expected.items():
        with pytest.raises(RecordError, match=sentence):
            Playback(path)


def test_a_cut_file_is_replayed_as_far_as_it_goes(tmp_path: Path) -> None:
    """Wherever it is cut: refused with a sentence, or replayed to its new end."""
    scene = world(1, keeps_log=False)
    with recording(scene.driver, Site("test"), tmp_path) as record:
        for _ in range(4):
            scene.run_for(1.0)
            scene.order("SIM-1", Hover())
    whole, rng, cut = record.path.read_bytes(), random.Random(2), tmp_path / "cut.mcap"
    whole_ends_ns, replayed = played(record.path).ends_ns, 0
    for size in [len(whole) - 1, *(rng.randrange(len(whole)) for _ in range(12))]:
        cut.write_bytes(whole[:size])
        try:
            playback = played(cut)
        except RecordError:
            continue
        is_whole = playback.ends_ns == whole_ends_ns
        assert "was cut, or is being written" in playback.trouble or is_whole
        assert playback.move(playback.ends_ns).at_ns == playback.ends_ns
        replayed += not is_whole
    assert replayed >= 2


def test_damage_stops_the_replay_where_it_is(tmp_path: Path) -> None:
    """Moments elsewhere are still there to see."""
    path = copied(flight("survey"), tmp_path / "damaged.mcap")
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)
    replay, service = opened(path)
    assert len(service.state().vehicles) == 2
    reached = set()
    for at_s in range(0, 48, 2):
        view = seek(replay, at_s)
        assert view.position_s == replay.view().position_s
        if view.position_s == at_s:
            reached.add(at_s)
    assert "damaged chunk at byte" in str(replay.view().trouble)
    assert not replay.view().is_playing
    assert {0, 2, 44, 46} < reached
    missed_s = min(set(range(0, 48, 2)) - reached)
    for at_s in (missed_s, missed_s + 0.1, missed_s + 0.2):
        assert seek(replay, at_s).position_s == 46.0
    assert len(reached) < 24
    replay.log.start()
    replay.log.close()
    assert replay.marks().read_share == 1.0


def test_a_file_of_nothing_but_damage_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "damaged.mcap"
    data = bytearray(flight("survey").read_bytes())
    summary = make_reader(io.BytesIO(data)).get_summary()
    assert summary is not None
    for chunk in summary.chunk_indexes:
        data[chunk.chunk_start_offset + chunk.chunk_length // 2] ^= 0xFF
    path.write_bytes(data)
    with pytest.raises(RecordError, match="damaged chunk at byte"):
        opened(path)


@given(st.binary(max_size=200))
def test_no_bytes_are_a_keyframe_by_chance(data: bytes) -> None:
    with pytest.raises(RecordError):
        read_keyframe(values_codec(), data)


def test_changed_bytes_of_keyframes_and_maps_are_refused_or_read() -> None:
    """Whatever a hostile file holds where its checksums are right."""
    codec, rng, outcomes = values_codec(), random.Random(3), set[str]()
    playback = played(flight("pictures"))
    with flight("pictures").open("rb") as file:
        found = [item for item in McapReading(file).items() if isinstance(item, RecordMessage)]
    keyframe = next(item.data for item in found[::-1] if item.topic == KEYFRAMES_TOPIC)
    shade, sun = (
        next(item.data for item in found if item.topic == topic)
        for topic in (SHADE_TOPIC, SUN_TOPIC)
    )
    facts, frame = read_keyframe(codec, keyframe).maps, playback.start.site.frame
    assert facts is not None
    assert frame is not None

    def changed(data: bytes) -> bytes:
        at, to = sorted(rng.sample(range(min(len(data), rng.choice((200, len(data))))), 2))
        return data[:at] + rng.randbytes(rng.randrange(4)) + data[rng.choice((at + 1, to)) :]

    for _ in range(300):
        try:
            restored(read_keyframe(codec, changed(keyframe)), playback.start.station, None)
            maps_of(MapMessages(changed(shade), changed(sun)), facts, frame)
            outcomes.add("read")
        except RecordError:
            outcomes.add("refused")
    assert "refused" in outcomes


def test_a_fault_in_a_keyframe_costs_no_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> Iterator[bytes]:
        yield b""
        raise TypeError("no hint")

    monkeypatch.setattr(recording_of_kernel, "keyframe_pieces", fails)
    scene = world(1, keeps_log=False)
    with recording(scene.driver, Site("test"), tmp_path) as record:
        scene.run_for(3.0)
    assert "lacks states: TypeError: no hint" in str(scene.driver.station.record_problem)
    assert check(record.path).trouble == ""
