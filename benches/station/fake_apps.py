"""Companion apps of the benches: telemetry at its rates, images, and when each command was read.

    python -m benches.station.fake_apps PORT --apps 64 --streams 4 --flight hover --seconds 60

`--flight` is what the aircraft do: `hover`; `north`, as fast as the sticks say, because one that
stood still would be taken for frozen telemetry; or `circle`, over the demonstration's field. The
first `--streams` apps send raw images. With `--plain-port` as many bare sockets beside them note
when they read something, and with `--stamps-from-s` the reported altitude is the seconds of
CLOCK_MONOTONIC since then: a station believes no altitude of many kilometers, so the clock itself
cannot be the stamp. Ends with its time, or with its input; then prints one line of JSON: packets
sent by kind, and for each app and socket the times (CLOCK_MONOTONIC, s) of what it read.
"""

import argparse
import asyncio
import json
import math
import sys
import time
from collections import Counter
from typing import cast

import numpy as np
import uvloop

from recon import wire

CORE_PERIOD_S = 0.1
CORE_PER_EXTENDED = 5
CORE_PER_IMAGE = 2
IMAGE_ROWS, IMAGE_COLS = 720, 1280
CONNECTING_S = 120.0

LATITUDE_DEG, LONGITUDE_DEG = 41.9, -93.6
M_PER_LATITUDE_DEG, M_PER_LONGITUDE_DEG = 111_070.0, 82_960.0
GROUND_M, HEIGHT_M = 275.0, 40.0
POSITION, JOYSTICK = 3, 12


