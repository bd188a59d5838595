"""What facts, photos and link figures cost the station, against another checkout of it.

    git worktree add /tmp/before COMMIT && cp src/recon/wire/*.so /tmp/before/src/recon/wire/
    python -m benches.station.bench_app_reports --before /tmp/before

Two processes do the same seconds of 64 apps in turn, one with this checkout and one with the other:
telemetry from bytes to the step, ticks, and ten times a second what a console is sent. In this one
each app also reports facts every ten seconds and a photo every two. Prints the ratio of
the least processor times of a block, and the same with plain apps in both.
"""

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from time import process_time

from benches.station.two_checkouts import ROOT, Side

APPS, CORE_HZ, TICK_HZ, STATE_HZ = 64, 10, 20, 10
FACTS_S = 10
BLOCK_S = 2
LIMIT = 1.05


def blocks(reports: bool) -> Iterator[float]:
    """Yield the processor time of each block of seconds."""
    from benches.station.fake_apps import core_packet, extended_packet, place_deg, serial

    from recon import wire
    from recon.api.state_changes import change_text
    from recon.model.event import LinkOpened, PacketReceived, Tick
    from recon.model.units import NS_PER_S
    from recon.site import default_site
    from recon.station.api_views.service import Service
    from recon.station.kernel.build import first_state
    from recon.station.kernel.driver import AsyncioDriver
    from recon.station.kernel.step import step
    from recon.vehicles.reports import to_report

    def told(found: dict[str, object]) -> bytes:
        text = b"recon 1 " + json.dumps(found).encode()
        return wire.encode(wire.MessageString(type=0, text=text))

    def packets(number: int, tick: int) -> Iterator[bytes]:
        time_s = tick / TICK_HZ
        place = place_deg(10.0 * number, time_s)
        yield core_packet(**place, yaw_deg=10.0 * time_s % 360.0)
        if tick % 10 == 0:
            yield extended_packet(serial(number).encode())
        if reports and tick % (FACTS_S * TICK_HZ) == 2 * number:
            yield told({**FACTS, "gimbal_yaw_deg": round(10.0 * time_s % 360.0, 1)})
        if reports and tick % (2 * TICK_HZ) == 2 * (number % 20):
            photo = {"index": 1 + tick // (2 * TICK_HZ), "age_s": 0.1, **place}
            yield told({"kind": "photos", "series": 1, "photos": [photo]})

    station, now_ns, tick = first_state(default_site()), 0, 0
    driver = AsyncioDriver(station, lambda: now_ns)
    service = Service.around(driver, default_site(), None)
    shown = service.state()
    for number in range(APPS):
        station, _ = step(station, LinkOpened(number, "bench"), 0)
    while True:
        made = [
            [list(packets(number, tick + k)) for number in range(APPS)]
            for k in range(0, BLOCK_S * TICK_HZ, 2)
        ]
        begin_s = process_time()
        for k in range(BLOCK_S * TICK_HZ):
            now_ns = (tick + k) * NS_PER_S // TICK_HZ
            for number in range(APPS) if k % 2 == 0 else ():
                for packet in made[k // 2][number]:
                    event = PacketReceived(number, to_report(wire.decode(packet)))
                    station, _ = step(station, event, now_ns)
            station, _ = step(station, Tick(), now_ns)
            if k % (TICK_HZ // STATE_HZ) == 0:
                driver.station = station
                state = service.state()
                shown = change_text(shown, state) and state
        tick += BLOCK_S * TICK_HZ
        yield process_time() - begin_s


FACTS = {
    "kind": "facts",
    "go_home_height_m": 60,
    "failsafe": "go_home",
    "home_latitude_deg": 41.9,
    "home_longitude_deg": -93.6,
    "max_height_m": 120,
    "max_distance_m": 2000,
    "model": "Mavic 3M",
    "firmware": "01.01.0300",
    "app": "Recon 1.0",
    "battery_cells_v": [3.91, 3.9, 3.92, 3.91],
    "battery_temperature_c": 31.5,
    "rtk": "fixed",
    "storage_left_mb": 58_211,
    "storage_left_photos": 7_104,
    "gimbal_pitch_deg": -90,
    "gimbal_roll_deg": 0,
    "camera_mode": "interval",
    "photo_interval_s": 2,
    "exposure_locked": True,
    "white_balance_locked": True,
    "can_fly_missions": True,
    "max_waypoints": 99,
    "dji_check_passed": True,
    "reports_photos": True,
}


def compared(before: Path, reports: bool, rounds: int) -> float:
    """Return the ratio of this checkout's time to the other's, with plain apps there.

    Other programs on the machine only add to a block's time: the least of each side counts.
    """
    words = (__file__, "--work")
    sides = Side(ROOT, *words, *(["--reports"] if reports else [])), Side(before, *words)
    try:
        for side in sides:
            side.block()  # warm
        took_s: dict[Side, list[float]] = {side: [] for side in sides}
        for number in range(rounds):
            for side in sides if number % 2 else sides[::-1]:
                took_s[side].append(side.block())
        return min(took_s[sides[0]]) / min(took_s[sides[1]])
    finally:
        for side in sides:
            side.end()


def main() -> int:
    """Print the two ratios."""
    options = argparse.ArgumentParser()
    options.add_argument("--before", type=Path)
    options.add_argument("--rounds", type=int, default=25)
    options.add_argument("--work", action="store_true", help=argparse.SUPPRESS)
    options.add_argument("--reports", action="store_true", help=argparse.SUPPRESS)
    given = options.parse_args()
    if given.work:
        done = blocks(given.reports)
        for _ in sys.stdin:
            print(next(done), flush=True)
        return 0
    if given.before is None:
        options.error("--before: expected the folder of another checkout")
    ratio = compared(given.before, True, given.rounds)
    plain = compared(given.before, False, given.rounds)
    print(
        f"{APPS} apps with facts, photos and link figures: {ratio:.3f} times the processor time of "
        f"the other checkout with plain apps; plain apps in both: {plain:.3f}"
    )
    return 0 if ratio <= LIMIT else 1


if __name__ == "__main__":
    raise SystemExit(main())
