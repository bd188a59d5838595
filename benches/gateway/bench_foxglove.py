"""The Foxglove gateway's processor, with one client that reads every topic of some vehicles.

    python -m benches.gateway.bench_foxglove [--vehicles 8] [--seconds 30]

The gateway and a station that costs nearly nothing (`quick_station.py`) are processes of their own.
The station has no maps, frames, site or audit: what is measured is telemetry.
"""

import argparse
import asyncio
import subprocess
import sys
import time

from benches.gateway.bench_mavlink import processor_s
from tests.cli.processes import started
from tests.gateway.foxglove_client import foxglove_client

SHARE_LIMIT = 0.10


async def measure(port: int, pid: int, vehicles: int, seconds: float) -> bool:
    """Print the gateway's share of one core, and the locations that it sent a second."""
    async with foxglove_client(port) as client:
        for number in range(1, vehicles + 1):
            await client.until(f"/vehicles/SIM-{number}/location")
        client.received.clear()
        begun_s, spent_s = time.monotonic(), processor_s(pid)
        while time.monotonic() - begun_s < seconds:
            await client.read()
        lasted_s = time.monotonic() - begun_s
        share = (processor_s(pid) - spent_s) / lasted_s
    places = sum(len(each) for topic, each in client.received.items() if "location" in topic)
    rate = places / lasted_s
    print(f"{vehicles} vehicles: {rate:.0f} locations/s, {100 * share:.1f} % of one core")
    return share < SHARE_LIMIT


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--vehicles", type=int, default=8)
    parser.add_argument("--seconds", type=float, default=30.0)
    asked = parser.parse_args()
    program = (sys.executable, "-m", "benches.gateway.quick_station", str(asked.vehicles))
    with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as station:
        try:
            assert station.stdout is not None
            url = station.stdout.readline().partition(": ")[2].strip()
            words = ("--listen", "127.0.0.1:0", "--station", url)
            with started("gateway", "foxglove", *words) as gateway:
                line = gateway.line_with("Foxglove clients: ws://127.0.0.1:")
                port = int(line.rpartition(":")[2])
                is_good = asyncio.run(measure(port, gateway.pid, asked.vehicles, asked.seconds))
        finally:
            station.kill()
    print("good" if is_good else "FAILED: see the limit at the top of this file")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
