"""Companion apps that note when each emergency packet reaches them, and plain sockets beside them.

    python -m benches.station.stop_apps LINK_PORT PLAIN_PORT --apps 64 --streams 4

Telemetry at its rates; the first app is the site's eye and the first `streams` send raw images, so
that the station's worker is never idle. On the plain sockets nothing is sent; what comes is timed
alike. Ends with its input; then prints one line of JSON: for each app, and each plain socket, the
times (CLOCK_MONOTONIC, s) of what it read.
"""

import argparse
import asyncio
import json
import sys
import time
from typing import cast

import uvloop
from benches.station.app_load import (
    CONNECTING_S,
    CORE_PERIOD_S,
    EXTENDED_PERIOD_S,
    IMAGE_PERIOD_S,
    image_packet,
)

from recon import wire

IMAGER_SERIAL = b"SIM-IMAGER"


class StoppedApp(asyncio.Protocol):
    """Hovers, says so, and notes each emergency packet. On the ground, or in the air."""

    def __init__(self, number: int, image: bytes | None, is_flying: bool = True) -> None:
        self.number = number
        self.serial = IMAGER_SERIAL if number == 0 else f"STOP-{number:03d}".encode()
        self.image = image
        self.is_flying = is_flying
        self.stops: list[tuple[float, int]] = []
        """When each emergency packet was read, and its action."""
        self.others = 0
        self._deframer = wire.Deframer()
        self._transport: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.Transport, transport)

    def data_received(self, data: bytes) -> None:
        read_at_s = time.monotonic()
        for packet in self._deframer.feed(data):
            if isinstance(packet, wire.EmergencyCommand):
                self.stops.append((read_at_s, packet.action))
            else:
                self.others += 1

    async def fly(self) -> None:
        """Send telemetry, and images if it has any, until cancelled."""
        assert self._transport is not None
        begin_s, tick = time.monotonic() + CORE_PERIOD_S * (self.number * 0.618 % 1.0), 0
        while True:
            await asyncio.sleep(max(0.0, begin_s + tick * CORE_PERIOD_S - time.monotonic()))
            if tick % round(EXTENDED_PERIOD_S / CORE_PERIOD_S) == 0:
                self._transport.write(self._extended())
            self._transport.write(self._core(tick))
            is_time = tick % round(IMAGE_PERIOD_S / CORE_PERIOD_S) == 1
            # An app whose socket is full leaves a picture out, as real ones do.
            if self.image and is_time and self._transport.get_write_buffer_size() == 0:
                self._transport.write(self.image)
            tick += 1

    def _core(self, tick: int) -> bytes:
        return wire.encode(
            wire.CoreTelemetry(
                is_flying=int(self.is_flying),
                latitude_deg=41.9 + 1e-3 * (self.number // 8),
                longitude_deg=-93.6 + 1e-3 * (self.number % 8),
                altitude_m=305.0,
                height_above_takeoff_m=30.0 if self.is_flying else 0.0,
                velocity_north_mps=0.0,
                velocity_east_mps=0.0,
                velocity_down_mps=0.0,
                yaw_deg=float(tick % 360),
                pitch_deg=0.0,
                roll_deg=0.0,
            )
        )

    def _extended(self) -> bytes:
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
                serial=self.serial,
            )
        )


class PlainEnd(asyncio.Protocol):
    """Notes when each piece of data is read."""

    def __init__(self) -> None:
        self.read_at_s: list[float] = []

    def data_received(self, data: bytes) -> None:
        self.read_at_s.append(time.monotonic())


async def fly_until_told(link_port: int, plain_port: int, apps: int, streams: int) -> None:
    """Fly until the input ends; print what was read when."""
    loop = asyncio.get_running_loop()
    image = image_packet() if streams else None
    flying: list[StoppedApp] = []
    plain: list[PlainEnd] = []
    for number in range(apps):
        app, end = StoppedApp(number, image if number < streams else None), PlainEnd()
        async with asyncio.timeout(CONNECTING_S):
            await loop.create_connection(lambda app=app: app, "127.0.0.1", link_port)
            await loop.create_connection(lambda end=end: end, "127.0.0.1", plain_port)
        flying.append(app)
        plain.append(end)
    tasks = [asyncio.create_task(app.fly()) for app in flying]
    await loop.run_in_executor(None, sys.stdin.read)
    for task in tasks:
        task.cancel()
    told = {
        "stops": [[at_s for at_s, _ in app.stops] for app in flying],
        "actions": sorted({action for app in flying for _, action in app.stops}),
        "plain": [end.read_at_s for end in plain],
    }
    print(json.dumps(told), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("link_port", type=int)
    parser.add_argument("plain_port", type=int)
    parser.add_argument("--apps", type=int, default=64)
    parser.add_argument("--streams", type=int, default=4)
    asked = parser.parse_args()
    uvloop.run(fly_until_told(asked.link_port, asked.plain_port, asked.apps, asked.streams))


if __name__ == "__main__":
    main()
