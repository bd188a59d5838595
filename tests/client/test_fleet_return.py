"""A fleet called home from Python, with a real station and simulated vehicles on sockets."""

import asyncio
from collections.abc import Callable

from tests.client.running_station import SERIALS, running_station

from recon.client import Order, Refusal, Returning, Station


async def until(
    station: Station, is_so: Callable[[tuple[Returning, ...]], bool]
) -> tuple[Returning, ...]:
    """Ask with every new state until it is so."""
    vehicle = await station.vehicle("SIM-1")
    async with asyncio.timeout(120.0):
        async for _state in vehicle.telemetry():
            called = await station.fleet.returning()
            if is_so(called):
                return called
    raise AssertionError("the telemetry ended")


def test_all_are_called_each_flies_in_a_layer_of_its_own_and_a_hold_ends_it() -> None:
    async def main() -> None:
        async with running_station() as url, Station(url) as station:
            for serial in SERIALS:
                await station.vehicle(serial)
            assert await station.fleet.returning() == ()
            answers = await station.fleet.return_in_layers()
            assert sorted(answer.serial or "" for answer in answers) == list(SERIALS)
            assert all(isinstance(answer.answer, Order) for answer in answers)
            flying = await until(station, lambda called: {v.wave for v in called} == {1})
            assert len({vehicle.layer_height_m for vehicle in flying}) == 2
            assert not any(vehicle.is_done for vehicle in flying)
            await station.fleet.hold()
            released = await until(station, lambda called: all(v.is_done for v in called))
            assert {vehicle.stage for vehicle in released} == {"released"}
            assert all("hover, ordered by api" in (v.reason or "") for v in released)

    asyncio.run(main())


def test_one_on_the_ground_is_refused() -> None:
    async def main() -> None:
        async with running_station(airborne=False) as url, Station(url) as station:
            await station.vehicle("SIM-1")
            (answer,) = await station.fleet.return_in_layers(["SIM-1"])
            assert isinstance(answer.answer, Refusal)
            assert answer.answer.rule == "flying"
            assert await station.fleet.returning() == ()

    asyncio.run(main())
