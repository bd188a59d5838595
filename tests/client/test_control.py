"""Authority, preflight, hazard areas and separation hold from Python, with a real station."""

from dataclasses import replace

import pytest
from tests.client.running_station import running_station
from tests.client.test_flights import accepted, flown, leg_north, refused
from tests.patient_loop import run_patiently

from recon.client import Refusal, RequestRefusedError, Station
from recon.site import Site


def unfenced(site: Site) -> Site:
    return replace(site, layers=replace(site.layers, boundary=None))


def test_authority_is_taken_and_handed_over() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            assert await vehicle.give_to_guidance() is None
            assert refused(await vehicle.fly(leg_north(vehicle))).rule == "authority"
            assert await vehicle.take() is None
            await flown(vehicle, leg_north(vehicle))
            assert await vehicle.give_to_pilot() is None
            async for state in vehicle.telemetry():
                if state.authority.holder == "pilot":
                    break
            answer = await vehicle.give_to_guidance()
            assert isinstance(answer, Refusal)
            assert answer.rule == "authority"
            accepted(await vehicle.hold())

    run_patiently(main())


def test_a_ready_vehicle_passes_the_checklist() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            checklist = await vehicle.preflight()
            assert (checklist.serial, checklist.is_passed, checklist.unmet) == ("SIM-1", True, ())
            assert {point.key for point in checklist.points} >= {
                "battery",
                "gnss",
                "fence",
                "clock",
            }

    run_patiently(main())


def test_a_failed_checklist_is_overridden_with_a_reason() -> None:
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
            assert (await vehicle.override_preflight("no fence at this field")) is None
            override = (await vehicle.preflight()).override
            assert override is not None
            assert override.reason == "no fence at this field"
            refusal = await vehicle.would_fly(mission, takeoff=True)
            assert refusal is None or refusal.rule != "preflight"

    run_patiently(main())


def test_a_connected_vehicle_has_no_hazard_area() -> None:
    async def main() -> None:
        async with running_station(vehicles=1) as url, Station(url) as station:
            vehicle = await station.vehicle("SIM-1")
            with pytest.raises(RequestRefusedError, match="No hazard area"):
                await vehicle.dismiss_hazard()

    run_patiently(main())


def test_switching_the_separation_hold_off_raises_an_alarm() -> None:
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

    run_patiently(main())
