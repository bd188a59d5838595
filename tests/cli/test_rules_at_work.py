"""The recipes of docs/how-to/see-the-rules-at-work.md, flown: what its simulator's faults show."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.cli.flown import Flown, Said, flown

Told = tuple[Flown, list[Said]]


@contextmanager
def nudged(folder: Path, *faults: str) -> Iterator[Told]:
    """As many drones as faults, nudged at once, each with its own fault on the way."""
    words = [word for fault in faults for word in ("--fault", fault)]
    ways = [f"SIM-{number}" for number, _ in enumerate(faults, 1)]
    with (
        flown(folder, len(faults), "--airborne", *words) as here,
        ThreadPoolExecutor() as beside,
    ):
        # Heard in the air with nothing ordered, they may count as their pilots'.
        assert [here.recon("take", *ways).code] == [0]
        nudge = ("--north", 24, "--speed", 1.5)
        yield here, list(beside.map(lambda serial: here.recon("nudge", serial, *nudge), ways))


@pytest.fixture(scope="module")
def beside_a_pilot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Told]:
    """The second one's pilot takes the sticks while the first one is not heard for a moment."""
    faults = ("telemetry-dropout:SIM-1:15:2", "pilot-takes:SIM-2:15:9")
    with nudged(tmp_path_factory.mktemp("audit"), *faults) as told:
        yield told


@pytest.fixture(scope="module")
def unheard(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Told]:
    """One alone: whoever flies beside a vehicle that is not heard is held for its hazard area."""
    with nudged(tmp_path_factory.mktemp("audit"), "telemetry-dropout:SIM-1:15:5") as told:
        yield told


def test_a_stream_outlives_two_seconds_without_telemetry(beside_a_pilot: Told) -> None:
    _here, (first, _second) = beside_a_pilot
    assert first.code == 0
    assert "it is there, and is held there" in first.out


def test_it_ends_after_three_with_an_alarm(unheard: Told) -> None:
    here, (only,) = unheard
    assert only.code == 1
    assert "Drone 1: failed (its telemetry was incomplete or missing for 3 s)" in only.out
    alarms = here.recon("alarms").out
    assert "Drone 1: nudge: its telemetry was incomplete or missing for 3 s" in alarms


def test_a_pilot_who_takes_the_sticks_has_them_and_is_told_nothing_more(
    beside_a_pilot: Told,
) -> None:
    here, (_first, second) = beside_a_pilot
    assert second.code == 1
    assert "Drone 2: superseded (the pilot has taken the sticks" in second.out
    orders = [line for line in here.recon("commands").out.splitlines() if "Drone 2" in line]
    assert [line.split()[3] for line in orders] == ["nudge"]
