"""The life of every order, given by a client of the station and flown by the JVM companion."""

from pathlib import Path

from tests.android.flying import accepted, finish, leg, speed_mps, vehicle
from tests.android.processes import companion_command, in_loop, running, station, until

from recon.client import Phase, Refusal, Station


@in_loop
async def test_every_order_is_confirmed_by_telemetry(site: Path) -> None:
    async with (
        station(site) as base,
        running(*companion_command(base.link_port)) as app,
        Station(base.url) as client,
    ):
        drone = await vehicle(client)
        assert drone.now().is_simulated
        await finish(await drone.fly(leg(drone), takeoff=True), Phase.STARTED)
        await until(lambda: speed_mps(drone) > 2.0, "the mission being flown")
        await finish(await drone.hold())
        await finish(
            await drone.stick(
                yaw_deg=0.0,
                velocity_x_mps=2.0,
                velocity_y_mps=0.0,
                height_above_takeoff_m=12.0,
                timeout_s=1.0,
            )
        )
        await finish(await drone.nudge(north_m=5.0))
        await finish(await drone.start_camera(2.0))
        await until(lambda: drone.now().camera_state.value == "feed_on", "the feed being on")
        await finish(await drone.stop_camera())
        await finish(await drone.fly(leg(drone, north_m=10.0)))
        await finish(await drone.return_home())
        refusal = await drone.hold()
        assert isinstance(refusal, Refusal)
        assert refusal.rule == "flying"
        assert not [line for line in app.lines if "error" in line]


@in_loop
async def test_a_landing_is_confirmed_by_the_app(site: Path) -> None:
    command = ("--airborne-m", "10")
    async with (
        station(site) as base,
        running(*companion_command(base.link_port, *command)),
        Station(base.url) as client,
    ):
        drone = await vehicle(client)
        await finish(await drone.land())
        assert drone.now().is_flying.value is False


@in_loop
async def test_a_refused_order_has_the_reason_of_the_app(site: Path) -> None:
    """Through the real station a sentence of the app reaches the operator, and the order ends."""
    # The app takes WGS84 altitudes, the site says takeoff: 12 m is 263 m under the ground.
    command = ("--airborne-m", "10", "--waypoint-altitude", "wgs84")
    async with (
        station(site) as base,
        running(*companion_command(base.link_port, *command)) as app,
        Station(base.url) as client,
    ):
        drone = await vehicle(client)
        status = await accepted(await drone.fly(leg(drone))).wait(Phase.STARTED)
        assert status.phase is Phase.REFUSED_BY_APP
        await app.line("Waypoint 1: height above takeoff must be -200 to 500 m; got -263")
