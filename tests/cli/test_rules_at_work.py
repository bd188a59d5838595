"""The recipes of docs/how-to/see-the-rules-at-work.md, with the simulator's faults."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.cli.station_process import CommandResult, StationProcess, station_process

Flights = tuple[StationProcess, list[CommandResult]]


@contextmanager
def nudged(folder: Path, *faults: str) -> Iterator[Flights]:
    """Nudge one drone per fault, all at once."""
    words = [word for fault in faults for word in ("--fault", fault)]
    serials = [f"SIM-{number}" for number, _ in enumerate(faults, 1)]
    with (
        station_process(folder, len(faults), "--airborne", *words) as station,
        ThreadPoolExecutor() as beside,
    ):
        # First received in the air, without an order: the pilots may have control of them.
        assert [station.recon("take", *serials).code] == [0]
        nudge = ("--north", 24, "--speed", 1.5)
        yield (
            station,
            list(beside.map(lambda serial: station.recon("nudge", serial, *nudge), serials)),
        )


@pytest.fixture(scope="module")
def beside_a_pilot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Flights]:
    """The second pilot takes the sticks while the first drone's telemetry is lost for 2 s."""
    faults = ("telemetry-dropout:SIM-1:15:2", "pilot-takes:SIM-2:15:9")
    with nudged(tmp_path_factory.mktemp("audit"), *faults) as flights:
        yield flights


@pytest.fixture(scope="module")
def lost_telemetry(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Flights]:
    """One drone only: another one near it would be held because of the hazard area."""
    with nudged(tmp_path_factory.mktemp("audit"), "telemetry-dropout:SIM-1:15:5") as flights:
        yield flights


def test_a_stream_outlives_two_seconds_without_telemetry(beside_a_pilot: Flights) -> None:
    _station, (first, _second) = beside_a_pilot
    assert first.code == 0
    assert "arrived; position held" in first.out


def test_it_ends_after_three_with_an_alarm(lost_telemetry: Flights) -> None:
    station, (only,) = lost_telemetry
    assert only.code == 1
    assert "Drone 1: failed (telemetry incomplete or missing for 3 s)" in only.out
    alarms = station.recon("alarms").out
    assert "Drone 1: nudge: telemetry incomplete or missing for 3 s" in alarms


def test_nothing_is_sent_after_the_pilot_takes_the_sticks(
    beside_a_pilot: Flights,
) -> None:
    station, (_first, second) = beside_a_pilot
    assert second.code == 1
    assert "Drone 2: superseded (the pilot has taken over" in second.out
    orders = [line for line in station.recon("commands").out.splitlines() if "Drone 2" in line]
    assert [line.split()[3] for line in orders] == ["nudge"]
