"""Hazard areas dismissed and separation holds switched from Python, on a real station."""

import asyncio

import pytest
from tests.client.running_station import running_station

from recon.client import RequestRefusedError, Station


def test_a_vehicle_that_is_heard_is_no_hazard() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            with pytest.raises(RequestRefusedError, match="No hazard area"):
                await vehicle.dismiss_hazard()

    asyncio.run(main())


def test_the_separation_holds_are_switched_and_an_alarm_says_so() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            await station.switch_separation_hold(False)
            rules: set[str] = set()
            async for _state in (await station.vehicle("SIM-1")).telemetry():
                rules = {alarm.rule for alarm in await station.alarms()}
                if "separation_hold_off" in rules:
                    break
            assert "separation_hold_off" in rules
            await station.switch_separation_hold(True)

    asyncio.run(main())