class HoveringApp(asyncio.Protocol):
    """Hovers, or stands on the ground; the first one is the site's imaging drone."""

    mode = POSITION

    def __init__(self, number: int, image: bytes | None = None, is_flying: bool = True) -> None:
        self.number = number
        self.serial = b"SIM-IMAGER" if number == 0 else serial(number).encode()
        self.image = image
        self.is_flying = is_flying
        self.stamps_from_s: float | None = None
        self.stops: list[tuple[float, int]] = []
        """When each emergency packet was read, and its action."""
        self.sticks: list[float] = []
        self.others = 0
        self.sent: Counter[str] = Counter()
        self.is_closed = asyncio.Event()
        self.transport: asyncio.Transport | None = None
        self._deframer = wire.Deframer()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = cast(asyncio.Transport, transport)

    def connection_lost(self, exc: Exception | None) -> None:
        self.is_closed.set()

    def data_received(self, data: bytes) -> None:
        read_at_s = time.monotonic()
        for packet in self._deframer.feed(data):
            if isinstance(packet, wire.EmergencyCommand):
                self.stops.append((read_at_s, packet.action))
            elif isinstance(packet, wire.VirtualStickCommand):
                self.sticks.append(read_at_s)
                self.steer(packet)
            else:
                self.others += 1

    async def fly(self, seconds: float = math.inf) -> None:
        """Send telemetry, and images if it has any; an app's phase within a period is its own."""
        assert self.transport is not None
        begin_s, tick = time.monotonic() + CORE_PERIOD_S * (self.number * 0.618 % 1.0), 0
        while tick < seconds / CORE_PERIOD_S:
            await asyncio.sleep(max(0.0, begin_s + tick * CORE_PERIOD_S - time.monotonic()))
            if tick % CORE_PER_EXTENDED == 0:
                self._write("extended", extended_packet(self.serial, self.mode))
            core = {"is_flying": int(self.is_flying), **self.core(tick)}
            if self.stamps_from_s is not None:
                core["altitude_m"] = time.monotonic() - self.stamps_from_s
            self._write("core", core_packet(**core))
            # An app whose socket is full leaves a picture out, as real ones do.
            is_time = tick % CORE_PER_IMAGE == 1 and not self.transport.get_write_buffer_size()
            if self.image is not None and is_time:
                self._write("images", self.image)
            tick += 1

    def _write(self, kind: str, packet: bytes) -> None:
        assert self.transport is not None
        self.transport.write(packet)
        self.sent.update({kind: 1, "bytes": len(packet)})

    def core(self, tick: int) -> dict[str, float]:
        """Return what is special about this tick's core telemetry."""
        place = place_deg(100.0 * (self.number // 8), 100.0 * (self.number % 8))
        return {**place, "height_above_takeoff_m": HEIGHT_M * self.is_flying, "yaw_deg": tick % 360}

    def steer(self, stick: wire.VirtualStickCommand) -> None:
        """Take a stick: one that hovers does not care."""


class SteeredApp(HoveringApp):
    """Goes over to sticks with the first one, and flies north at their speed."""

    north_m = speed_mps = 0.0

    def __init__(self, number: int, image: bytes | None = None) -> None:
        super().__init__(number, image)
        self.serial = serial(number).encode()

    def core(self, tick: int) -> dict[str, float]:
        self.north_m += self.speed_mps * CORE_PERIOD_S
        place = place_deg(self.north_m, APART_M * self.number)
        return {**place, "velocity_north_mps": self.speed_mps}

    def steer(self, stick: wire.VirtualStickCommand) -> None:
        self.mode = JOYSTICK
        self.speed_mps = math.hypot(stick.velocity_x_mps, stick.velocity_y_mps)


APART_M = 50.0
"""Paths north are clear of each other."""


class CirclingApp(HoveringApp):
    """Flies a circle of its own, with velocity and heading along it, which the station believes."""

    middle_m = (130.0, -280.0)
    """The demonstration's field, from the place of the others."""
    spacing_m, radius_m, speed_mps = 40.0, 10.0, 5.0
    a_row = 8

    def __init__(self, number: int, image: bytes | None = None) -> None:
        super().__init__(number, image)
        self.serial = serial(number).encode()

    def core(self, tick: int) -> dict[str, float]:
        angle = time.monotonic() * self.speed_mps / self.radius_m + self.number
        row, col = (at - (self.a_row - 1) / 2 for at in divmod(self.number, self.a_row))
        north_m = self.middle_m[0] + self.spacing_m * row + self.radius_m * math.sin(angle)
        east_m = self.middle_m[1] + self.spacing_m * col + self.radius_m * math.cos(angle)
        north_mps, east_mps = self.speed_mps * math.cos(angle), -self.speed_mps * math.sin(angle)
        return {
            **place_deg(north_m, east_m),
            "height_above_takeoff_m": HEIGHT_M + 3.0 * math.sin(angle / 3.0),
            "velocity_north_mps": north_mps,
            "velocity_east_mps": east_mps,
            "velocity_down_mps": -self.speed_mps / self.radius_m * math.cos(angle / 3.0),
            "yaw_deg": math.degrees(math.atan2(east_mps, north_mps)),
        }


FLIGHTS = {"hover": HoveringApp, "north": SteeredApp, "circle": CirclingApp}


def serial(number: int) -> str:
    """Return the serial of an app's aircraft."""
    return f"BENCH-{number:03d}"


def place_deg(north_m: float, east_m: float) -> dict[str, float]:
    """Return the fields of a place this far from that of the apps."""
    latitude_deg = LATITUDE_DEG + north_m / M_PER_LATITUDE_DEG
    return {
        "latitude_deg": latitude_deg,
        "longitude_deg": LONGITUDE_DEG + east_m / M_PER_LONGITUDE_DEG,
    }


def core_packet(**changes: float) -> bytes:
    """Return core telemetry of a vehicle that hovers, but for these fields."""
    hovering = {
        "is_flying": 1,
        **place_deg(0.0, 0.0),
        "altitude_m": GROUND_M + HEIGHT_M,
        "height_above_takeoff_m": HEIGHT_M,
        "velocity_north_mps": 0.0,
        "velocity_east_mps": 0.0,
        "velocity_down_mps": 0.0,
        "yaw_deg": 0.0,
        "pitch_deg": 0.0,
        "roll_deg": 0.0,
    }
    return wire.encode(wire.CoreTelemetry(**{**hovering, **changes}))  # type: ignore[arg-type]


def extended_packet(serial: bytes, mode: int = POSITION) -> bytes:
    """Return extended telemetry with a serial and a flight mode."""
    return wire.encode(
        wire.ExtendedTelemetry(
            gnss_satellite_count=16,
            gnss_signal_level=5,
            max_height_reached=0,
            max_distance_reached=0,
            battery_percent=95,
            battery_warning=0,
            wind_level=0,
            camera_state=2,
            flight_mode=mode,
            mission_id=0,
            serial=serial,
        )
    )


def image_packet(rows: int = IMAGE_ROWS, cols: int = IMAGE_COLS) -> bytes:
    """Return one raw image with the smooth colours and the texture of a field."""
    row, col = np.mgrid[0:rows, 0:cols]
    texture = np.random.default_rng(1).normal(0.0, 4.0, row.shape)
    green = 120.0 + 60.0 * np.sin(row / 90.0) * np.cos(col / 140.0) + texture
    pixels = np.stack([0.7 * green, green, 0.5 * green], axis=-1).clip(0, 255).astype(np.uint8)
    fps = 1.0 / (CORE_PERIOD_S * CORE_PER_IMAGE)
    return wire.encode(wire.Image(target_fps_hz=fps, pixels=pixels))


class PlainEnd(asyncio.Protocol):
    """Notes when each piece of data is read."""

    def __init__(self) -> None:
        self.read_at_s: list[float] = []

    def data_received(self, data: bytes) -> None:
        self.read_at_s.append(time.monotonic())


async def connect(asked: argparse.Namespace) -> tuple[list[HoveringApp], list[PlainEnd]]:
    """Connect the apps, and their bare sockets if there is a port for them."""
    loop = asyncio.get_running_loop()
    image = image_packet(asked.image_rows, asked.image_cols) if asked.streams else None
    apps: list[HoveringApp] = []
    plain: list[PlainEnd] = []
    for number in range(asked.apps):
        app = FLIGHTS[asked.flight](number, image if number < asked.streams else None)
        app.stamps_from_s = asked.stamps_from_s
        async with asyncio.timeout(CONNECTING_S):
            await loop.create_connection(lambda app=app: app, "127.0.0.1", asked.port)
            if asked.plain_port:
                end = PlainEnd()
                await loop.create_connection(lambda e=end: e, "127.0.0.1", asked.plain_port)
                plain.append(end)
        apps.append(app)
    return apps, plain


async def fly_all(asked: argparse.Namespace) -> dict[str, object]:
    """Fly for the time, or until the input ends; return what was sent and read."""
    apps, plain = await connect(asked)
    tasks = [asyncio.create_task(app.fly(asked.seconds or math.inf)) for app in apps]
    if asked.seconds:
        await asyncio.gather(*tasks)
    else:
        await asyncio.get_running_loop().run_in_executor(None, sys.stdin.read)
    for task in tasks:
        task.cancel()
    for app in apps:
        if app.transport is not None:
            app.transport.close()
    await asyncio.gather(*(app.is_closed.wait() for app in apps))
    return {
        "sent": dict(sum((app.sent for app in apps), Counter())),
        "stops": [[at_s for at_s, _ in app.stops] for app in apps],
        "sticks": [app.sticks for app in apps],
        "plain": [end.read_at_s for end in plain],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("port", type=int)
    parser.add_argument("--apps", type=int, default=64)
    parser.add_argument("--streams", type=int, default=0)
    parser.add_argument("--flight", choices=FLIGHTS, default="hover")
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--plain-port", type=int)
    parser.add_argument("--stamps-from-s", type=float)
    parser.add_argument("--image-rows", type=int, default=IMAGE_ROWS)
    parser.add_argument("--image-cols", type=int, default=IMAGE_COLS)
    print(json.dumps(uvloop.run(fly_all(parser.parse_args()))), flush=True)


if __name__ == "__main__":
    main()
