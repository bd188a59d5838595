"""Each process killed in flight, a disk that is full: what was lost, beside what is promised.

The promises are those of docs/safety/remembering.md. A kill is SIGKILL of one process that this
started; the full disk is a limit on the size of files that the writer of the record may write.
"""

import json
import random
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import psutil
from benches.station.bench_all_stop import ask
from benches.station.tile_readers import NAME

from recon.record.mcap.mcap_file import STEPS_TOPIC
from recon.record.mcap.mcap_read import McapReading, RecordMessage
from recon.station.recording.recording import RESTART_AFTER_S, RESTART_WITHIN_S
from studies.soak.clients import some_tiles
from studies.soak.surveyor import Surveyor, post
from studies.soak.world import World, wait_until

RECORD_LOSS_S = 1.0
FLOWN_S = 30.0
"""Time in the air before the first kill: rows are flown and cells imaged."""
QUIET_S = 8.0
"""Time after a restart in which nothing may be sent: nobody has ordered anything."""
SNAPSHOT_S = 1.0
LIVE_WITHIN_S = 10.0
LEAST_TILE_BYTES = 2_000
"""More than a sentence that the map is not read yet."""


@dataclass(slots=True)
class Findings:
    """What was promised and found, line by line."""

    broken: int = 0
    _case: str = field(default="")

    def begin(self, case: str) -> None:
        """Begin a case."""
        self._case = case
        print(f"{case}", flush=True)

    def note(self, promise: str, found: object, holds: bool) -> None:
        """Print one promise, and what was found."""
        self.broken += not holds
        print(f"  {'holds ' if holds else 'BROKEN'} {promise}: {found}", flush=True)


