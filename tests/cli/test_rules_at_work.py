"""The recipes of docs/how-to/see-the-rules-at-work.md, flown: what its simulator's faults show."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest
from tests.cli.flown import Flown, Said, flown

FAULTS = ("telemetry-dropout:SIM-1:15:2", "telemetry-dropout:SIM-2:15:5", "pilot-takes:SIM-3:15:9")
Told = tuple[Flown, list[Said]]


@pytest.fixture(scope="module")
def nudged(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Told]:
    """Three drones nudged at once, each with its own fault on the way."""
    faults = [word for fault in FAULTS for word in ("--fault", fault)]
    with (
        flown(tmp_path_factory.mktemp("audit"), 3, "--airborne", *faults) as here,
        ThreadPoolExecutor() as beside,
    ):
        ways = [f"SIM-{number}" for number in (1, 2, 3)]
        # Heard in the air with nothing ordered, they count as their pilots'.
        assert [here.recon("take", *ways).code] == [0]
        words = ("--north", 24, "--speed", 1.5)
        yield here, list(beside.map(lambda serial: here.recon("nudge", serial, *words), ways))


def test_a_stream_outlives_two_seconds_without_telemetry(nudged: Told) -> None:
    _here, (first, _second, _third) = nudged
    assert first.code == 0
    assert "it is there, and is held there" in first.out


def test_it_ends_after_three_with_an_alarm(nudged: Told) -> None:
    here, (_first, second, _third) = nudged
    assert second.code == 1
    assert "Drone 2: failed (its telemetry was incomplete or missing for 3 s)" in second.out
    alarms = here.recon("alarms").out
    assert "Drone 2: nudge: its telemetry was incomplete or missing for 3 s" in alarms


def test_a_pilot_who_takes_the_sticks_has_them_and_is_told_nothing_more(nudged: Told) -> None:
    here, (_first, _second, third) = nudged
    assert third.code == 1
    assert "Drone 3: superseded (the pilot has taken the sticks" in third.out
    orders = [line for line in here.recon("commands").out.splitlines() if "Drone 3" in line]
    assert [line.split()[3] for line in orders] == ["nudge"]
