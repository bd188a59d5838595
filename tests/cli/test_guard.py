"""The guard beside a real station: it stops vehicles when the station cannot, and outlives it."""

import json
import os
import signal
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.cli.processes import PATIENCE_S, started
from tests.cli.station_process import StationProcess, addresses, run_options, station_process

STOP_LINE = "all stop by the guard: curl -X POST "
FLYING = ("--airborne", "--wander")


def stop_all(url: str, by: str) -> dict[str, Any]:
    request = urllib.request.Request(url, json.dumps({"by": by}).encode(), method="POST")
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as response:
        answer: dict[str, Any] = json.load(response)
        return answer


def alarm_texts(station: StationProcess) -> list[str]:
    return [alarm["text"] for alarm in station.get("/api/state")["alarms"]]


def hold(vehicles: list[dict[str, Any]]) -> bool:
    return len(vehicles) == 2 and all(is_holding(vehicle) for vehicle in vehicles)


def is_holding(vehicle: dict[str, Any]) -> bool:
    speed = vehicle["velocity_ned"]
    return speed["north_mps"] is not None and (
        abs(speed["north_mps"]) + abs(speed["east_mps"]) + abs(speed["down_mps"]) < 0.5
    )


@contextmanager
def halted(pid: int) -> Iterator[None]:
    os.kill(pid, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(pid, signal.SIGCONT)


def test_with_the_station_halted_a_person_stops_all_at_its_guard(tmp_path: Path) -> None:
    with station_process(tmp_path, 2, *FLYING, guard=True) as station:
        url = stop_url_of_ready_guard(station)
        with halted(station.station.pid):
            answer = stop_all(url, "ann")
        assert sorted(answer["held"]) == ["Drone 1", "Drone 2"]
        assert answer["refused"] == []
        station.until(hold)
        assert any("The guard held" in text and "ann" in text for text in alarm_texts(station))
        station.station.line_with('by="ann (guard')  # it is latched here, too
        assert station.station.end(signal.SIGTERM) == 0


def test_after_the_stations_death_all_can_be_stopped_and_the_next_one_knows(tmp_path: Path) -> None:
    with station_process(tmp_path, 2, *FLYING, guard=True) as station:
        url = stop_url_of_ready_guard(station)
        station.station.send(signal.SIGKILL)
        station.station.wait()
        answer = stop_all(url, "bea")
        assert sorted(answer["held"] + answer["refused"]) == ["Drone 1", "Drone 2"]
        with started(*run_options(tmp_path, station.link_port, guard=True)) as successor:
            successor.line_with('by="bea (guard')
            next_url, _ = addresses(successor)
            again = StationProcess(successor, None, next_url, station.link_port, tmp_path)
            again.until(hold)  # the apps had to connect again: the old guard has let them go
            assert successor.end(signal.SIGTERM) == 0


def test_a_guard_that_ends_is_an_alarm_and_is_followed_by_another(tmp_path: Path) -> None:
    with station_process(tmp_path, 2, *FLYING, guard=True) as station:
        first = stop_url_of_ready_guard(station)
        for pid in guards_of(station.station.pid):
            os.kill(pid, signal.SIGKILL)
        station.station.line_with("at its guard: it has ended")
        assert stop_url_of_ready_guard(station) == first
        assert station.station.end(signal.SIGTERM) == 0
    assert guards_of(station.station.pid) == []


def test_a_guard_that_hangs_is_replaced(tmp_path: Path) -> None:
    with station_process(tmp_path, 2, *FLYING, guard=True) as station:
        stop_url_of_ready_guard(station)
        (hanging,) = guards_of(station.station.pid)
        os.kill(hanging, signal.SIGSTOP)
        station.station.line_with("at its guard: it has ended")
        stop_url_of_ready_guard(station)
        assert guards_of(station.station.pid) != [hanging]
        assert station.station.end(signal.SIGTERM) == 0


def test_the_shells_all_stop_goes_to_the_guard_of_a_halted_station(tmp_path: Path) -> None:
    with station_process(tmp_path, 2, *FLYING, guard=True) as station:
        port = stop_url_of_ready_guard(station).rpartition(":")[2].removesuffix("/all-stop")
        with halted(station.station.pid):
            done = station.recon("all-stop", "--stop-port", port)
        assert done.code == 1, done.err  # sent, and not confirmed by telemetry
        assert sorted(done.out.splitlines()) == [
            "Drone 1: accepted (hover sent by its guard; the station does not answer)",
            "Drone 2: accepted (hover sent by its guard; the station does not answer)",
        ]
        station.until(hold)


def test_without_a_guard_there_is_no_stop_port(tmp_path: Path) -> None:
    with started(*run_options(tmp_path)) as station:
        addresses(station)
        assert guards_of(station.pid) == []
        assert not any(STOP_LINE in line for line in station.lines)
        assert station.end(signal.SIGTERM) == 0


def stop_url_of_ready_guard(station: StationProcess) -> str:
    """Return the stop port's address once the guard knows both vehicles by name."""
    url = station.station.line_with(STOP_LINE).removeprefix(STOP_LINE)
    for _ in range(round(10 * PATIENCE_S)):
        answer = stop_all(url, "tester")
        if sorted(answer["held"] + answer["refused"]) == ["Drone 1", "Drone 2"]:
            return url
        station.until(lambda vehicles: len(vehicles) == 2)
    raise AssertionError(f"the guard never knew both vehicles; last: {answer}")


def guards_of(pid: int) -> list[int]:
    """The guards among a process's children."""
    try:
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except OSError:
        return []
    return [
        int(child)
        for child in children
        if b"recon.guard.process" in Path(f"/proc/{child}/cmdline").read_bytes()
    ]
