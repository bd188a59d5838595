"""Virtual time: how many times faster than real time eight vehicles fly, all bytes included.

Asked for: 50 times without vision, and with it whatever comes out. Times are the processor's, the
best of some. Beside each figure stand baselines of the same run, to judge it by on a busy machine:
the same apps flying as long with nobody listening, and a loop of plain Python. Run:

    python -m pytest benches/station/test_virtual_speed.py -s
"""

from time import process_time

import pytest
from tests.oracles.eight_vehicles import EightVehicles, eight_vehicles

BEGIN_S = 25.0
"""By then every drone flies its first mission."""
FLOWN_S = 60.0
SEEN_S = 12.0
ROUNDS = 3
LOOP = 1_000_000

MOST_LOOPS = {False: 270.0, True: 400.0}
"""What a second of flight may cost, in thousandths of the loop, without sticks and with them: 1.5
times what it did when it was last made faster."""


@pytest.mark.parametrize(
    ("steers", "name"), [(False, "missions and holds"), (True, "missions, holds and sticks")]
)
def test_eight_vehicles_without_vision(steers: bool, name: str) -> None:
    station_s = min(_flown_s(steers) for _ in range(ROUNDS)) / FLOWN_S
    apps_s = min(_apps_alone_s(steers) for _ in range(ROUNDS)) / FLOWN_S
    loop_s = _loop_s()
    print(
        f"\neight vehicles, {name}: {1.0 / station_s:.0f} times real time (50 asked for);"
        f" their apps alone: {1.0 / apps_s:.0f} times;"
        f" a second of flight costs {1e3 * station_s / loop_s:.0f} thousandths of a loop"
        f" of {LOOP:,} steps that takes {1e3 * loop_s:.0f} ms"
    )
    assert 1e3 * station_s / loop_s < MOST_LOOPS[steers]


def test_eight_vehicles_with_rendered_pictures() -> None:
    """The imaging drone's frames are rendered, sent, aligned with the ground and read."""
    scene = eight_vehicles(sees=True)
    source = scene.apps[0].feed.source if scene.apps[0].feed is not None else None
    assert source is not None
    source.prepare()
    scene.run_for(BEGIN_S)
    before, began_s = scene.driver.station.shade.number, process_time()
    scene.run_for(SEEN_S)
    took_s = process_time() - began_s
    pictures = scene.driver.station.shade.number - before
    blind_s = min(_flown_s(True) for _ in range(ROUNDS)) * SEEN_S / FLOWN_S
    print(
        f"\neight vehicles and {pictures / SEEN_S:.1f} pictures a second:"
        f" {SEEN_S / took_s:.1f} times real time;"
        f" {1e3 * (took_s - blind_s) / pictures:.0f} ms for each picture rendered and read"
    )
    assert pictures >= SEEN_S - 2.0
    assert scene.driver.station.shade.sun is not None
    assert took_s < SEEN_S


def _flown_s(steers: bool) -> float:
    scene = _begun(steers)
    began_s = process_time()
    scene.run_for(FLOWN_S)
    return process_time() - began_s


def _apps_alone_s(steers: bool) -> float:
    """The apps fly what they were told last, and what they say is thrown away."""
    scene = _begun(steers)
    now_ns = scene.driver.now_ns
    end_ns, began_s = now_ns + round(FLOWN_S * 1e9), process_time()
    while now_ns < end_ns:
        now_ns = min(app.next_due_ns for app in scene.apps)
        for app in scene.apps:
            if app.next_due_ns <= now_ns:
                app.advance(now_ns)
    return process_time() - began_s


def _begun(steers: bool) -> EightVehicles:
    scene = eight_vehicles(steers=steers)
    scene.run_for(BEGIN_S)
    assert len(scene.driver.station.fleet.vehicles) == len(scene.apps)
    return scene


def _loop_s() -> float:
    return min(_one_loop_s() for _ in range(ROUNDS))


def _one_loop_s() -> float:
    began_s, kept = process_time(), {}
    for number in range(LOOP):
        kept[number & 1023] = (number, kept.get(number & 511))
        if number & 4095 == 0:
            kept.clear()
    return process_time() - began_s
