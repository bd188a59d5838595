"""`recon inspect` on bare streams, flight records and damage."""

import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import typer
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from recon import wire
from recon.cli.commands import app
from recon.cli.inspect import inspect, inspect_command, printable_bytes
from recon.record.mcap.link_bytes import LINKS_TOPIC, LinkMessage
from recon.record.mcap.mcap_file import McapFile

ACK = wire.encode(wire.Acknowledgment(positive=1, source_pid=253))
HOVER = wire.encode(wire.EmergencyCommand(action=0))
NASTY = wire.encode(wire.MessageString(type=2, text="\x1b[31mrot\n\u202e ä\\".encode() + b"\xff"))


def lines(stream: bytes) -> list[str]:
    out = io.StringIO()
    inspect(io.BytesIO(stream), False, out)
    return out.getvalue().splitlines()


def objects(stream: bytes) -> list[dict[str, Any]]:
    out = io.StringIO()
    inspect(io.BytesIO(stream), True, out)
    return [json.loads(line) for line in out.getvalue().splitlines()]


def flight_record(path: Path, *reads: tuple[int, int, bool, bytes]) -> bytes:
    """A record of reads: time in ns, link, whether from its app, bytes."""
    file = McapFile(path / "a.mcap", "test")
    channel = file.add_channel(LINKS_TOPIC, "msgpack")
    for number, (at_ns, *read) in enumerate(reads):
        data = msgspec.msgpack.encode(LinkMessage(*read))
        file.add_message(channel, number, at_ns, data)
    file.finish()
    return (path / "a.mcap").read_bytes()


def test_a_bare_stream_shows_each_packet_and_the_counters() -> None:
    shown = lines(b"junk" + ACK + HOVER)
    assert shown[:2] == ["Acknowledgment positive=1 source_pid=253", "EmergencyCommand action=0"]
    assert shown[2].startswith("stream: packets 2, packets_by_pid {3: 1, 255: 1}, bad_hash 0")
    assert shown[2].endswith("bytes_skipped 4")


def test_an_empty_stream_shows_nothing_but_counters() -> None:
    assert [line.split(",")[0] for line in lines(b"")] == ["stream: packets 0"]


def test_a_whole_packet_in_a_cut_off_one_is_shown() -> None:
    image = wire.encode(wire.Image(target_fps_hz=1, pixels=np.zeros((9, 9, 3), np.uint8)))
    assert lines(image[:-50] + HOVER)[0] == "EmergencyCommand action=0"


def test_text_from_the_wire_is_printable_bytes() -> None:
    [shown, _] = lines(NASTY)
    assert shown.isprintable()
    assert "rot" in shown
    assert printable_bytes(b"\x1b]0;x\x07\xff\\ \xc3\xa4") == "\\x1b]0;x\\x07\ufffd\\\\ \u00e4"
    [packet, _] = objects(NASTY)
    assert packet["fields"]["text"].isprintable()


def test_json_tells_every_field() -> None:
    image = wire.Image(target_fps_hz=2.0, pixels=np.zeros((3, 5, 3), np.uint8))
    camera = wire.CameraControl(action=1, target_fps_hz=float("nan"))
    unknown = wire.UnknownPacket(pid=99, payload=b"\x01\xff")
    jpeg = wire.CompressedImage(target_fps_hz=1.0, jpeg=b"1234")
    shown = objects(b"".join(map(wire.encode, (image, camera, unknown, jpeg))))
    assert shown[0] == {
        "packet": "Image",
        "pid": 2,
        "fields": {"target_fps_hz": 2.0, "rows": 3, "cols": 5},
    }
    assert shown[1]["fields"] == {"action": 1, "target_fps_hz": "nan"}
    assert (shown[2]["pid"], shown[2]["fields"]) == (99, {"pid": 99, "payload": "01ff"})
    assert shown[3]["fields"]["jpeg_bytes"] == 4
    assert shown[4]["counters"]["packets"] == 4


