"""Return in layers from Python, with a real station and simulated vehicles on sockets."""

import asyncio
from collections.abc import Callable

from tests.client.running_station import SERIALS, running_station
from tests.patient_loop import run_patiently

from recon.client import Order, Refusal, Station, VehicleReturn


async def until(
    station: Station, condition: Callable[[tuple[VehicleReturn, ...]], bool]
) -> tuple[VehicleReturn, ...]:
    """Poll with every new state until the condition holds."""
    vehicle = await station.vehicle("SIM-1")
    async with asyncio.timeout(120.0):
        async for _state in vehicle.telemetry():
            vehicles = await station.fleet.returning()
            if condition(vehicles):
                return vehicles
    raise AssertionError("the telemetry ended")


def test_vehicles_return_in_separate_layers_and_a_hold_releases_them() -> None:
    async def main() -> None:
        async with running_station() as url, Station(url) as station:
            for serial in SERIALS:
                await station.vehicle(serial)
            assert await station.fleet.returning() == ()
            answers = await station.fleet.return_in_layers()
            assert sorted(answer.serial or "" for answer in answers) == list(SERIALS)
            assert all(isinstance(answer.answer, Order) for answer in answers)
            flying = await until(station, lambda vehicles: {v.wave for v in vehicles} == {1})
            assert len({vehicle.layer_height_m for vehicle in flying}) == 2
            assert not any(vehicle.is_done for vehicle in flying)
            await station.fleet.hold()
            released = await until(station, lambda vehicles: all(v.is_done for v in vehicles))
            assert {vehicle.stage for vehicle in released} == {"released"}
            assert all("hover, ordered by local-operator" in (v.reason or "") for v in released)

    run_patiently(main())


def test_a_vehicle_on_the_ground_is_refused() -> None:
    async def main() -> None:
        async with running_station(airborne=False) as url, Station(url) as station:
            await station.vehicle("SIM-1")
            (answer,) = await station.fleet.return_in_layers(["SIM-1"])
            assert isinstance(answer.answer, Refusal)
            assert answer.answer.rule == "flying"
            assert await station.fleet.returning() == ()

    run_patiently(main())
