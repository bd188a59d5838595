"""Companion apps whose drones fly circles over the demonstration's field.

    python -m benches.console.moving_apps LINK_PORT --apps 64

Telemetry at its rates, with velocity and heading along the circle, so that the station believes it;
with `--videos N` the first N send pictures, five a second. Ends with its input.
"""

import argparse
import asyncio
import math
import sys
import time

import numpy as np
import uvloop
from benches.station.app_load import CONNECTING_S, IMAGE_COLS, IMAGE_PERIOD_S, IMAGE_ROWS
from benches.station.stop_apps import StoppedApp

from recon import wire

ORIGIN_DEG = (41.9012, -93.6034)
METRES_PER_DEGREE = (111_070.0, 82_960.0)
"""Of latitude and longitude at the origin; WGS84."""
SPACING_M = 40.0
RADIUS_M = 10.0
SPEED_MPS = 5.0


class MovingApp(StoppedApp):
    """Flies a circle of its own in a square of so many drones."""

    def __init__(self, number: int, apps: int, image: bytes | None) -> None:
        super().__init__(number, image)
        self.serial = f"MOVE-{number:03d}".encode()
        side = math.ceil(math.sqrt(apps))
        row, col = divmod(number, side)
        self._centre_m = (SPACING_M * (row - (side - 1) / 2), SPACING_M * (col - (side - 1) / 2))

    def _core(self, tick: int) -> bytes:
        angle = time.monotonic() * SPEED_MPS / RADIUS_M + self.number
        north_m = self._centre_m[0] + RADIUS_M * math.sin(angle)
        east_m = self._centre_m[1] + RADIUS_M * math.cos(angle)
        north_mps, east_mps = SPEED_MPS * math.cos(angle), -SPEED_MPS * math.sin(angle)
        return wire.encode(
            wire.CoreTelemetry(
                is_flying=1,
                latitude_deg=ORIGIN_DEG[0] + north_m / METRES_PER_DEGREE[0],
                longitude_deg=ORIGIN_DEG[1] + east_m / METRES_PER_DEGREE[1],
                altitude_m=305.0,
                height_above_takeoff_m=30.0 + 3.0 * math.sin(angle / 3.0),
                velocity_north_mps=north_mps,
                velocity_east_mps=east_mps,
                velocity_down_mps=-SPEED_MPS / RADIUS_M * math.cos(angle / 3.0),
                yaw_deg=math.degrees(math.atan2(east_mps, north_mps)),
                pitch_deg=0.0,
                roll_deg=0.0,
            )
        )


def field_packet() -> bytes:
    """Return a raw picture with the smooth colours and the texture of a field."""
    rows, cols = np.mgrid[0:IMAGE_ROWS, 0:IMAGE_COLS]
    texture = np.random.default_rng(1).normal(0.0, 4.0, rows.shape)
    green = 120.0 + 60.0 * np.sin(rows / 90.0) * np.cos(cols / 140.0) + texture
    pixels = np.stack([0.7 * green, green, 0.5 * green], axis=-1).clip(0, 255).astype(np.uint8)
    return wire.encode(wire.Image(target_fps_hz=1.0 / IMAGE_PERIOD_S, pixels=pixels))


async def fly_until_input_ends(link_port: int, apps: int, videos: int) -> None:
    """Connect every app, then fly."""
    loop, flying = asyncio.get_running_loop(), list[MovingApp]()
    image = field_packet() if videos else None
    for number in range(apps):
        app = MovingApp(number, apps, image if number < videos else None)
        async with asyncio.timeout(CONNECTING_S):
            await loop.create_connection(lambda app=app: app, "127.0.0.1", link_port)
        flying.append(app)
    tasks = [asyncio.create_task(app.fly()) for app in flying]
    await loop.run_in_executor(None, sys.stdin.read)
    for task in tasks:
        task.cancel()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("link_port", type=int)
    parser.add_argument("--apps", type=int, default=64)
    parser.add_argument("--videos", type=int, default=0)
    asked = parser.parse_args()
    uvloop.run(fly_until_input_ends(asked.link_port, asked.apps, asked.videos))


if __name__ == "__main__":
    main()
