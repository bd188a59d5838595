"""`recon inspect` on bare streams, captures and damage."""

import io
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer

from recon import wire
from recon.cli.inspect import inspect, inspect_command, printable_bytes
from recon.link.capture import MAGIC, RECORD_HEADER

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


def record(time_ns: int, direction: int, data: bytes) -> bytes:
    return RECORD_HEADER.pack(time_ns, direction, len(data)) + data


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


def test_a_capture_shows_times_and_keeps_the_directions_apart() -> None:
    capture = (
        MAGIC
        + record(1_500_000_000, 0, ACK[:5])
        + record(1_600_000_000, 1, HOVER)
        + record(1_700_000_000, 0, ACK[5:])
    )
    shown = lines(capture)
    assert shown[0] == "1.600000 s  to app    EmergencyCommand action=0"
    assert shown[1] == "1.700000 s  from app  Acknowledgment positive=1 source_pid=253"
    assert [line.split(":")[0] for line in shown[2:]] == ["from app", "to app"]
    [first, *_] = objects(capture)
    assert (first["time_ns"], first["direction"]) == (1_600_000_000, "to_app")


@pytest.mark.parametrize("cut", range(1, len(record(0, 0, HOVER))))
def test_a_truncated_last_record_is_tolerated(cut: int) -> None:
    capture = MAGIC + record(0, 0, ACK) + record(2**64 - 1, 0, HOVER)
    shown = lines(capture[:-cut])
    assert shown[0].endswith("Acknowledgment positive=1 source_pid=253")
    assert len(shown) == 2


def test_a_damaged_capture_is_located() -> None:
    shown = lines(MAGIC + record(0, 1, HOVER) + record(0, 7, ACK))
    assert shown[0].endswith("EmergencyCommand action=0")
    assert shown[-1] == (
        "the capture is damaged at byte 33: expected direction 0 or 1, got 7; the rest is skipped"
    )


def test_a_missing_file_is_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit) as left:
        inspect_command([str(tmp_path / "none")])
    assert left.value.exit_code == 2
    output = capsys.readouterr().err
    assert output.startswith("recon inspect: cannot read ")
    assert output.endswith("none: No such file or directory\n")


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
