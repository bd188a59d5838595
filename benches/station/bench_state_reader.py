"""What one reader of the state stream costs the station, against another checkout of it.

    git worktree add /tmp/before COMMIT && cp src/recon/wire/*.so /tmp/before/src/recon/wire/
    python -m benches.station.bench_state_reader --before /tmp/before

Two processes do the same seconds of 64 moving drones in turn, one with this checkout and one with
the other. Counted are the views, the changes, their text and its compression, ten times a second;
not the packets and steps, which are there without a reader. Prints kB a second before and after
compression, and the ratio of the least processor times of a block.
"""

import argparse
import sys
import zlib
from collections.abc import Iterator
from pathlib import Path
from time import process_time

from benches.station.two_checkouts import ROOT, Side

APPS, TICK_HZ = 64, 10
BLOCK_S = 2
FILLED_BLOCKS = 35
"""Until tracks are as long as they get."""
MOST_KB_S, MOST_RATIO = 200.0, 0.4


def blocks() -> Iterator[tuple[float, float, float]]:
    """Yield of each block of seconds the processor time, and kB a second: as text and as sent."""
    from benches.station.fake_apps import core_packet, extended_packet, place_deg, serial

    from recon import wire
    from recon.api.state_changes import change_text
    from recon.model.event import LinkOpened, PacketReceived, Tick
    from recon.model.units import NS_PER_S
    from recon.site import default_site
    from recon.station.api_views.service import Service
    from recon.station.kernel.build import first_state
    from recon.station.kernel.driver import AsyncioDriver
    from recon.vehicles.reports import to_report

    now_ns = 0
    driver = AsyncioDriver(first_state(default_site()), lambda: now_ns)
    service, shown = Service.around(driver, default_site(), None), None
    deflate = zlib.compressobj(wbits=-12)
    for number in range(APPS):
        driver.handle(LinkOpened(number, "bench"))
    for tick in range(0, 10**9, BLOCK_S * TICK_HZ):
        spent_s = text_bytes = sent_bytes = 0.0
        for k in range(tick, tick + BLOCK_S * TICK_HZ):
            time_s = k / TICK_HZ
            for number in range(APPS):
                # Each app has its own moment within the tenth of a second.
                now_ns = k * NS_PER_S // TICK_HZ + number * 1_400_000
                place = place_deg(10.0 * number, time_s)
                packets = [core_packet(**place, yaw_deg=10.0 * time_s % 360.0)]
                packets += [extended_packet(serial(number).encode())] if k % 10 == 0 else []
                for packet in packets:
                    driver.handle(PacketReceived(number, to_report(wire.decode(packet))))
            now_ns = k * NS_PER_S // TICK_HZ + 95_000_000
            driver.handle(Tick())
            begin_s = process_time()
            state = service.state()
            text = (change_text(shown, state) if shown else state.model_dump_json()).encode()
            sent = deflate.compress(text) + deflate.flush(zlib.Z_SYNC_FLUSH)
            spent_s += process_time() - begin_s
            text_bytes, sent_bytes, shown = text_bytes + len(text), sent_bytes + len(sent), state
        yield spent_s, text_bytes / 1e3 / BLOCK_S, sent_bytes / 1e3 / BLOCK_S


def main() -> int:
    """Print both checkouts' figures and their ratio."""
    options = argparse.ArgumentParser()
    options.add_argument("--before", type=Path)
    options.add_argument("--rounds", type=int, default=15)
    options.add_argument("--work", type=int, choices=(0, 1, 2), help=argparse.SUPPRESS)
    given = options.parse_args()
    if given.work is not None:
        done = blocks()
        for _ in sys.stdin:
            print(next(done)[given.work], flush=True)
        return 0
    if given.before is None:
        options.error("--before: expected the folder of another checkout")
    figures = [_figures(folder, given.rounds) for folder in (ROOT, given.before)]
    ratio = figures[0][0] / figures[1][0]
    for name, (spent_s, text_kb_s, sent_kb_s) in zip(("here", "before"), figures, strict=True):
        share = 100.0 * spent_s / BLOCK_S
        print(f"{name}: {text_kb_s:.0f} kB/s, {sent_kb_s:.0f} compressed; {share:.1f} % of a core")
    print(f"{APPS} moving drones: {ratio:.2f} times the processor time for one reader")
    return 0 if ratio <= MOST_RATIO and figures[0][1] <= MOST_KB_S else 1


def _figures(folder: Path, rounds: int) -> tuple[float, float, float]:
    """Return least processor time of a block, and its kB a second as text and as sent."""
    found = []
    for which in range(3):
        side = Side(folder, __file__, "--work", str(which))
        try:
            for _ in range(FILLED_BLOCKS):
                side.block()
            found.append(min(side.block() for _ in range(rounds if which == 0 else 1)))
        finally:
            side.end()
    return found[0], found[1], found[2]


if __name__ == "__main__":
    raise SystemExit(main())
