"""docs/icd.md is normative: its tables and the code say the same."""

import re
import tomllib
from enum import IntEnum
from inspect import signature
from pathlib import Path
from typing import Any

import pytest

from recon import wire
from recon.model.vehicle import BatteryWarning, CameraState, FlightMode

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "icd.md").read_text(encoding="utf-8")
TABLE = tomllib.loads((ROOT / "protocol" / "recon-drone.toml").read_text(encoding="utf-8"))
PACKETS = {name: getattr(wire, name) for name in dir(wire) if hasattr(getattr(wire, name), "PID")}
BYTES = {"u8": 1, "i8": 1, "u16": 2, "f32": 4, "f64": 8, "string": 4, "image": 4, "rest": 0}
ZEROS = {"string": b"", "rest": b"", "u8": 0, "i8": 0, "u16": 0, "f32": 0.0, "f64": 0.0}


def table(text: str) -> list[list[str]]:
    """Rows of the first table in `text`, without its head."""
    found = re.search(r"(?:^ *\|.*\|\n)+", text, re.MULTILINE)
    assert found is not None, "no table"
    rows = [line.strip().strip("|").split("|") for line in found.group().splitlines()]
    return [[cell.strip() for cell in row] for row in rows[2:]]


def section(heading: str) -> str:
    """Text below a heading, up to the next one."""
    found = re.search(rf"^#+ {re.escape(heading)}\n(.*?)(?=^#|\Z)", PAGE, re.MULTILINE | re.DOTALL)
    assert found is not None, f"no section {heading}"
    return found.group(1)


def fields(packet: str) -> dict[str, str]:
    return {name: kind for name, kind, _ in table(section(packet))}


def least_size(packet: str) -> int:
    return 9 + sum(BYTES[kind] for kind in fields(packet).values())


def test_the_pid_table_is_the_codes() -> None:
    rows = {name: int(pid) for pid, name, _, _ in table(section("Packets"))}
    assert rows == {name: packet.PID for name, packet in PACKETS.items()}


def test_the_station_sends_what_has_a_pid_from_252() -> None:
    for pid, _, sender, _ in table(section("Packets")):
        assert sender == ("station" if int(pid) >= 252 else "app")


@pytest.mark.parametrize("packet", [*sorted(PACKETS), "Waypoint"])
def test_the_fields_are_the_codes(packet: str) -> None:
    assert list(fields(packet)) == list(signature(getattr(wire, packet)).parameters)


def test_the_sizes_follow_from_the_fields() -> None:
    for _, name, _, size in table(section("Packets")):
        assert int(size.split()[0]) == least_size(name), name
    assert sum(BYTES[kind] for kind in fields("Waypoint").values()) == 40


@pytest.mark.parametrize("packet", sorted(set(PACKETS) - {"Image", "ExecuteWaypointMission"}))
def test_an_encoded_packet_has_the_size_of_the_table(packet: str) -> None:
    values = {name: ZEROS[kind] for name, kind in fields(packet).items()}
    frame = wire.encode(PACKETS[packet](**values))
    assert len(frame) == least_size(packet)
    assert frame[:2] == (55975).to_bytes(2, "big")
    assert frame[6] == PACKETS[packet].PID


def test_the_limits_are_the_codes() -> None:
    limits = wire.Limits()
    rows = {name: int(most) for name, most in table(section("Reading a stream"))}
    sizes = [name for name in signature(wire.Limits).parameters if name.startswith("max_")]
    assert rows == {name: getattr(limits, name) for name in sizes}
    assert "no byte came for 2 s, when its first byte is 10 s old" in " ".join(PAGE.split())
    assert (limits.stall_timeout_ns, limits.age_timeout_ns) == (2 * 10**9, 10 * 10**9)


def test_the_counters_are_the_codes() -> None:
    names = [name for name, _ in table(section("Counters"))]
    counters = wire.Deframer().counters
    assert repr(counters) == f"Counters({', '.join(f'{n}={getattr(counters, n)}' for n in names)})"


def test_the_examples_decode() -> None:
    examples = [bytes.fromhex(text) for text in re.findall(r"`(daa7[0-9a-f]+)`", PAGE)]
    assert [wire.decode(frame) for frame in examples] == [
        wire.Acknowledgment(positive=1, source_pid=253),
        wire.EmergencyCommand(action=0),
    ]


def test_the_table_for_other_tools_has_the_pages_packets_and_limits() -> None:
    rows = [(int(pid), name, sender) for pid, name, sender, _ in table(section("Packets"))]
    assert rows == [(each["pid"], each["name"], each["from"]) for each in TABLE["packets"]]
    limits = {name: int(most) for name, most in table(section("Reading a stream"))}
    assert limits == TABLE["limits"]
    assert f"port {TABLE['port']} unless set otherwise" in PAGE
    assert f"{TABLE['sync']}: the bytes" in PAGE


@pytest.mark.parametrize(
    "packet",
    [*TABLE["packets"], {"name": "Waypoint", **TABLE["waypoint"]}],
    ids=lambda p: p["name"],
)
def test_the_table_for_other_tools_has_the_pages_fields(packet: dict[str, Any]) -> None:
    kinds = {"waypoints": "rest"}
    rows = {each["name"]: kinds.get(each["type"], each["type"]) for each in packet["fields"]}
    assert list(rows.items()) == list(fields(packet["name"]).items())


@pytest.mark.parametrize(
    ("name", "enum"),
    [
        ("flight_mode", FlightMode),
        ("camera_state", CameraState),
        ("battery_warning", BatteryWarning),
    ],
)
def test_the_table_for_other_tools_has_the_models_enumerations(
    name: str, enum: type[IntEnum]
) -> None:
    labels = {int(number): label for number, label in TABLE["enums"][name].items()}
    names = {number: label.upper().replace(" ", "_") for number, label in labels.items()}
    assert names == {each.value: each.name for each in enum}
