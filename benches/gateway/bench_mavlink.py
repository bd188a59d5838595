"""The MAVLink gateway at 64 vehicles: its processor, what it adds to an order, its codec.

    python -m benches.gateway.bench_mavlink [--vehicles 64] [--seconds 30] [--orders 200]

The gateway and a station that costs nearly nothing (`quick_station.py`) are processes of their own;
a client reads all by TCP. Orders are holds to one vehicle, by turns through the gateway and by the
Python client; what the gateway adds is the difference of the two times at each percentile. The
codec is Recon's own, of the drone protocol, beside pymavlink's on a message of the same content, in
one run.
"""

import argparse
import asyncio
import os
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import msgspec
import numpy as np
from benches.gateway.quick_station import INTERVAL_S, QuickStation
from pymavlink.dialects.v20 import common as mavlink
from tests.cli.processes import started
from tests.gateway.running_gateway import Client

from recon import wire
from recon.client import Station
from recon.client.messages import StateMessage
from recon.gateway.mavlink.encoder import Encoder
from recon.gateway.mavlink.inputs_outputs import Send, StationSeen
from recon.gateway.mavlink.run import VEHICLES_AT_ONCE
from recon.gateway.mavlink.step import step
from recon.gateway.mavlink.values import GatewayState

LOOP = 100_000
STATES = 50
ROUNDS = 5
GROUND = "--ground-above-sea-level", "280"
"""The quick station has no site to ask."""
SHARE_LIMIT, ADDED_LIMIT_MS, CODEC_LIMIT = 0.15, 5.0, 5.0
READ_BYTES = 2**20
ACCEPTED = bytes((1, 1, 77, 0, 0, 176))
"""System, component and number of a COMMAND_ACK, and the command that it answers: accepted, as
zeros at its end are left out."""


def processor_s(pid: int) -> float:
    """Processor time of a process, user and system, in seconds."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


async def share_of_core(client: Client, pid: int, seconds: float) -> tuple[float, float]:
    """Return the gateway's share of one core, and the positions it sent a second."""
    await client.until("HEARTBEAT")
    begun_s, spent_s, begun = time.monotonic(), processor_s(pid), len(client.received)
    while time.monotonic() - begun_s < seconds:
        await client.until("HEARTBEAT")
    lasted_s = time.monotonic() - begun_s
    places = sum(m.get_type() == "GLOBAL_POSITION_INT" for m in client.received[begun:])
    return (processor_s(pid) - spent_s) / lasted_s, places / lasted_s


