"""Many companion apps in one process: telemetry at its rates, images, and every packet counted.

    python -m benches.station.app_load PORT --apps 64 --streams 4 --seconds 60 --stamps-from-s 0

Core Telemetry carries in its Altitude field how many seconds of CLOCK_MONOTONIC have passed since
`--stamps-from-s` when it is written: a station believes no altitude of many kilometers, so the
clock itself cannot be the stamp. Prints one line of JSON when all is sent: packets sent by kind,
and when each app read its first command.
"""

import argparse
import asyncio
import json
import time
from dataclasses import asdict, dataclass, field
from typing import cast

import numpy as np
import uvloop

from recon import wire

CORE_PERIOD_S = 0.1
EXTENDED_PERIOD_S = 0.5
IMAGE_PERIOD_S = 0.2
IMAGE_ROWS, IMAGE_COLS = 720, 1280
CONNECTING_S = 120.0


@dataclass
class Sent:
    """What one process of apps sent, and when each app's first command arrived."""

    core: int = 0
    extended: int = 0
    images: int = 0
    bytes: int = 0
    first_command_at_s: list[float] = field(default_factory=list)


class App(asyncio.Protocol):
    """One app: sends on its own timetable, notes its first command."""

    def __init__(self, number: int, sent: Sent, image: bytes | None) -> None:
        self.number = number
        self.sent = sent
        self.image = image
        self.has_command = False
        self.transport: asyncio.Transport | None = None
        self.is_closed = asyncio.Event()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = cast(asyncio.Transport, transport)

    def data_received(self, data: bytes) -> None:
        if not self.has_command:
            self.has_command = True
            self.sent.first_command_at_s.append(time.monotonic())

    def connection_lost(self, exc: Exception | None) -> None:
        self.is_closed.set()

    def write(self, packet: bytes) -> None:
        assert self.transport is not None
        self.transport.write(packet)
        self.sent.bytes += len(packet)

    async def run(self, begin_s: float, seconds: float, stamps_from_s: float) -> None:
        """Send until the time is over; an app's phase within the periods is its own."""
        begin_s += CORE_PERIOD_S * (self.number * 0.618 % 1.0)
        for tick in range(round(seconds / CORE_PERIOD_S)):
            due_s = begin_s + tick * CORE_PERIOD_S
            await asyncio.sleep(max(0.0, due_s - time.monotonic()))
            if tick % round(EXTENDED_PERIOD_S / CORE_PERIOD_S) == 0:
                self.write(extended_packet(self.number))
                self.sent.extended += 1
            self.write(core_packet(self.number, tick, time.monotonic() - stamps_from_s))
            self.sent.core += 1
            if self.image is not None and tick % round(IMAGE_PERIOD_S / CORE_PERIOD_S) == 1:
                self.write(self.image)
                self.sent.images += 1


def core_packet(number: int, tick: int, stamp_s: float) -> bytes:
    """Return core telemetry of a vehicle that hovers, with a time of sending as its altitude."""
    return wire.encode(
        wire.CoreTelemetry(
            is_flying=1,
            latitude_deg=41.9 + 1e-4 * number,
            longitude_deg=-93.6 + 1e-6 * tick,
            altitude_m=stamp_s,
            height_above_takeoff_m=30.0,
            velocity_north_mps=0.1,
            velocity_east_mps=0.0,
            velocity_down_mps=0.0,
            yaw_deg=float(tick % 360),
            pitch_deg=0.0,
            roll_deg=0.0,
        )
    )


def extended_packet(number: int) -> bytes:
    """Return extended telemetry with the app's serial."""
    return wire.encode(
        wire.ExtendedTelemetry(
            gnss_satellite_count=14,
            gnss_signal_level=4,
            max_height_reached=0,
            max_distance_reached=0,
            battery_percent=80,
            battery_warning=0,
            wind_level=0,
            camera_state=2,
            flight_mode=3,
            mission_id=0,
            serial=f"LOAD-{number:03d}".encode(),
        )
    )


def image_packet(rows: int = IMAGE_ROWS, cols: int = IMAGE_COLS) -> bytes:
    """Return one raw image of noise, sent again and again."""
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, 256, (rows, cols, 3), dtype=np.uint8)
    return wire.encode(wire.Image(target_fps_hz=1.0 / IMAGE_PERIOD_S, pixels=pixels))


async def send_load(
    port: int,
    apps: int,
    streams: int,
    seconds: float,
    image_size: tuple[int, int],
    stamps_from_s: float,
) -> Sent:
    """Connect, send for a time, close politely; return what was sent."""
    loop, sent = asyncio.get_running_loop(), Sent()
    image = image_packet(*image_size) if streams > 0 else None
    running = []
    for number in range(apps):
        app = App(number, sent, image if number < streams else None)
        async with asyncio.timeout(CONNECTING_S):
            await loop.create_connection(lambda app=app: app, "127.0.0.1", port)
        running.append(app)
    begin_s = time.monotonic() + 0.1
    await asyncio.gather(*(app.run(begin_s, seconds, stamps_from_s) for app in running))
    for app in running:
        assert app.transport is not None
        app.transport.close()
    await asyncio.gather(*(app.is_closed.wait() for app in running))
    return sent


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("port", type=int)
    parser.add_argument("--apps", type=int, default=64)
    parser.add_argument("--streams", type=int, default=4)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--image-rows", type=int, default=IMAGE_ROWS)
    parser.add_argument("--image-cols", type=int, default=IMAGE_COLS)
    parser.add_argument("--stamps-from-s", type=float, required=True)
    asked = parser.parse_args()
    image_size = (asked.image_rows, asked.image_cols)
    sent = uvloop.run(
        send_load(
            asked.port,
            asked.apps,
            asked.streams,
            asked.seconds,
            image_size,
            asked.stamps_from_s,
        )
    )
    print(json.dumps(asdict(sent)), flush=True)


if __name__ == "__main__":
    main()
