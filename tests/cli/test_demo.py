"""`recon demo`: four simulated vehicles are seen, and nothing stays behind."""

import json
import signal
import time
import urllib.request
from pathlib import Path

import pytest
from tests.cli.processes import PATIENCE_S, started


def children_of(pid: int) -> list[int]:
    text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    return [int(word) for word in text.split()]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_vehicles_fly_and_the_simulator_ends_with_the_demo(number: int) -> None:
    with started("demo", "--http-port", "0", "--link-port", "0", "--vehicles", "3") as demo:
        console = demo.line_with("console: ").partition(": ")[2]
        demo.line_with("Ctrl+C ends the demo")
        vehicles = await_vehicles(console, 3)
        assert all(v["is_simulated"] for v in vehicles)
        children = children_of(demo.process.pid)
        assert len(children) == 1
        assert demo.end(number) == 0
        assert "Traceback" not in demo.text
        assert not any(Path(f"/proc/{pid}").exists() for pid in children)


def await_vehicles(console: str, count: int) -> list[dict[str, object]]:
    give_up_at_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < give_up_at_s:
        with urllib.request.urlopen(f"{console}/api/vehicles", timeout=20) as response:
            vehicles: list[dict[str, object]] = json.load(response)
        if len(vehicles) == count:
            return vehicles
    raise AssertionError(f"expected {count} vehicles, got {vehicles}")
