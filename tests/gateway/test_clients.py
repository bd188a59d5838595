"""Clients on real sockets, a real station and simulated apps: all that a ground station does."""

import asyncio
import math
from typing import Any

import httpx
import pytest
from pymavlink.dialects.v20 import common as mavlink
from tests.client.running_station import HOME
from tests.gateway.running_gateway import Client, connected, running_gateway
from tests.patient_loop import run_patiently
from tests.persons import TOKEN

from recon.client import Staleness
from recon.gateway.mavlink.values import GatewaySettings

ORDERS = GatewaySettings(allow_orders=True)
SET_MODE, START, REPOSITION = 176, 300, 192
ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
HOLD, MISSION, RETURN, LAND = (3 << 24, 4 << 24, 5 << 24, 6 << 24)
NORTH_20M = 1800
"""In units of 1e-7 degrees."""


def path(*heights_m: float, north: int = 0) -> list[Any]:
    """Waypoints of a mission to the north of home."""
    latitude, longitude = round(HOME.latitude_deg * 1e7), round(HOME.longitude_deg * 1e7)
    return [
        mavlink.MAVLink_mission_item_int_message(
            *(1, 1, seq, 6, 16, int(seq == 0), 1, 0.0, 0.0, 0.0, math.nan),
            *(latitude + north + NORTH_20M * (seq + 1), longitude, height_m, 0),
        )
        for seq, height_m in enumerate(heights_m)
    ]


async def uploaded(client: Client, items: list[Any]) -> tuple[int, str]:
    client.send(mavlink.MAVLink_mission_count_message(1, 1, len(items), 0))
    for item in items:
        question = await client.until("MISSION_REQUEST_INT")
        assert question.seq == item.seq
        client.send(item)
    return await client.answer("MISSION_ACK")


async def downloaded(client: Client, kind: int = 0) -> list[Any]:
    client.send(mavlink.MAVLink_mission_request_list_message(1, 1, kind))
    count = (await client.until("MISSION_COUNT")).count
    items = []
    for seq in range(count):
        client.send(mavlink.MAVLink_mission_request_int_message(1, 1, seq, kind))
        items.append(await client.until("MISSION_ITEM_INT"))
    client.send(mavlink.MAVLink_mission_ack_message(1, 1, 0, kind))
    return items


async def mode(client: Client, sub_mode: int) -> Any:
    """Wait for a beat in a sub-mode of PX4's AUTO."""
    return await client.until(
        "HEARTBEAT", where=lambda beat: beat.custom_mode == sub_mode | 4 << 16
    )


def test_a_client_orders_everything_and_hears_every_answer() -> None:
    async def main() -> None:
        async with running_gateway(ORDERS, vehicles=1) as running, connected(running) as client:
            await mode(client, HOLD)
            # A mission up, down as it was, started, flown.
            items = path(42.0, 43.0, 44.0)
            assert await uploaded(client, items) == (mavlink.MAV_MISSION_ACCEPTED, "")
            back = await downloaded(client)
            assert [(i.x, i.y, i.z) for i in back] == [(i.x, i.y, i.z) for i in items]
            assert await client.command(SET_MODE, 1, 4, 4) == (ACCEPTED, "")
            await mode(client, MISSION)
            await client.until("MISSION_CURRENT", where=lambda m: m.mission_state == 3)
            # One that leaves the site is refused, and the kept one stays.
            result, sentence = await uploaded(client, path(42.0, 43.0, north=400_000))
            assert (result, bool(sentence)) == (mavlink.MAV_MISSION_DENIED, True)
            assert len(await downloaded(client)) == 3
            # Hold, goto, a goto that is refused, return, land.
            assert await client.command(SET_MODE, 1, 4, 3) == (ACCEPTED, "")
            await mode(client, HOLD)
            place = await client.until("GLOBAL_POSITION_INT")
            goto = mavlink.MAVLink_command_int_message(
                *(1, 1, 6, REPOSITION, 0, 0, -1.0, 1.0, 0.0, math.nan),
                *(place.lat + NORTH_20M, place.lon, 45.0),
            )
            client.send(goto)
            assert await client.answer("COMMAND_ACK") == (ACCEPTED, "")
            await client.until("GLOBAL_POSITION_INT", where=lambda p: p.vx > 100)
            goto.z = 5000.0
            client.send(goto)
            result, sentence = await client.answer("COMMAND_ACK")
            assert (result, "500 m" in sentence) == (DENIED, True)
            assert await client.command(SET_MODE, 1, 4, 5) == (ACCEPTED, "")
            await mode(client, RETURN)
            assert await client.command(SET_MODE, 1, 4, 6) == (ACCEPTED, "")
            await mode(client, LAND)

    run_patiently(main())


def test_telemetry_is_right_to_the_last_digit() -> None:
    async def main() -> None:
        async with running_gateway(vehicles=1) as running, connected(running) as client:
            shown = [await client.until("GLOBAL_POSITION_INT") for _ in range(5)]
            known = set[tuple[int, ...]]()
            vehicle = running.station.known("SIM-1")
            async with asyncio.timeout(10.0):
                async for telemetry in vehicle.telemetry():
                    place, height_m = telemetry.position, telemetry.height_above_takeoff_m.value
                    assert place.latitude_deg is not None
                    assert place.longitude_deg is not None
                    assert height_m is not None
                    east, north = round(place.longitude_deg * 1e7), round(place.latitude_deg * 1e7)
                    known.add((north, east, round(height_m * 1e3)))
                    shown.append(await client.until("GLOBAL_POSITION_INT"))
                    if len(known) >= 5:
                        break
            both = known & {(m.lat, m.lon, m.relative_alt) for m in shown}
            assert len(both) >= 3

    run_patiently(main())


