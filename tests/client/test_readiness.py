"""Authority and preflight from a program, against a real station."""

import asyncio
from dataclasses import replace

from tests.client.running_station import running_station
from tests.client.test_flights import accepted, leg_north, refused

from recon.client import Refusal, Station
from recon.site import Site


def unfenced(site: Site) -> Site:
    return replace(site, layers=replace(site.layers, boundary=None))


def test_a_vehicle_is_taken_and_given_by_word() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            assert await vehicle.give_to_guidance() is None
            assert refused(await vehicle.fly(leg_north(vehicle))).rule == "authority"
            assert await vehicle.take() is None
            accepted(await vehicle.fly(leg_north(vehicle)))
            assert await vehicle.give_to_pilot() is None
            async for state in vehicle.telemetry():
                if state.authority.holder == "pilot":
                    break
            answer = await vehicle.give_to_guidance()
            assert isinstance(answer, Refusal)
            assert answer.rule == "authority"
            accepted(await vehicle.hold())

    asyncio.run(main())


def test_the_checklist_is_read_and_a_ready_vehicle_passes_it() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            told = await vehicle.preflight()
            assert (told.serial, told.is_passed, told.unmet) == ("SIM-1", True, ())
            assert {point.key for point in told.points} >= {"battery", "gnss", "fence", "clock"}

    asyncio.run(main())


def test_a_list_that_is_not_passed_is_overridden_with_a_reason() -> None:
    async def main() -> None:
        async with (
            running_station(vehicles=1, airborne=False, prepared=unfenced) as url,
            Station(url) as station,
        ):
            vehicle = await station.vehicle("SIM-1")
            assert [point.key for point in (await vehicle.preflight()).unmet] == ["fence"]
            mission = leg_north(vehicle)
            assert refused(await vehicle.fly(mission, takeoff=True)).rule == "preflight"
            assert (await vehicle.override_preflight(" ")) is not None
            assert (await vehicle.override_preflight("the fence comes tomorrow")) is None
            override = (await vehicle.preflight()).override
            assert override is not None
            assert override.reason == "the fence comes tomorrow"
            would = await vehicle.would_fly(mission, takeoff=True)
            assert would is None or would.rule != "preflight"

    asyncio.run(main())
