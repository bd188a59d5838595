"""The client with a real station: orders are flown, refusals are values, states are new."""

import asyncio
from dataclasses import replace

import pytest
from tests.client.running_station import SERIALS, running_station
from tests.patient_loop import run_patiently

from recon.client import (
    ConnectionLostError,
    Mission,
    Order,
    Phase,
    Refusal,
    RequestRefusedError,
    Station,
    Vehicle,
    WaitTimeoutError,
    Waypoint,
)

TOKEN = "a-secret-of-the-field"


MOST_ORDERED = 50
"""Tries, 0.1 s apart: telemetry that does not come at all is a fault."""


def leg_north(vehicle: Vehicle, first_deg: float = 0.0002) -> Mission:
    """A leg from 22 m north of the vehicle, or from directly above it for a takeoff."""
    here = vehicle.now().position
    assert here.latitude_deg is not None
    assert here.longitude_deg is not None
    return Mission(
        tuple(
            Waypoint(here.latitude_deg + north_deg, here.longitude_deg, 50.0, 5.0)
            for north_deg in (first_deg, 0.0004)
        )
    )


def accepted(answer: Order | Refusal) -> Order:
    assert isinstance(answer, Order), answer
    return answer


async def flown(vehicle: Vehicle, mission: Mission) -> Order:
    """Order a mission, again while telemetry is late: on a busy machine it is, and is refused."""
    for _ in range(MOST_ORDERED):
        answer = await vehicle.fly(mission)
        if isinstance(answer, Order) or answer.rule != "link_age":
            break
        await asyncio.sleep(0.1)
    return accepted(answer)


def refused(answer: Order | Refusal) -> Refusal:
    assert isinstance(answer, Refusal), answer
    return answer


def test_orders_are_flown_and_confirmed_by_telemetry() -> None:
    async def main() -> None:
        async with running_station() as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            order = await flown(vehicle, leg_north(vehicle))
            status = await order.wait()
            assert status.phase is Phase.STARTED
            assert [change.phase for change in status.history[:3]] == [
                Phase.QUEUED,
                Phase.SENT,
                Phase.ACKNOWLEDGED,
            ]
            assert (status.kind, status.serial, status.times_sent) == ("mission", "SIM-1", 1)
            held = await accepted(await vehicle.hold()).wait()
            assert (held.kind, held.phase) == ("hover", Phase.DONE)
            stick = await vehicle.stick(
                yaw_deg=0.0, velocity_x_mps=2.0, velocity_y_mps=0.0, height_above_takeoff_m=50.0
            )
            assert (await accepted(stick).wait(Phase.SENT)).kind == "stick"
            home = await accepted(await vehicle.return_home()).wait()
            assert (home.kind, home.phase) == ("return_home", Phase.CONFIRMED)
            landed = await accepted(await vehicle.land()).wait()
            assert (landed.kind, landed.phase) == ("land", Phase.CONFIRMED)

    run_patiently(main())


def test_camera_orders_reach_the_app() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            started = await accepted(await vehicle.start_camera(1.0)).wait(Phase.SENT)
            assert started.kind == "camera_start"
            ended = await accepted(await vehicle.stop_camera()).wait(Phase.SENT)
            assert ended.kind == "camera_stop"

    run_patiently(main())


def test_refusals_are_values() -> None:
    async def main() -> None:
        async with running_station(airborne=False) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            leg = leg_north(vehicle, first_deg=0.0)
            assert refused(await vehicle.fly(leg)).rule == "flying"
            nowhere = replace(leg.waypoints[0], speed_mps=float("nan"))
            refusal = refused(await vehicle.fly(Mission((nowhere,)), takeoff=True))
            assert refusal.rule == "finite_numbers"
            assert "waypoints 1 speed_mps" in refusal.reason
            refusal = refused(await vehicle.fly(Mission(leg.waypoints * 1001), takeoff=True))
            assert refusal.rule == "order_form"
            assert "2000" in refusal.reason
            assert vehicle.now().is_flying.value is False
            assert accepted(await vehicle.fly(leg, takeoff=True)).serial == "SIM-1"

    run_patiently(main())