def test_a_mission_shows_its_waypoints() -> None:
    waypoint = wire.Waypoint(
        latitude_deg=44.5,
        longitude_deg=-93.0,
        altitude_m=300.0,
        corner_radius_m=0.25,
        speed_mps=5.0,
        loiter_time_s=float("nan"),
        gimbal_pitch_deg=-90.0,
    )
    mission = wire.ExecuteWaypointMission(land_at_end=0, curved_flight=0, waypoints=[waypoint])
    [shown, _] = objects(wire.encode(mission))
    assert shown["fields"]["waypoints"][0]["latitude_deg"] == 44.5
    assert shown["fields"]["waypoints"][0]["loiter_time_s"] == "nan"


def test_a_record_shows_times_and_keeps_the_directions_apart(tmp_path: Path) -> None:
    record = flight_record(
        tmp_path,
        (1_500_000_000, 3, True, ACK[:5]),
        (1_600_000_000, 3, False, HOVER),
        (1_700_000_000, 3, True, ACK[5:]),
    )
    shown = lines(record)
    assert shown[0] == "1.600000 s  link 3 to app  EmergencyCommand action=0"
    assert shown[1] == "1.700000 s  link 3 from app  Acknowledgment positive=1 source_pid=253"
    assert [line.split(":")[0] for line in shown[2:]] == ["link 3 from app", "link 3 to app"]
    [first, *_] = objects(record)
    assert (first["time_ns"], first["stream"]) == (1_600_000_000, "link 3 to app")


def test_a_record_that_was_cut_shows_what_is_whole(tmp_path: Path) -> None:
    record = flight_record(tmp_path, (0, 1, True, ACK), (2**63, 1, True, HOVER))
    end = record.index(b"zstd") + 120
    shown = lines(record[:end])
    assert shown[0].endswith("Acknowledgment positive=1 source_pid=253")
    assert shown[-1].startswith("the file ends without MCAP's summary")


@given(st.binary(max_size=200), st.sampled_from([ACK[:6], b"\x89MCAP0\r\n"]))
def test_any_bytes_behind_a_files_beginning_are_no_crash(data: bytes, start: bytes) -> None:
    assert lines(start + data)[-1:] != [""] or not data


def test_bytes_without_a_packet_are_an_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "text").write_bytes(b"no packet at all")
    (tmp_path / "good").write_bytes(HOVER)
    with pytest.raises(typer.Exit) as left:
        inspect_command([str(tmp_path / "text"), str(tmp_path / "good")])
    assert left.value.exit_code == 1
    output = capsys.readouterr()
    assert output.err.endswith("text holds no packet of the protocol\n")
    assert "EmergencyCommand" in output.out


def test_a_missing_file_is_one_sentence(tmp_path: Path) -> None:
    ended = CliRunner().invoke(app, ["inspect", str(tmp_path / "none")])
    assert ended.exit_code == 2
    assert ended.stderr.startswith("recon inspect: cannot read ")
    assert ended.stderr.endswith("none: No such file or directory\n")


def test_a_file_and_a_pipe_show_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "stream.bin"
    file.write_bytes(ACK + HOVER)
    inspect_command([str(file)])
    program = "from recon.cli.inspect import inspect_command; inspect_command(['-'])"
    piped = subprocess.run(
        [sys.executable, "-c", program], input=file.read_bytes(), capture_output=True, check=True
    )
    assert piped.stdout.decode() == capsys.readouterr().out
    assert b"Acknowledgment" in piped.stdout


def test_several_files_follow_each_other_by_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, data in (("a.bin", ACK), ("b.bin", HOVER)):
        (tmp_path / name).write_bytes(data)
    inspect_command([str(tmp_path / "a.bin"), str(tmp_path / "b.bin")])
    output = capsys.readouterr().out
    assert output.index("a.bin") < output.index("Acknowledgment") < output.index("b.bin")
    assert output.index("b.bin") < output.index("EmergencyCommand")
