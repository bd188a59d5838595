"""`recon demo`: a scenario's drones survey its field by themselves, and nothing stays behind."""

import json
import signal
import time
import urllib.request
from pathlib import Path

from tests.cli.processes import PATIENCE_S, started
from tests.small_field import small_field
from typer.testing import CliRunner

from recon.cli.commands import app


def children_of(pid: int) -> list[int]:
    text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    return [int(word) for word in text.split()]


def await_gone(pids: list[int]) -> None:
    """Wait until these have ended; one that was killed needs the processor for that."""
    give_up_at_s = time.monotonic() + PATIENCE_S
    while any(Path(f"/proc/{pid}").exists() for pid in pids):
        assert time.monotonic() < give_up_at_s, f"still running: {pids}"
        time.sleep(0.02)


def test_vehicles_fly_and_all_that_it_started_ends_with_the_demo(tmp_path: Path) -> None:
    scenario = small_field(tmp_path, drones=2)
    ports = ("--http-port", "0", "--link-port", "0")
    options = ("--scenario", str(scenario), "--record", str(tmp_path / "records"))
    with started("demo", *ports, *options) as demo:
        console = demo.line_with("console: ").partition(": ")[2]
        demo.line_with("Ctrl+C ends the demo")
        vehicles = await_vehicles(console, 3)
        assert all(v["is_simulated"] for v in vehicles)
        demo.line_with("survey 1: flown by SIM-1, SIM-2")
        demo.line_with("mission: started")
        children = children_of(demo.pid)
        assert len(children) == 3  # the simulator, the guard and the process that records
        assert demo.end(signal.SIGINT) == 0
        assert "Traceback" not in demo.text
        assert "scripted operator" not in demo.text
        await_gone(children)
    (record,) = (tmp_path / "records").iterdir()
    assert record.name.startswith("flight-")
    words = ("replay", "--what-if", "detection=otsu", "forecast=persistence", str(record))
    again = CliRunner().invoke(app, [*words, "--scenario", str(scenario)])
    assert again.exit_code == 0, again.output
    assert "equal to the bit: " in again.output
    assert "what if: detection otsu, forecast persistence" in again.output
    assert again.output.count("| false shade, % of cells in sun |") == 2


def test_it_ends_as_cleanly_before_anything_flies(tmp_path: Path) -> None:
    scenario = small_field(tmp_path, drones=2)
    ports = ("--http-port", "0", "--link-port", "0")
    with started("demo", *ports, "--scenario", str(scenario)) as demo:
        demo.line_with("Ctrl+C ends the demo")
        children = children_of(demo.pid)
        assert demo.end(signal.SIGTERM) == 0
        assert "Traceback" not in demo.text
        await_gone(children)


def test_a_bad_scenario_is_an_error_and_nothing_is_started(tmp_path: Path) -> None:
    scenario = small_field(tmp_path, drones=0)
    with started("demo", "--scenario", str(scenario)) as demo:
        assert demo.wait() == 2
        assert f"{scenario}:14: fleet.survey_drones: expected a whole number" in demo.text


def test_a_folder_of_something_else_is_refused_and_left_alone(tmp_path: Path) -> None:
    (tmp_path / "photo.jpg").touch()
    with started("demo", "--site", str(tmp_path)) as demo:
        assert demo.wait() == 2
        assert "expected a site's folder, or an empty one to make a site in" in demo.text
    assert [each.name for each in tmp_path.iterdir()] == ["photo.jpg"]


def await_vehicles(console: str, count: int) -> list[dict[str, object]]:
    give_up_at_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < give_up_at_s:
        with urllib.request.urlopen(f"{console}/api/vehicles", timeout=120) as response:
            vehicles: list[dict[str, object]] = json.load(response)
        if len(vehicles) == count:
            return vehicles
    raise AssertionError(f"expected {count} vehicles, got {vehicles}")