def test_fleet_orders_have_one_answer_per_vehicle() -> None:
    async def main() -> None:
        async with running_station() as url, Station(url) as station:
            for serial in SERIALS:
                await station.vehicle(serial)
            for send in (station.all_stop, station.fleet.hold, station.fleet.return_home):
                answers = await send()
                assert {answer.serial for answer in answers} == set(SERIALS)
                assert len(answers) == len(SERIALS)
                assert all(isinstance(answer.answer, Order) for answer in answers)
            answers = await station.fleet.land()
            statuses = [await accepted(answer.answer).wait() for answer in answers]
            assert [status.phase for status in statuses] == [Phase.CONFIRMED] * 2

    run_patiently(main())


def test_an_empty_fleet_gets_no_orders() -> None:
    async def main() -> None:
        async with running_station(vehicles=0) as url, Station(url) as station:
            assert await station.fleet.hold() == ()
            assert await station.all_stop() == ()

    run_patiently(main())


def test_telemetry_is_new_and_skips_missed_states() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            heights_m = []
            async for state in vehicle.telemetry():
                assert state.is_live
                assert state.telemetry_age_s is not None
                assert 0.0 <= state.telemetry_age_s < 1.0
                heights_m.append(state.height_above_takeoff_m.value)
                if len(heights_m) == 5:
                    break
            assert all(height_m is not None and height_m > 10.0 for height_m in heights_m)

    run_patiently(main())


def test_a_vehicle_with_a_silent_app_becomes_late() -> None:
    async def main() -> None:
        fault = ("telemetry-dropout:SIM-1:3:30",)
        async with running_station(vehicles=1, faults=fault) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            async for state in vehicle.telemetry():
                if not state.is_live:
                    assert state.telemetry_age_s is not None
                    assert state.telemetry_age_s >= 1.0
                    return

    run_patiently(main())


def test_a_vehicle_that_does_not_connect_is_named() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            await station.vehicle("SIM-1")
            with pytest.raises(WaitTimeoutError, match=r"expected SIM-9 .* knows SIM-1"):
                await station.vehicle("SIM-9", timeout_s=0.3)
            with pytest.raises(ConnectionLostError, match="SIM-9"):
                Vehicle("SIM-9", station._order_api).now()

    run_patiently(main())


def test_waiting_for_an_acknowledged_order_times_out() -> None:
    async def main() -> None:
        fault = ("ack-then-nothing:SIM-1",)
        async with running_station(vehicles=1, faults=fault) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            order = await flown(vehicle, leg_north(vehicle))
            with pytest.raises(WaitTimeoutError, match="expected confirmed within"):
                await order.wait(timeout_s=0.5)

    run_patiently(main())


def test_a_rejected_order_is_returned_with_its_phase() -> None:
    async def main() -> None:
        fault = ("negative-ack:SIM-1",)
        async with running_station(vehicles=1, faults=fault) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            status = await (await flown(vehicle, leg_north(vehicle))).wait()
            assert status.phase is Phase.REFUSED_BY_APP
            assert not status.has_reached(Phase.CONFIRMED)

    run_patiently(main())


def test_a_token_opens_a_station_and_is_never_printed() -> None:
    async def main() -> None:
        async with running_station(vehicles=1, token=TOKEN) as url:
            for station in (Station(url, TOKEN), Station(f"{url}/#token={TOKEN}")):
                assert TOKEN not in repr(station.address)
                async with station:
                    assert isinstance(await (await station.vehicle("SIM-1")).hold(), Order)
            for wrong in (Station(url), Station(url, "another-secret")):
                with pytest.raises(RequestRefusedError, match=r"token (missing|wrong)") as problem:
                    await wrong.__aenter__()
                assert TOKEN not in str(problem.value)

    run_patiently(main())
