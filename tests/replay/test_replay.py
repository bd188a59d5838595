"""Replays of records: equal, changed, incomplete and hostile ones."""

import re
import textwrap
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import pytest
import zstandard
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.replay.flights import FOLDER
from tests.replay.record_flight import recording
from tests.replay.rounding import changes
from tests.station.station_world import World, world
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.model.command import Hover
from recon.model.errors import RecordError
from recon.model.event import Event
from recon.record.mcap.flight_messages import START_NAME
from recon.record.mcap.mcap_file import KEYFRAMES_TOPIC, STEPS_TOPIC, McapFile
from recon.record.mcap.mcap_read import McapReading, RecordAttachment, RecordMessage
from recon.site import Site
from recon.station.recording import replay
from recon.station.recording.playback import Playback
from recon.station.recording.replay import Replay, check, differences
from recon.station.state.imager_relief import Reliefs
from recon.station.state.station import Station
from recon.station.state.steps import SendCommand, Stepped


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two vehicles are held, and one link breaks."""
    scene: World = world(2, keeps_log=False)
    with recording(scene.driver, Site("test"), tmp_path_factory.mktemp("record")) as record:
        scene.run_for(3.0)
        scene.order("SIM-1", Hover())
        scene.run_for(2.0)
        scene.driver.disconnect(1)
        scene.run_for(1.0)
    return record.path


def items(path: Path) -> list[RecordMessage | RecordAttachment]:
    with path.open("rb") as file:
        return list(McapReading(file).items())


def test_an_unchanged_station_gives_the_same(flight: Path) -> None:
    found = check(flight)
    assert (found.differences, found.trouble) == ([], "")
    assert found.steps == sum(
        isinstance(item, RecordMessage) and item.topic == STEPS_TOPIC for item in items(flight)
    )
    ended = CliRunner().invoke(app, ["replay", "--check", str(flight)])
    assert ended.exit_code == 0
    assert f"equal to the bit: {found.steps} steps" in ended.output


def test_the_replayed_station_is_the_recorded_one(flight: Path) -> None:
    again = Replay()
    for item in items(flight):
        again.take(item)
    assert set(again.station.fleet.vehicles) == {"SIM-1", "SIM-2"}
    (order,) = again.station.orders.records.values()
    assert (order.command.serial, order.command.body) == ("SIM-1", Hover())


def test_an_order_that_is_not_given_any_more_is_a_difference(
    flight: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = replay.step

    def without_orders(station: Station, event: Event, now_ns: int) -> Stepped:
        station, outputs = real(station, event, now_ns)
        return station, tuple(each for each in outputs if not isinstance(each, SendCommand))

    monkeypatch.setattr(replay, "step", without_orders)
    found = check(flight)
    assert str(found.differences[0]).startswith(
        f"step {found.differences[0].step} at 3.000 s, OperatorOrder: outputs[1]: recorded "
        "{'send': {'command':"
    )
    assert str(found.differences[0]).endswith("now nothing")
    ended = CliRunner().invoke(app, ["replay", "--check", str(flight)])
    assert ended.exit_code == 1
    assert "differences within" in ended.output


def test_a_step_that_raises_now_is_a_difference(
    flight: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = replay.step

    def broken(station: Station, event: Event, now_ns: int) -> Stepped:
        if type(event).__name__ == "LinkClosed":
            raise RuntimeError("broken now")
        return real(station, event, now_ns)

    monkeypatch.setattr(replay, "step", broken)
    assert check(flight).differences


def test_the_guide_stops_at_the_step_of_the_flight() -> None:
    guide = Path(__file__).parents[2] / "docs/how-to/report-a-bug.md"
    (block,) = re.findall(r"```python\n(.*?) *```", guide.read_text(encoding="utf-8"), re.DOTALL)
    names: dict[str, Any] = {}
    code = textwrap.dedent(block).replace("FILE.mcap", str(FOLDER / "faults.mcap"))
    exec(compile(code, str(guide), "exec"), names)
    assert names["replay"].found.steps == 133
    assert names["replay"].station.fleet.vehicles


def test_differences_are_paths_to_values() -> None:
    recorded = {"outputs": [{"send": {"height_m": 40.0, "links": [1, 2]}}]}
    now = {"outputs": [{"send": {"height_m": 40, "links": [1]}}]}
    assert list(differences("", recorded, now)) == [
        ("outputs[0].send.height_m", 40.0, 40),
        ("outputs[0].send.links[1]", 2, None),
    ]
    nan = {"a": [float("nan"), -0.0]}
    assert list(differences("", nan, {"a": [float("nan"), 0.0]})) == [("a[1]", -0.0, 0.0)]


def rewritten(path: Path, folder: Path, change: Any) -> Path:
    """The record with its items changed, or excluded where `change` returns None."""
    file = McapFile(folder / "changed.mcap", "test")
    channels: dict[str, int] = {}
    for item in items(path):
        kept = change(item)
        if isinstance(kept, RecordAttachment):
            file.add_attachment(kept.name, kept.media_type, kept.data, 0)
        elif isinstance(kept, RecordMessage):
            if kept.topic not in channels:
                schema = file.add_schema(kept.schema, kept.encoding, b"") if kept.schema else 0
                channels[kept.topic] = file.add_channel(kept.topic, kept.encoding, schema)
            file.add_message(channels[kept.topic], kept.sequence, kept.log_ns, kept.data)
    file.finish()
    return file.path


def is_step(item: RecordMessage | RecordAttachment, numbers: range) -> bool:
    return (
        isinstance(item, RecordMessage) and item.topic == STEPS_TOPIC and item.sequence in numbers
    )


def test_steps_that_were_lost_end_the_comparison(flight: Path, tmp_path: Path) -> None:
    lost = rewritten(flight, tmp_path, lambda i: None if is_step(i, range(50, 60)) else i)
    found = check(lost)
    assert found.steps == 49
    assert found.trouble.startswith("steps 50 to 59 were not recorded")
    assert CliRunner().invoke(app, ["replay", "--check", str(lost)]).exit_code == 3


def test_images_that_were_left_out_end_the_comparison(tmp_path: Path) -> None:
    def without(item: RecordMessage | RecordAttachment) -> object:
        is_image = isinstance(item, RecordMessage) and item.topic.endswith("/jpeg")
        return None if is_image else item

    found = check(rewritten(FOLDER / "pictures.mcap", tmp_path, without))
    assert not found.differences
    assert "an image was not recorded" in found.trouble


def test_a_field_of_another_version_is_a_warning(flight: Path, tmp_path: Path) -> None:
    def newer(item: RecordMessage | RecordAttachment) -> object:
        if is_step(item, range(10, 11)):
            assert isinstance(item, RecordMessage)
            message = msgspec.msgpack.decode(item.data)
            message["event"] |= {"colour": 1}
            return _with(item, message)
        return item

    path = rewritten(flight, tmp_path, newer)
    found = check(path)
    assert (found.differences, found.trouble) == ([], "")
    assert len(found.skipped) == 1
    ended = CliRunner().invoke(app, ["replay", "--check", str(path)])
    assert ended.exit_code == 0
    assert f"warning: skipped, for another version wrote them: {found.skipped.pop()}" in (
        ended.output
    )


LATER = {"reliefs", "person", "given_at_ns", "takeoff_point", "stop_latch", "link_limits"}
"""Fields with defaults: of the station, of vehicles and of orders."""


def _earlier(value: Any) -> Any:
    """Maps as a version wrote them that had none of the fields in `LATER`."""
    if isinstance(value, dict):
        return {key: _earlier(part) for key, part in value.items() if key not in LATER}
    return [_earlier(each) for each in value] if isinstance(value, list) else value


def test_a_record_from_before_a_field_with_a_default_gives_the_same(tmp_path: Path) -> None:
    """First state, events, outputs and keyframes take the default; inputs keep their digests."""
    removed = 0

    def earlier(item: RecordMessage | RecordAttachment) -> object:
        nonlocal removed
        if isinstance(item, RecordAttachment):
            if item.name != START_NAME:
                return item
            before = zstandard.ZstdDecompressor().decompress(item.data)
        elif item.topic in (STEPS_TOPIC, KEYFRAMES_TOPIC):
            before = item.data
        else:
            return item
        data = msgspec.msgpack.encode(_earlier(msgspec.msgpack.decode(before)))
        removed += data != before
        if isinstance(item, RecordAttachment):
            return replace(item, data=zstandard.ZstdCompressor().compress(data))
        return replace(item, data=data)

    source = FOLDER / "survey.mcap"
    path = rewritten(source, tmp_path, earlier)
    found = check(path)
    assert (changes(found), found.trouble) == ([], "")
    assert found.jobs == check(source).jobs
    assert removed > 20
    playback = Playback(path)
    assert playback.move(playback.ends_ns).station.reliefs == Reliefs()
    playback.close()


def _with(item: RecordMessage, message: object) -> RecordMessage:
    data = msgspec.msgpack.encode(message)
    return RecordMessage(item.topic, item.encoding, item.schema, item.sequence, item.log_ns, data)


def test_another_mcap_file_is_refused(tmp_path: Path) -> None:
    file = McapFile(tmp_path / "other.mcap", "test")
    file.add_message(file.add_channel("/other", "json"), 1, 1, b"{}")
    file.finish()
    with pytest.raises(RecordError, match="expected a flight record of Recon"):
        check(file.path)


@pytest.mark.parametrize("content", [b"", b"text", b"\x89MCAP0\r\n"])
def test_other_bytes_are_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(content)
    with pytest.raises(RecordError, match="expected"):
        check(path)


@pytest.fixture(scope="module")
def some_items(flight: Path) -> list[RecordMessage | RecordAttachment]:
    return [each for each in items(flight) if not is_step(each, range(40, 10_000))]


@given(st.data())
@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_damaged_step_is_a_difference_or_one_error(
    some_items: list[RecordMessage | RecordAttachment], data: st.DataObject
) -> None:
    number = data.draw(st.integers(1, 39))
    again = Replay()
    try:
        for item in some_items:
            damaged = item
            if is_step(item, range(number, number + 1)):
                assert isinstance(item, RecordMessage)
                content = bytearray(item.data)
                content[data.draw(st.integers(0, len(content) - 1))] = data.draw(
                    st.integers(0, 255)
                )
                damaged = RecordMessage(
                    item.topic,
                    item.encoding,
                    item.schema,
                    item.sequence,
                    item.log_ns,
                    bytes(content),
                )
            again.take(damaged)
    except RecordError:
        pass
