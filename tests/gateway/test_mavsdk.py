"""MAVSDK's asyncio binding against the gateway: a program as its users write them."""

import asyncio
import math
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any, TypeVar

import pytest
from mavsdk import System
from mavsdk.action import ActionError
from mavsdk.mission import MissionError, MissionItem, MissionPlan
from mavsdk.telemetry import FlightMode
from tests.client.running_station import HOME
from tests.gateway.running_gateway import PATIENCE_S, RunningGateway, running_gateway

from recon.gateway.mavlink.values import GatewaySettings

# Importing mavsdk makes uvloop the event loop of the whole process, other tests' too.
asyncio.set_event_loop_policy(None)

T = TypeVar("T")
NONE = math.nan
# MAVSDK, gRPC and protobuf warn of themselves.
pytestmark = [pytest.mark.flight, pytest.mark.filterwarnings("ignore")]


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        port: int = sock.getsockname()[1]
        return port


async def first(values: AsyncIterator[T], where: Callable[[T], bool] = lambda value: True) -> T:
    async with asyncio.timeout(PATIENCE_S):
        async for value in values:
            if where(value):
                return value
    raise AssertionError("MAVSDK has ended the stream")


@asynccontextmanager
async def drone(**more: Any) -> AsyncIterator[tuple[RunningGateway, System]]:
    """MAVSDK connected to the one vehicle of a gateway that allows orders."""
    port = free_port()
    settings = GatewaySettings(allow_orders=True)
    places = (("127.0.0.1", port),)
    async with running_gateway(settings, udp_to=places, vehicles=1, **more) as running:
        system = System(port=free_port())
        await system.connect(system_address=f"udpin://127.0.0.1:{port}")
        try:
            await first(system.core.connection_state(), lambda state: state.is_connected)
            yield running, system
        finally:
            system._stop_mavsdk_server()


def waypoint(north_m: float, height_m: float) -> MissionItem:
    return MissionItem(
        *(HOME.latitude_deg + north_m / 111_000.0, HOME.longitude_deg, height_m, 5.0, True),
        *(NONE, NONE, MissionItem.CameraAction.NONE, NONE, NONE, NONE, NONE, NONE),
        MissionItem.VehicleAction.NONE,
    )


async def refused(work: Awaitable[Any], error: type[Exception]) -> str:
    with pytest.raises(error) as caught:
        await work
    return str(caught.value)


async def mode(system: System, wanted: FlightMode) -> None:
    await first(system.telemetry.flight_mode(), lambda shown: shown is wanted)


def test_a_program_with_mavsdk_flies_a_vehicle() -> None:
    async def main() -> None:
        async with drone() as (running, system):
            (telemetry,) = running.station.vehicles()
            place = await first(system.telemetry.position())
            assert telemetry.position.latitude_deg is not None
            assert abs(place.latitude_deg - telemetry.position.latitude_deg) < 1e-5
            health = await first(system.telemetry.health(), lambda h: h.is_global_position_ok)
            # Health without armable: the checklist decides that.
            assert (health.is_gyrometer_calibration_ok, health.is_armable) == (True, False)
            assert await first(system.telemetry.battery(), lambda b: b.remaining_percent > 0.0)
            plan = MissionPlan([waypoint(20.0, 42.0), waypoint(40.0, 43.0)])
            await system.mission.upload_mission(plan)
            back = await system.mission.download_mission()
            assert [item.relative_altitude_m for item in back.mission_items] == [42.0, 43.0]
            await system.mission.start_mission()
            await mode(system, FlightMode.MISSION)
            far = MissionPlan([waypoint(9_000.0, 42.0), waypoint(9_100.0, 42.0)])
            assert "DENIED" in await refused(system.mission.upload_mission(far), MissionError)
            await system.action.hold()
            await mode(system, FlightMode.HOLD)
            place = await first(system.telemetry.position())
            north = place.latitude_deg + 2e-4, place.longitude_deg
            await system.action.goto_location(*north, place.absolute_altitude_m + 2.0, NONE)
            await first(system.telemetry.velocity_ned(), lambda v: v.north_m_s > 1.0)
            high = system.action.goto_location(*north, place.absolute_altitude_m + 5000.0, NONE)
            assert "DENIED" in await refused(high, ActionError)
            await system.action.return_to_launch()
            await mode(system, FlightMode.RETURN_TO_LAUNCH)
            await system.action.land()
            await mode(system, FlightMode.LAND)
            assert "DENIED" in await refused(system.action.kill(), ActionError)

    asyncio.run(main())


def test_mavsdk_arms_starts_from_the_ground_and_loses_a_lost_vehicle() -> None:
    async def main() -> None:
        async with drone(airborne=False, faults=("telemetry-dropout:SIM-1:30:600",)) as (_, system):
            await first(system.telemetry.health(), lambda h: h.is_home_position_ok)
            await first(system.telemetry.in_air(), lambda in_air: not in_air)
            plan = MissionPlan([waypoint(0.0, 30.0), waypoint(20.0, 30.0)])
            await system.mission.upload_mission(plan)
            # The start alone does not allow a takeoff.
            assert "DENIED" in await refused(system.mission.start_mission(), MissionError)
            await system.action.arm()
            await system.mission.start_mission()
            await first(system.telemetry.in_air(), bool)
            await first(system.core.connection_state(), lambda state: not state.is_connected)

    asyncio.run(main())
