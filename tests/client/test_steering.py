"""Goto, nudge and hold position from a program, and what happens when the program ends."""

from math import hypot

import pytest
from tests.client.running_station import running_station
from tests.patient_loop import run_patiently

from recon.client import (
    ConnectionLostError,
    Order,
    Phase,
    Position,
    Refusal,
    Station,
    Vehicle,
)
from recon.geo.distance import moved_m, offset_north_east_m
from recon.model.geo import LatLon


def place(position: Position) -> LatLon:
    assert position.latitude_deg is not None
    assert position.longitude_deg is not None
    return LatLon(position.latitude_deg, position.longitude_deg)


def accepted(answer: Order | Refusal) -> Order:
    assert isinstance(answer, Order), answer
    return answer


async def until_mode(vehicle: Vehicle, mode: str) -> None:
    async for state in vehicle.telemetry():
        if state.flight_mode.value == mode:
            return


def test_a_goto_flies_to_the_target_and_a_nudge_continues_from_there() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            start = place(vehicle.now().position)
            there = moved_m(start, 12.0, 5.0)
            order = await vehicle.goto(
                there.latitude_deg, there.longitude_deg, height_above_takeoff_m=42.0, speed_mps=4.0
            )
            status = await accepted(order).wait(Phase.DONE)
            assert (status.kind, status.phase) == ("goto", Phase.DONE)
            assert Phase.STARTED in [change.phase for change in status.history]
            assert hypot(*offset_north_east_m(place(vehicle.now().position), there)) < 1.5
            nudge = accepted(await vehicle.nudge(east_m=-3.0, up_m=-2.0, turn_deg=30.0))
            assert (await nudge.wait(Phase.DONE)).kind == "nudge"
            beside = moved_m(there, 0.0, -3.0)
            assert hypot(*offset_north_east_m(place(vehicle.now().position), beside)) < 2.0
            held = accepted(await vehicle.hold_position())
            assert (await held.wait(Phase.DONE)).kind == "hold_position"

    run_patiently(main())


def test_a_vehicle_holds_when_its_program_ends() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as observer:
            vehicle = await observer.vehicle("SIM-1")
            start = place(vehicle.now().position)
            far = moved_m(start, 300.0, 0.0)
            async with Station(url) as leaving:
                flown = await leaving.vehicle("SIM-1")
                order = await flown.goto(
                    far.latitude_deg, far.longitude_deg, height_above_takeoff_m=40.0
                )
                await accepted(order).wait(Phase.STARTED)
                await until_mode(vehicle, "joystick")
            await until_mode(vehicle, "gps_atti")
            newest = observer._stream.newest
            assert newest is not None
            phases = {command.kind: command.phase for command in newest.message.commands}
            assert phases["goto"] is Phase.FAILED
            assert "hover" in phases
            assert hypot(*offset_north_east_m(start, place(vehicle.now().position))) < 60.0

    run_patiently(main())


def test_a_vehicle_holds_when_its_program_hangs(monkeypatch: pytest.MonkeyPatch) -> None:
    """The connection is open but sends no keepalives: treated as closed after 2 s."""

    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as observer:
            vehicle = await observer.vehicle("SIM-1")
            far = moved_m(place(vehicle.now().position), 300.0, 0.0)
            monkeypatch.setattr("recon.client.stream.KEEPALIVE_S", 3600.0)
            async with Station(url) as hanging:
                flown = await hanging.vehicle("SIM-1")
                order = accepted(
                    await flown.goto(
                        far.latitude_deg, far.longitude_deg, height_above_takeoff_m=40.0
                    )
                )
                assert (await order.wait(Phase.DONE)).phase is Phase.FAILED
            await until_mode(vehicle, "gps_atti")

    run_patiently(main())


def test_refused_steering_is_a_value() -> None:
    async def main() -> None:
        async with running_station(airborne=False, vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            here = place(vehicle.now().position)
            for answer in (
                await vehicle.goto(
                    here.latitude_deg, here.longitude_deg, height_above_takeoff_m=20
                ),
                await vehicle.nudge(north_m=1.0),
                await vehicle.hold_position(),
            ):
                assert isinstance(answer, Refusal)
                assert answer.rule == "flying"
            nowhere = await vehicle.goto(91.0, 0.0, height_above_takeoff_m=20.0)
            assert isinstance(nowhere, Refusal)
            assert nowhere.rule == "dji_limits"
            broken = await vehicle.nudge(north_m=float("nan"))
            assert isinstance(broken, Refusal)
            assert broken.rule == "finite_numbers"

    run_patiently(main())


def test_without_an_open_stream_nothing_is_sent() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            station._stream.owner = None
            with pytest.raises(ConnectionLostError, match="nothing was sent"):
                await vehicle.nudge(north_m=1.0)

    run_patiently(main())