def test_a_lost_vehicle_stops_beating_and_the_other_one_goes_on() -> None:
    async def main() -> None:
        faults = ("telemetry-dropout:SIM-1:1:60",)
        async with running_gateway(faults=faults) as running, connected(running) as client:
            await client.until("HEARTBEAT")
            lost = Staleness.LOST, Staleness.SILENT
            while not any(v.staleness in lost for v in running.station.vehicles()):
                await client.until("HEARTBEAT", of=2)
            begun = len(client.received)
            for _ in range(3):
                await client.until("HEARTBEAT", of=2)
            assert {m.get_srcSystem() for m in client.received[begun:]} == {2}

    run_patiently(main())


def test_only_signed_messages_are_taken_and_all_are_signed() -> None:
    async def main() -> None:
        key = b"k" * 32
        async with (
            running_gateway(ORDERS, vehicles=1, key=key) as running,
            connected(running) as right,
            connected(running) as wrong,
        ):
            for client, secret in ((right, key), (wrong, b"x" * 32)):
                client.mav.signing.secret_key = secret
                client.mav.signing.sign_outgoing = True
                client.mav.signing.timestamp = _signing_time()
            land = mavlink.MAVLink_command_long_message(1, 1, SET_MODE, 0, 1, 4, 6, 0, 0, 0, 0)
            wrong.send(land)
            wrong.mav.signing.sign_outgoing = False
            wrong.send(land)
            beat = await right.until("HEARTBEAT")
            assert beat.get_signed()
            while running.gateway.peers.dropped < 2:
                await asyncio.sleep(0.01)
            assert not await running.station.commands()
            assert await right.command(SET_MODE, 1, 4, 3) == (ACCEPTED, "")
            # Its own key does not fit what it hears either.
            with pytest.raises(TimeoutError):
                async with asyncio.timeout(0.5):
                    await wrong.until("HEARTBEAT")

    run_patiently(main())


def _signing_time() -> int:
    import time

    return round((time.time() - 1_420_070_400) * 1e5)


def test_a_hostile_client_disturbs_no_other() -> None:
    async def main() -> None:
        async with (
            running_gateway(ORDERS, vehicles=1) as running,
            connected(running) as client,
            connected(running) as noise,
        ):
            await client.until("HEARTBEAT")
            noise.write(bytes((0xFE, 9, 0, 1, 1, 0)) * 2000)
            noise.write(bytes(range(256)) * 50)
            assert await client.command(SET_MODE, 1, 4, 3) == (ACCEPTED, "")
            with pytest.raises(ConnectionError):
                await noise.until("NOTHING")

    run_patiently(main())


def test_orders_are_those_of_the_person_who_has_logged_in() -> None:
    async def main() -> None:
        async with (
            running_gateway(ORDERS, vehicles=1, token=TOKEN) as running,
            connected(running) as client,
        ):
            await client.until("HEARTBEAT")
            assert await client.command(SET_MODE, 1, 4, 3) == (ACCEPTED, "")
            headers = {"Authorization": f"Bearer {TOKEN}"}
            async with httpx.AsyncClient(headers=headers) as http:
                url = f"{running.station.address.http}/api/commands"
                (order,) = (await http.get(url)).json()
            assert order["issued_by"].startswith("cleo ")

    run_patiently(main())


def test_the_first_contact_of_qgroundcontrol_is_answered() -> None:
    """In its order: the version, modes, component metadata, parameters, mission, fence, rally."""

    async def main() -> None:
        async with running_gateway(vehicles=1) as running, connected(running) as client:
            beat = await client.until("HEARTBEAT")
            assert (beat.get_srcComponent(), beat.type) == (1, mavlink.MAV_TYPE_QUADROTOR)
            client.send(mavlink.MAVLink_heartbeat_message(6, 8, 192, 0, 4, 3))
            request = mavlink.MAV_CMD_REQUEST_MESSAGE
            assert await client.command(request, 148) == (ACCEPTED, "")
            version = await client.until("AUTOPILOT_VERSION")
            assert version.capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
            # Available modes and component metadata: it goes on when they are not supported.
            for number in (435, 397, 395):
                answer = await client.command(request, number)
                assert answer == (mavlink.MAV_RESULT_UNSUPPORTED, "")
            client.send(mavlink.MAVLink_param_request_list_message(1, 1))
            value = await client.until("PARAM_VALUE")
            assert (value.param_count, value.param_index) == (1, 0)
            assert await downloaded(client) == []
            client.send(mavlink.MAVLink_mission_request_list_message(1, 1, 1))
            await client.until("MISSION_COUNT", "MISSION_ACK")
            client.send(mavlink.MAVLink_mission_request_list_message(1, 1, 2))
            assert (await client.until("MISSION_COUNT")).count == 0

    run_patiently(main())
