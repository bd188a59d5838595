"""Companion apps whose aircraft fly north as their sticks say, and note when each stick arrives.

    python -m benches.station.stick_apps PORT --apps 8 --seconds 20

Prints one line of JSON when the time is over: the arrival times of each app's sticks, in seconds of
CLOCK_MONOTONIC.
"""

import argparse
import asyncio
import json
import time
from math import hypot
from typing import cast

import uvloop

from recon import wire

CORE_PERIOD_S = 0.1
CORE_PER_EXTENDED = 5
M_PER_DEG = 111_070.0
"""Of latitude, at these pads."""

APART_DEG = 0.0006
"""About 50 m of longitude: paths north are clear of each other."""

LATITUDE_DEG, LONGITUDE_DEG, HEIGHT_M = 41.9, -93.6, 40.0
JOYSTICK, POSITION = 12, 3


class StickApp(asyncio.Protocol):
    """One app; its aircraft goes over to sticks with the first one, and flies north at their speed.

    One that stood still while it is steered would be taken for frozen telemetry, and held.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.stick_at_s: list[float] = []
        self.north_m, self.speed_mps = 0.0, 0.0
        self.transport: asyncio.Transport | None = None
        self._deframer = wire.Deframer()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = cast(asyncio.Transport, transport)

    def data_received(self, data: bytes) -> None:
        now_s = time.monotonic()
        for packet in self._deframer.feed(data):
            if isinstance(packet, wire.VirtualStickCommand):
                self.stick_at_s.append(now_s)
                self.speed_mps = hypot(packet.velocity_x_mps, packet.velocity_y_mps)

    async def run(self, begin_s: float, seconds: float) -> None:
        """Say telemetry until the time is over."""
        assert self.transport is not None
        for tick in range(round(seconds / CORE_PERIOD_S)):
            phase_s = CORE_PERIOD_S * (self.number * 0.618 % 1.0)
            due_s = begin_s + phase_s + tick * CORE_PERIOD_S
            await asyncio.sleep(max(0.0, due_s - time.monotonic()))
            self.north_m += self.speed_mps * CORE_PERIOD_S
            self.transport.write(core(self.number, self.north_m, self.speed_mps))
            if tick % CORE_PER_EXTENDED == 0:
                self.transport.write(extended(self.number, bool(self.stick_at_s)))


def serial(number: int) -> str:
    """Return the serial of an app's aircraft."""
    return f"STICK-{number:02d}"


def core(number: int, north_m: float, speed_mps: float) -> bytes:
    """Return core telemetry of an aircraft that flies north, or stands in the air."""
    return wire.encode(
        wire.CoreTelemetry(
            is_flying=1,
            latitude_deg=LATITUDE_DEG + north_m / M_PER_DEG,
            longitude_deg=LONGITUDE_DEG + APART_DEG * number,
            altitude_m=275.0 + HEIGHT_M,
            height_above_takeoff_m=HEIGHT_M,
            velocity_north_mps=speed_mps,
            velocity_east_mps=0.0,
            velocity_down_mps=0.0,
            yaw_deg=0.0,
            pitch_deg=0.0,
            roll_deg=0.0,
        )
    )


def extended(number: int, is_steered: bool) -> bytes:
    """Return extended telemetry, in virtual stick mode once steered."""
    return wire.encode(
        wire.ExtendedTelemetry(
            gnss_satellite_count=16,
            gnss_signal_level=5,
            max_height_reached=0,
            max_distance_reached=0,
            battery_percent=95,
            battery_warning=0,
            wind_level=0,
            camera_state=0,
            flight_mode=JOYSTICK if is_steered else POSITION,
            mission_id=0,
            serial=serial(number).encode(),
        )
    )


async def run_apps(port: int, count: int, seconds: float) -> list[list[float]]:
    """Connect, fly for a time, and return the arrival times of each app's sticks."""
    loop = asyncio.get_running_loop()
    apps = [StickApp(number) for number in range(count)]
    for app in apps:
        await loop.create_connection(lambda app=app: app, "127.0.0.1", port)
    begin_s = time.monotonic()
    await asyncio.gather(*(app.run(begin_s, seconds) for app in apps))
    return [app.stick_at_s for app in apps]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("port", type=int)
    parser.add_argument("--apps", type=int, default=8)
    parser.add_argument("--seconds", type=float, default=20.0)
    asked = parser.parse_args()
    print(json.dumps(uvloop.run(run_apps(asked.port, asked.apps, asked.seconds))), flush=True)


if __name__ == "__main__":
    main()