async def order_ms(port: int, station: Station, serial: str, orders: int) -> np.ndarray:
    """Return times of holds through the gateway and by the client, (orders, 2), milliseconds.

    The answer is looked for in the bytes: pymavlink would take milliseconds for what comes before.
    """
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    hold = mavlink.MAVLink_command_long_message(1, 1, 176, 0, 1, 4, 3, 0, 0, 0, 0)
    packed = hold.pack(mavlink.MAVLink(None, 255, 190))
    times = np.zeros((orders, 2))
    for number in range(orders * 2):
        quiet_until_s = time.perf_counter() + 0.05 + 0.001 * (number % 97)
        while (left_s := quiet_until_s - time.perf_counter()) > 0.0:
            with suppress(TimeoutError):
                await asyncio.wait_for(reader.read(READ_BYTES), left_s)
        begun_s = time.perf_counter()
        if number % 2:
            await station.known(serial).hold()
        else:
            writer.write(packed)
            while ACCEPTED not in await reader.read(READ_BYTES):
                pass
        times[number // 2, number % 2] = time.perf_counter() - begun_s
    writer.close()
    return 1e3 * times


def longest_work_ms(vehicles: int) -> float:
    """Return the longest piece of the gateway's loop that an order may wait for.

    In processor time: it is the same on a busy machine, where the times of orders are not.
    """
    station, state, encoder = QuickStation(vehicles), GatewayState(), Encoder()
    longest_s = 0.0
    for _ in range(STATES):
        text, begun_s = station.text(), time.thread_time()
        message = msgspec.json.decode(text, type=StateMessage)
        decoded_s = time.thread_time()
        state, outputs = step(state, StationSeen(message), time.monotonic_ns())
        stepped_s = time.thread_time()
        for output in outputs[:VEHICLES_AT_ONCE]:
            assert isinstance(output, Send)
            encoder.encode(output.system_id, output.messages, 0.0)
        sent_s = time.thread_time()
        longest_s = max(longest_s, decoded_s - begun_s, stepped_s - decoded_s, sent_s - stepped_s)
        time.sleep(INTERVAL_S)
    return 1e3 * longest_s


def codec_rates() -> tuple[float, float]:
    """Return packets a second, encoded and decoded: Recon's codec, pymavlink's."""
    core = wire.CoreTelemetry(
        is_flying=1,
        latitude_deg=44.97,
        longitude_deg=-93.23,
        altitude_m=287.0,
        height_above_takeoff_m=61.0,
        velocity_north_mps=3.5,
        velocity_east_mps=-1.25,
        velocity_down_mps=0.1,
        yaw_deg=92.5,
        pitch_deg=-4.0,
        roll_deg=1.5,
    )
    packer, parser, deframer = mavlink.MAVLink(None, 1, 1), mavlink.MAVLink(None), wire.Deframer()

    def ours() -> None:
        for _ in range(LOOP):
            assert len(deframer.feed(wire.encode(core))) == 1

    def theirs() -> None:
        for _ in range(LOOP):
            message = mavlink.MAVLink_global_position_int_message(
                1, 449_700_000, -932_300_000, 287_000, 61_000, 350, -125, 10, 9250
            )
            assert len(parser.parse_buffer(message.pack(packer))) == 1

    shortest = [float("inf")] * 2
    for _ in range(ROUNDS):
        for number, work in enumerate((ours, theirs)):
            begun_s = time.perf_counter()
            work()
            shortest[number] = min(shortest[number], time.perf_counter() - begun_s)
    return LOOP / shortest[0], LOOP / shortest[1]


async def measure(url: str, port: int, pid: int, asked: argparse.Namespace) -> bool:
    client = Client(*await asyncio.open_connection("127.0.0.1", port))
    share, places = await share_of_core(client, pid, asked.seconds)
    print(f"{asked.vehicles} vehicles: {places:.0f} positions/s, {100 * share:.1f} % of one core")
    await client.close()
    async with Station(url) as station:
        serial = next(v.serial for v in station.vehicles() if v.number == 1)
        assert serial is not None
        times = await order_ms(port, station, serial, asked.orders)
    p50, p99 = (np.percentile(times, percent, axis=0) for percent in (50, 99))
    added_ms = p99[0] - p99[1]
    print(f"a hold by MAVLink: p50 {p50[0]:.2f} ms, p99 {p99[0]:.2f} ms")
    print(f"a hold by client:  p50 {p50[1]:.2f} ms, p99 {p99[1]:.2f} ms")
    print(f"the gateway adds:  p50 {p50[0] - p50[1]:.2f} ms, p99 {added_ms:.2f} ms")
    return share < SHARE_LIMIT and added_ms < ADDED_LIMIT_MS


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--vehicles", type=int, default=64)
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--orders", type=int, default=200)
    asked = parser.parse_args()
    ours, theirs = codec_rates()
    print(
        f"packets/s, encode and decode: {ours:.0f}, pymavlink {theirs:.0f}: {ours / theirs:.1f} x"
    )
    work_ms = longest_work_ms(asked.vehicles)
    print(f"the longest work that an order waits for: {work_ms:.2f} ms of processor")
    program = (sys.executable, "-m", "benches.gateway.quick_station", str(asked.vehicles))
    with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as station:
        try:
            assert station.stdout is not None
            url = station.stdout.readline().partition(": ")[2].strip()
            words = ("--allow-orders", "--tcp", "127.0.0.1:0", "--station", url)
            with started("gateway", "mavlink", *GROUND, *words) as gateway:
                port = int(gateway.line_with("MAVLink clients: 127.0.0.1:").rpartition(":")[2])
                is_good = asyncio.run(measure(url, port, gateway.pid, asked))
        finally:
            station.kill()
    is_good = is_good and ours / theirs > CODEC_LIMIT
    print("good" if is_good else "FAILED: see the limits at the top of this file")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
