"""Links that fail as in `recon sim` and `recon sim proxy`, between companion and station."""

import asyncio
from pathlib import Path

import pytest
from tests.android.flying import accepted, finish, leg, vehicle
from tests.android.processes import (
    IS_THOROUGH,
    companion_command,
    in_loop,
    proxy,
    running,
    station,
    until,
)

from recon.client import Phase, Refusal, Station, Vehicle

HOVERING = ("--airborne-m", "15")


@in_loop
async def test_a_suspended_app_is_lost_and_returns(site: Path) -> None:
    """`half-open`, `telemetry-dropout`: the phone sleeps with its socket open."""
    async with (
        station(site) as base,
        running(*companion_command(base.link_port, *HOVERING)) as app,
        Station(base.url) as client,
    ):
        drone = await vehicle(client)
        app.suspend()
        await until(lambda: not drone.now().is_live, "telemetry lost")
        app.resume()
        await until(lambda: drone.now().is_live, "telemetry again")
        await finish(await drone.hold())


@in_loop
async def test_a_restarted_app_is_the_same_vehicle(site: Path) -> None:
    """`restart`."""
    async with station(site) as base, Station(base.url) as client:
        async with running(*companion_command(base.link_port)):
            drone = await vehicle(client)
        await until(lambda: not drone.now().is_connected, "the link closed")
        async with running(*companion_command(base.link_port)):
            await until(lambda: drone.now().is_live, "telemetry again")
        assert [state.serial for state in client.vehicles()] == ["SIM-1"]


@in_loop
async def test_a_second_app_with_the_same_serial_is_a_conflict(site: Path) -> None:
    """`second-link`."""
    async with (
        station(site) as base,
        running(*companion_command(base.link_port)),
        Station(base.url) as client,
    ):
        drone = await vehicle(client)
        async with running(*companion_command(base.link_port)):
            await until(lambda: len(drone.now().conflict_link_ids) > 0, "the conflict")
        await until(lambda: drone.now().is_live and not drone.now().conflict_link_ids, "one link")


@in_loop
async def test_the_placeholder_is_no_identity(site: Path) -> None:
    """`placeholder-serial`."""
    async with (
        station(site) as base,
        running(*companion_command(base.link_port, "--serial", "00000")),
        Station(base.url) as client,
    ):
        await until(lambda: len(client.vehicles()) == 1, "the link")
        await until(lambda: client.vehicles()[0].is_live, "its telemetry")
        assert client.vehicles()[0].serial in (None, "")


@in_loop
async def test_the_app_waits_for_a_station_that_restarts(site: Path) -> None:
    async with station(site) as first:
        port = first.link_port
        app_process = running(*companion_command(port, *HOVERING))
        app = await app_process.__aenter__()
        await app.line("Connected to the station")
    try:
        await app.line("Link to the station lost")
        lines = len(app.lines)
        async with station(site, link_port=port) as second, Station(second.url) as client:
            await app.line("Connected to the station", after=lines)
            drone = await vehicle(client)
            await finish(await drone.hold())
    finally:
        await app_process.__aexit__(None, None, None)


@in_loop
async def test_a_station_that_stops_reading_gets_a_sentence_and_no_crash(site: Path) -> None:
    async with (
        station(site) as base,
        running(*companion_command(base.link_port, *HOVERING, "--images", "raw")) as app,
    ):
        async with Station(base.url) as client:
            drone = await vehicle(client)
            await finish(await drone.start_camera(10.0))
        base.process.suspend()
        try:
            await app.line("the station has not read for 5 s")
        finally:
            base.process.resume()
        await app.line("Connected to the station", after=len(app.lines))
        async with Station(base.url) as client:
            await finish(await (await vehicle(client)).hold())


@in_loop
async def test_a_mission_holds_when_its_station_is_gone(site: Path) -> None:
    async with station(site) as base:
        port = base.link_port
        app_process = running(*companion_command(port, *HOVERING))
        app = await app_process.__aenter__()
        async with Station(base.url) as client:
            drone = await vehicle(client)
            await finish(await drone.fly(leg(drone, north_m=200.0)), Phase.STARTED)
    try:
        await app.line("No link to the station: the mission ends, hold")
        async with station(site, link_port=port) as again, Station(again.url) as client:
            drone = await vehicle(client)
            await until(lambda: drone.now().flight_mode.value == "gps_atti", "the hover")
    finally:
        await app_process.__aexit__(None, None, None)


FAULTS = {
    "delay and jitter": ("--delay-ms", "150", "--jitter-ms", "100"),
    "a slow link": ("--rate-kb-s", "20"),
    "stalls": ("--stalls-per-min", "20", "--stall-s", "1"),
    "resets": ("--resets-per-min", "15"),
    "corruption towards the station": ("--corruption-per-mb", "2000", "--towards", "station"),
    "corruption towards the app": ("--corruption-per-mb", "2000", "--towards", "app"),
    "everything": (
        *("--delay-ms", "100", "--jitter-ms", "100", "--rate-kb-s", "50", "--stalls-per-min", "6"),
        *("--stall-s", "1", "--resets-per-min", "4", "--corruption-per-mb", "500"),
    ),
}


@pytest.mark.parametrize("fault", FAULTS if IS_THOROUGH else ["everything"])
@in_loop
async def test_orders_come_through_a_bad_link(site: Path, fault: str) -> None:
    async with (
        station(site) as base,
        proxy(base.link_port, *FAULTS[fault]) as port,
        running(*companion_command(port, *HOVERING)) as app,
        Station(base.url) as client,
    ):
        drone = await vehicle(client)
        # Images, for the traffic; a link that damages each of them never confirms this order.
        accepted(await drone.start_camera(2.0))
        for _ in range(3):
            await _held(drone)
            await asyncio.sleep(1.0)
        assert app.process.returncode is None
        assert not [line for line in app.lines if "Error in the app" in line]


async def _held(drone: Vehicle) -> None:
    """Order a hold until one is shown by telemetry: a link may break in the middle of any."""
    for _ in range(20):
        answer = await drone.hold()
        if not isinstance(answer, Refusal):
            status = await accepted(answer).wait(Phase.DONE, timeout_s=60.0)
            if status.phase is Phase.DONE:
                return
        await asyncio.sleep(0.5)
    raise AssertionError("no hold came through")
