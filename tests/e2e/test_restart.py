"""The station is killed in flight and started again: all is restored, and nothing is commanded.

Real processes and sockets: a station, a simulator whose drones fly missions, a relay between them
that counts every command packet, and the shell.
"""

import json
import signal
import socket
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from tests.cli.processes import Started, started
from tests.cli.station_process import StationProcess, addresses, run_options, sim_options
from tests.e2e.wire_tap import WireTap, tapped
from tests.record.audits import until

from recon.record.files.snapshot_file import read_snapshot
from recon.station.recovery.snapshot import decode_snapshot

VEHICLES = 3
HEIGHTS_M = {"SIM-1": 30.0, "SIM-2": 40.0, "SIM-3": 50.0}


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


def by_serial(vehicles: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    return {vehicle["serial"]: vehicle for vehicle in vehicles}


def modes(vehicles: list[dict[str, Any]]) -> set[str | None]:
    return {vehicle["flight_mode"]["value"] for vehicle in vehicles}


def write_mission(folder: Path, vehicle: dict[str, Any]) -> Path:
    """A mission of minutes: slowly back and forth over the takeoff point."""
    position, height_m = vehicle["position"], HEIGHTS_M[vehicle["serial"]]
    waypoints = [
        {
            "latitude_deg": position["latitude_deg"] + 0.00005 * (number % 2),
            "longitude_deg": position["longitude_deg"],
            "height_above_takeoff_m": height_m,
            "speed_mps": 0.5,
        }
        for number in range(10)
    ]
    path = folder / f"{vehicle['serial']}.json"
    path.write_text(json.dumps({"waypoints": waypoints}), encoding="utf-8")
    return path


def is_stored(audit: Path, command_id: int, phase: str) -> bool:
    """Whether the recovery snapshot holds an order; read while the station writes on."""
    snapshot = read_snapshot(audit, decode_snapshot).value
    assert snapshot is not None
    return any(o.id == command_id and o.phase.value == phase for o in snapshot.orders)


class Field:
    """The processes of the test."""

    def __init__(self, stack: ExitStack, folder: Path) -> None:
        self.stack, self.folder = stack, folder
        self.audit = folder / "audit"
        self.station_port = free_port()
        self.tap: WireTap = stack.enter_context(tapped(self.station_port))
        self.here = self.start()
        fault = ("--fault", "no-ack:SIM-3:0:600")
        sim = sim_options(self.tap.port, VEHICLES, "--grounded", *fault)
        self.simulator: Started = stack.enter_context(started(*sim))

    def start(self) -> StationProcess:
        station = self.stack.enter_context(started(*run_options(self.audit, self.station_port)))
        url, link_port = addresses(station)
        return StationProcess(station, None, url, link_port, self.audit)

    def take_off(self) -> None:
        standing = self.here.until(lambda them: len(them) == VEHICLES and None not in modes(them))
        for vehicle in standing:
            path = write_mission(self.folder, vehicle)
            flying = self.here.recon("fly", vehicle["serial"], path, "--takeoff")
            assert flying.code == 0, flying
        self.here.until(lambda them: modes(them) == {"gps_waypoint"})


@pytest.fixture
def field(tmp_path: Path) -> Any:
    with ExitStack() as stack:
        yield Field(stack, tmp_path)


def test_a_station_killed_in_flight_is_restored_and_commands_nothing(field: Field) -> None:
    field.take_off()
    here = field.here
    assert here.recon("release", "SIM-2", "--to", "pilot").code == 0
    # An open order: this drone has no camera, and its app answers nothing.
    (filming,) = here.recon("camera", "SIM-3", "--on", "--wait", "0", "--json").json
    until(lambda: is_stored(field.audit, filming["command_id"], "sent"))
    here.station.send(signal.SIGKILL)
    here.station.wait()
    field.tap.take()

    again = field.start()
    vehicles = again.until(
        lambda them: (
            len(them) == VEHICLES
            and all(v["link_id"] is not None and v["staleness"] == "live" for v in them)
            and None not in modes(them)
        )
    )
    flying = by_serial(vehicles)
    assert all(vehicle["is_flying"]["value"] for vehicle in flying.values())
    assert flying["SIM-1"]["flight_mode"]["value"] == "gps_waypoint"
    assert {s: v["authority"]["holder"] for s, v in flying.items()} == {
        "SIM-1": "operator",
        "SIM-2": "pilot",
        "SIM-3": "operator",
    }
    # Wait: orders are repeated every 0.7 s, and watchdogs run ten times a second.
    restored_ns = again.get("/api/state")["time_ns"]
    again.until(lambda _: again.get("/api/state")["time_ns"] > restored_ns + 4_000_000_000)
    assert field.tap.take() == {}

    state = again.get("/api/state")
    interrupted = {c["id"]: c for c in state["commands"]}[filming["command_id"]]
    assert interrupted["phase"] == "failed"
    assert "restarted" in interrupted["note"]
    assert any(a["rule"] == "restarted" and a["serial"] == "SIM-3" for a in state["alarms"])
    # Each vehicle comes close to its own hazard area before its telemetry returns: no alarm.
    assert not {"separation", "unidentified", "link_lost"} & {a["rule"] for a in state["alarms"]}

    verdict = again.recon("audit", "verify", field.audit)
    assert verdict.code == 0, verdict.out
    assert verdict.out.count(": intact,") == 2

    held = again.recon("hold", "SIM-1", "--json")
    assert held.code == 0, held.out
    assert held.json[0]["command_id"] > filming["command_id"]
    assert set(field.tap.take()) == {("SIM-1", "EmergencyCommand")}

    # Its takeoff point is restored: without it the gate would refuse every mission.
    dry = again.recon("fly", "SIM-1", field.folder / "SIM-1.json", "--dry-run")
    assert dry.code == 0, dry.out
    assert again.station.end(signal.SIGTERM) == 0
    assert again.recon("audit", "verify", field.audit).code == 0