def cut_power(folder: Path, vehicles: int) -> int:
    """Kill each process in turn; print what was found, return the exit code."""
    world, findings = World(folder, vehicles, 60.0, faults_per_hour=0.001), Findings()
    with ExitStack() as stack:
        stack.callback(world.close)
        world.write()
        world.start_all()
        for case in (_station, _all_stop, _record, _disk, _guard, _maps, _gateway, _simulator):
            surveyor = Surveyor(world)
            try:
                wait_until(lambda: len(_flying(world)) >= vehicles // 2, "half of them in the air")
                time.sleep(FLOWN_S if case is _station else 0.0)
            finally:
                surveyor.end()
            case(world, findings)
    print("good" if not findings.broken else f"FAILED: {findings.broken} promises are broken")
    return 1 if findings.broken else 0


def _station(world: World, findings: Findings) -> None:
    findings.begin("the station is killed in flight")
    flying = _flying(world)
    newest = world.get("/api/timeline?at_most=1")["entries"][0]
    used = {each["id"] for each in world.get("/api/commands")}
    record = max(world.records.glob("*.mcap"))
    killed_s = _kill_station(world)
    lines = _audit_lines(world, -1)
    found = next((each for each in lines if each["n"] == newest["n"]), None)
    kept = found is not None and found["text"] == newest["text"]
    findings.note("the audit has what the console showed", f"entry {newest['n']}", kept)
    _note_record(findings, record, killed_s)
    world.start_station()
    known = {v["serial"] for v in world.get("/api/vehicles")}
    lost = flying - known
    findings.note("vehicles in flight are known again", f"lost {sorted(lost) or 'none'}", not lost)
    _note_nothing_sent(world, findings)
    verified = _recon("audit", "verify", str(world.audit))
    findings.note(
        "the audit's chain is whole", verified.stdout.strip()[-200:], not verified.returncode
    )
    surveys, regions = world.get("/api/surveys"), world.get("/api/flown-regions")["regions"]
    findings.note(
        "surveys end; their regions are kept", len(regions), not surveys and bool(regions)
    )
    world.wait_for_vehicles()
    answer = post(world.http_port, "/api/all-stop")
    numbers = {each["command_id"] for each in answer["results"]}
    post(world.http_port, "/api/all-stop/release", {"serials": None})
    findings.note("no order's number is used twice", f"from {min(numbers)}", not numbers & used)


def _all_stop(world: World, findings: Findings) -> None:
    findings.begin("the station is killed one second after an all stop")
    post(world.http_port, "/api/all-stop")
    time.sleep(SNAPSHOT_S)
    _kill_station(world)
    world.start_station()
    latch = world.get("/api/state")["stop_latch"]
    findings.note("the all stop is still in force", latch and latch["by"], latch is not None)
    _note_nothing_sent(world, findings)
    world.wait_for_vehicles()
    post(world.http_port, "/api/all-stop/release", {"serials": None})


def _record(world: World, findings: Findings) -> None:
    findings.begin("the process that writes the record is killed")
    record, killed_s = max(world.records.glob("*.mcap")), time.time()
    child = _child(world, "record")
    child.kill()
    _note_alarm(world, findings, "record")
    _note_record(findings, record, killed_s)
    within_s = RESTART_AFTER_S + RESTART_WITHIN_S + 10.0
    begun = _holds(lambda: _child(world, "record").pid != child.pid, within_s)
    findings.note("another one begins a new file", f"within {within_s:g} s", begun)
    _note_flying(world, findings)


def _disk(world: World, findings: Findings) -> None:
    findings.begin("the record's disk is full")
    wait_until(lambda: bool(list(world.records.glob("*.mcap"))), "a record")
    record = max(world.records.glob("*.mcap"))
    child = _child(world, "record")
    _, hard = child.rlimit(psutil.RLIMIT_FSIZE)
    child.rlimit(psutil.RLIMIT_FSIZE, (record.stat().st_size, hard))
    _note_alarm(world, findings, "record")
    _note_flying(world, findings)
    child.rlimit(psutil.RLIMIT_FSIZE, (resource.RLIM_INFINITY, hard))
    size = record.stat().st_size
    grows = _holds(lambda: max(world.records.glob("*.mcap")).stat().st_size != size, 60.0)
    findings.note("it is written again when there is room", record.name, grows)


def _guard(world: World, findings: Findings) -> None:
    findings.begin("the guard is killed")
    child = _child(world, "guard")
    child.kill()
    begun = _holds(lambda: _child(world, "guard").pid != child.pid, 30.0)
    findings.note("another guard is started", "within 30 s", begun)
    _note_flying(world, findings)


def _maps(world: World, findings: Findings) -> None:
    findings.begin("the process that reads base maps is killed")
    zoom, col, row = some_tiles(random.Random(1))[0]
    tile = f"/api/maps/{NAME}/{zoom}/{col}/{row}"
    ask(world.http_port, "GET", "/api/maps")
    wait_until(lambda: len(ask(world.http_port, "GET", tile)) > LEAST_TILE_BYTES, "a tile")
    before = ask(world.http_port, "GET", tile)
    _child(world, "maps").kill()
    answered = _holds(lambda: ask(world.http_port, "GET", tile) == before, 30.0)
    findings.note("the same tile is answered again", f"{len(before)} bytes", answered)
    _note_flying(world, findings)


def _gateway(world: World, findings: Findings) -> None:
    findings.begin("the gateway is killed")
    world.kill("gateway")
    _note_flying(world, findings)
    world.start_gateway()


def _simulator(world: World, findings: Findings) -> None:
    findings.begin("all apps are gone at once")
    flying = _flying(world)
    world.kill("simulator")
    wait_until(lambda: not world.live_serials(), "no live telemetry")
    left = _flying(world)
    findings.note("they still count as in the air", f"{len(left)} of {len(flying)}", left >= flying)
    _note_alarm(world, findings, "link_lost")
    world.start_simulator()
    world.wait_for_vehicles()
    findings.note("all connect again", f"{world.vehicles} vehicles", True)


def _kill_station(world: World) -> float:
    """Kill it, and wait until its record is finished; its guard stays for half a minute. Return
    when."""
    writer = _child(world, "record")
    killed_s = time.time()
    world.kill("station")
    wait_until(lambda: not _is_alive(writer), "the record's process to end with the station")
    return killed_s


def _is_alive(process: psutil.Process) -> bool:
    """Whether it runs: one whose parent is gone stays as a zombie where nobody reaps it."""
    with suppress(psutil.NoSuchProcess):
        return process.status() != psutil.STATUS_ZOMBIE
    return False


def _note_record(findings: Findings, record: Path, killed_s: float) -> None:
    last_s = _last_step_s(record)
    loss_s = killed_s - last_s
    findings.note(
        f"the record lacks at most {RECORD_LOSS_S:g} s", f"{loss_s:.2f} s", loss_s <= RECORD_LOSS_S
    )


def _last_step_s(record: Path) -> float:
    """Return the computer's time of the last step of a record."""
    last_ns = 0
    with record.open("rb") as file:
        for item in McapReading(file).items():
            if isinstance(item, RecordMessage) and item.topic == STEPS_TOPIC:
                last_ns = item.log_ns
    return last_ns / 1e9


def _note_nothing_sent(world: World, findings: Findings) -> None:
    """Wait, and look in the new run's audit: a start sends nothing."""
    time.sleep(QUIET_S)
    sent = [each["text"] for each in _audit_lines(world, -1) if each["kind"] == "order.sent"]
    findings.note("the start sends nothing", sent or f"nothing in {QUIET_S:g} s", not sent)


def _note_alarm(world: World, findings: Findings, rule: str) -> None:
    def raised() -> bool:
        return any(each["rule"] == rule for each in _active_alarms(world))

    is_raised = _holds(raised, 20.0)
    texts = [each["text"] for each in _active_alarms(world) if each["rule"] == rule]
    findings.note("an alarm states it", texts[0][:100] if texts else "none", is_raised)


def _note_flying(world: World, findings: Findings) -> None:
    """On a busy machine telemetry may be late by more than a second for a moment."""
    is_live = _holds(lambda: len(world.live_serials()) == world.vehicles, LIVE_WITHIN_S)
    findings.note("the fleet's telemetry is live", f"within {LIVE_WITHIN_S:g} s", is_live)


def _active_alarms(world: World) -> list[dict[str, Any]]:
    return [each for each in world.get("/api/state")["alarms"] if each["is_active"]]


def _flying(world: World) -> set[str]:
    vehicles = world.get("/api/vehicles")
    return {v["serial"] for v in vehicles if v["is_flying"]["value"] is True}


def _child(world: World, role: str) -> psutil.Process:
    return next(child for each, child in world.children() if each == role)


def _audit_lines(world: World, number: int) -> list[dict[str, Any]]:
    """Return the whole lines of one run's file, the last one's with -1."""
    text = sorted(world.audit.glob("*.jsonl"))[number].read_text("ascii")
    return [json.loads(line) for line in text[: text.rfind("\n") + 1].splitlines()]


def _holds(condition: Callable[[], bool], within_s: float) -> bool:
    """Return whether something comes to hold in time; a process in between is not there."""

    def holds() -> bool:
        with suppress(StopIteration, OSError):
            return condition()
        return False

    try:
        wait_until(holds, "it", within_s=within_s)
    except RuntimeError:
        return False
    return True


def _recon(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "recon", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)
