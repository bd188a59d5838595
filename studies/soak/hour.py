"""The soak in real time: everything runs, is pressed and sampled; a table in each tenth of it."""

import time
from contextlib import ExitStack
from pathlib import Path

from benches.station.bench_all_stop import ask

from studies.soak.all_stop import AllStops
from studies.soak.clients import Clients
from studies.soak.figures import Sizes, Soak, faults_of, growth_lines, window_lines
from studies.soak.surveyor import Surveyor
from studies.soak.world import World, size_of

SAMPLES = 360
"""Looks in a whole run: one each ten seconds of an hour."""
SOONEST_SAMPLE_S = 2.0
LONGEST_WINDOW_S, WINDOW_SHARE = 600.0, 0.1
"""A table each ten minutes, in shorter runs each tenth."""


def soak_for(folder: Path, minutes: float, vehicles: int, stop_every_s: float) -> int:
    """Run everything for so long; print tables and verdict, return the exit code."""
    length_s = 60.0 * minutes
    soak, world = Soak(), World(folder, vehicles, minutes, faults_per_hour=2.0)
    with ExitStack() as stack:
        stack.callback(world.close)
        world.write()
        world.start_all()
        surveyor = Surveyor(world)
        stack.callback(surveyor.end)
        clients = Clients(world)
        stack.callback(clients.end)
        stops = AllStops(world)
        stack.callback(stops.end)
        ended = _watched(world, soak, surveyor, stops, length_s, stop_every_s)
    print(f"clients: {dict(clients.seen)}")
    print(f"surveys: {surveyor.requested} requested, {surveyor.finished} done")
    for reason in sorted(set(surveyor.refusals))[:10]:
        print(f"  refused {surveyor.refusals.count(reason)} times: {reason}")
    print("memory after the first sixth:")
    print("\n".join(growth_lines(soak, length_s)))
    faults = [*ended, *faults_of(soak, length_s)]
    for fault in faults:
        print(f"FAILED: {fault}")
    print("good" if not faults else f"files of the run: {folder}")
    return 1 if faults else 0


def _watched(
    world: World,
    soak: Soak,
    surveyor: Surveyor,
    stops: AllStops,
    length_s: float,
    stop_every_s: float,
) -> list[str]:
    """Sample, press and print until the end; return why it ended early."""
    began_s = time.monotonic()
    sample_every_s = max(SOONEST_SAMPLE_S, length_s / SAMPLES)
    window_s = min(LONGEST_WINDOW_S, WINDOW_SHARE * length_s)
    sample_at_s, press_at_s, window_end_s = 0.0, stop_every_s, window_s
    while (now_s := time.monotonic() - began_s) < length_s:
        ended = world.ended()
        if ended:
            return ended
        if now_s >= sample_at_s:
            sample_at_s = now_s + sample_every_s
            _sample(world, soak, now_s)
        if now_s >= press_at_s:
            press_at_s = now_s + stop_every_s
            stopped = stops.press(now_s)
            if stopped is not None:
                soak.stops.append(stopped)
            surveyor.start_again_soon()
        if now_s >= window_end_s:
            print("\n".join(window_lines(soak, window_end_s - window_s, window_end_s)), flush=True)
            window_end_s += window_s
        time.sleep(0.1)
    if window_end_s - window_s < 0.99 * length_s:
        print("\n".join(window_lines(soak, window_end_s - window_s, window_end_s)), flush=True)
    return []


def _sample(world: World, soak: Soak, now_s: float) -> None:
    soak.processes.extend(world.samples(now_s))
    state = ask(world.http_port, "GET", "/api/state")
    soak.sizes.append(Sizes(now_s, len(state), size_of(world.records)))
