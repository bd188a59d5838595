"""MAVProxy and pymavlink's own connection against the gateway, as people use them."""

import asyncio
import os
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from pymavlink import mavutil
from tests.client.running_station import HOME
from tests.gateway.running_gateway import PATIENCE_S, RunningGateway, running_gateway

from recon.gateway.mavlink.values import GatewaySettings

pytestmark = [pytest.mark.flight, pytest.mark.filterwarnings("ignore")]
ORDERS = GatewaySettings(allow_orders=True)
HOLD, RETURN = 50593792, 84148224
KEY = b"k" * 32


class Proxy:
    """A MAVProxy without windows: words in, lines out."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process

    def say(self, words: str) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(f"{words}\n".encode())

    async def until(self, *wanted: str) -> str:
        """Return the next line that has one of these words."""
        assert self._process.stdout is not None
        seen = ""
        try:
            async with asyncio.timeout(PATIENCE_S):
                while True:
                    line = (await self._process.stdout.readline()).decode()
                    seen += line
                    if any(word in line for word in wanted):
                        return line
        except TimeoutError:
            raise AssertionError(f"expected {wanted}, got {seen}") from None


@asynccontextmanager
async def proxy(running: RunningGateway, folder: Path, *more: str) -> AsyncIterator[Proxy]:
    script = Path(sys.executable).with_name("mavproxy.py")
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-W", "ignore", str(script), f"--master=tcp:127.0.0.1:{running.port}"),
        *(f"--aircraft={folder / 'a'}", f"--state-basedir={folder}", *more),
        "--default-modules=cmdlong,mode,wp,param,arm,signing,fence",
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        cwd=folder,
        env={**os.environ, "HOME": str(folder), "MAVLINK20": "1"},
    )
    try:
        yield Proxy(process)
    finally:
        process.kill()
        await process.wait()


def waypoints(folder: Path, north_m: float) -> Path:
    """A mission file without a row of home, which MAVProxy would send as a waypoint."""
    rows = ["QGC WPL 110"]
    for seq in range(3):
        latitude_deg = HOME.latitude_deg + (north_m + 20.0 * seq) / 111_000.0
        place = f"{latitude_deg:.7f}\t{HOME.longitude_deg:.7f}\t{42.0 + seq}"
        rows.append(f"{seq}\t{int(seq == 0)}\t3\t16\t0\t0\t0\t0\t{place}\t1")
    file = folder / "mission.waypoints"
    file.write_text("\n".join(rows) + "\n")
    return file


def test_mavproxy_shows_uploads_starts_holds_and_returns(tmp_path: Path) -> None:
    async def main() -> None:
        async with (
            running_gateway(ORDERS, vehicles=1) as running,
            proxy(running, tmp_path) as shell,
        ):
            await shell.until("online system 1")
            await shell.until("Received 1 parameters", "Saved 1 parameters")
            shell.say(f"wp load {waypoints(tmp_path, 20.0)}")
            await shell.until("TYPE_MISSION: ACCEPTED")
            shell.say("wp list")
            await shell.until("Requesting 3 waypoints")
            shell.say("long 176 1 4 4")
            await shell.until("DO_SET_MODE: ACCEPTED")
            await shell.until("MISSION>", "Mode MISSION")
            shell.say(f"wp load {waypoints(tmp_path, 9000.0)}")
            # The gate's sentence, then the answer.
            await shell.until("SIM-1")
            await shell.until("TYPE_MISSION: DENIED")
            shell.say("long 176 1 4 3")
            await shell.until("DO_SET_MODE: ACCEPTED")
            await shell.until("LOITER>", "Mode LOITER")
            shell.say("long 20")
            await shell.until("RETURN_TO_LAUNCH: ACCEPTED")
            shell.say("long 21")
            await shell.until("LAND: ACCEPTED")

    asyncio.run(main())


def test_mavproxy_loses_a_lost_vehicle(tmp_path: Path) -> None:
    async def main() -> None:
        faults = ("telemetry-dropout:SIM-1:12:600",)
        async with (
            running_gateway(ORDERS, vehicles=1, faults=faults) as running,
            proxy(running, tmp_path) as shell,
        ):
            await shell.until("online system 1")
            await shell.until("no link", "link 1 down", "Link 1 down", "heartbeat lost")

    asyncio.run(main())


@pytest.mark.parametrize("key", [KEY, b"x" * 32], ids=["right key", "wrong key"])
def test_pymavlink_orders_with_the_right_key_only(key: bytes) -> None:
    def client(port: int) -> tuple[Any, Any]:
        # Without MAVLINK20 it speaks MAVLink 1, and forgets its key, until it hears version 2.
        link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{port}")
        beat = link.wait_heartbeat(timeout=PATIENCE_S)
        link.setup_signing(key)
        link.set_mode_rtl()
        ack = link.recv_match(type="COMMAND_ACK", blocking=True, timeout=3.0)
        returns = f"HEARTBEAT.custom_mode == {RETURN}"
        if ack is not None:
            assert link.recv_match(
                type="HEARTBEAT", condition=returns, blocking=True, timeout=PATIENCE_S
            )
        link.close()
        return beat, ack

    async def main() -> None:
        async with running_gateway(ORDERS, vehicles=1, key=KEY) as running:
            beat, ack = await asyncio.to_thread(client, running.port)
            assert (beat.get_srcSystem(), beat.get_srcComponent()) == (1, 1)
            if key == KEY:
                assert (ack.command, ack.result) == (20, 0)
            else:
                assert ack is None
                assert not await running.station.commands()

    asyncio.run(main())
