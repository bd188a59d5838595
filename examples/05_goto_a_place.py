"""Fly to a position and hold there, steered by the station.

Run: uv run python examples/05_goto_a_place.py            (starts a station and a simulated drone)
     uv run python examples/05_goto_a_place.py URL SERIAL  (a running station; THE DRONE FLIES 15 m)
"""

import asyncio
import signal
import sys

from recon.client import Position, Refusal, Station
from recon.geo.distance import moved_m
from recon.model.geo import GeoPoint, LatLon
from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile
from recon.sim.fleet import Airborne, SimulationConfig
from recon.sim.run import run_fleet
from recon.site import Site
from recon.station.host.run import run
from recon.station.host.run_config import RunConfig, Started

HOME = GeoPoint(41.9012, -93.6034, 275.0)


async def fly_there(url: str, serial: str) -> None:
    """Fly 15 m north and print the result; the vehicle holds there until this program ends."""
    async with Station(url) as station:
        vehicle = await station.vehicle(serial)
        target = north_of(vehicle.now().position, 15.0)
        order = await vehicle.goto(*target, height_above_takeoff_m=40.0, speed_mps=4.0)
        if isinstance(order, Refusal):
            raise SystemExit(f"refused: {order.reason}")
        print("goto:", (await order.wait_for_arrival()).note)


def north_of(start: Position, metres: float) -> tuple[float, float]:
    """Return latitude and longitude of a position `metres` north of `start`."""
    if start.latitude_deg is None or start.longitude_deg is None:
        raise SystemExit("position of the vehicle unknown")
    target = moved_m(LatLon(start.latitude_deg, start.longitude_deg), metres, 0.0)
    return target.latitude_deg, target.longitude_deg


async def with_a_simulated_drone() -> None:
    """Start a station and a flying simulated drone on free ports, fly, and stop both."""
    profile = VehicleProfile(
        "SIM-1",
        waypoint_altitude=AltitudeReference.TAKEOFF,
        pad=HOME,
        endurance_s=1_500.0,
        go_home_height_m=40.0,
        failsafe=Failsafe.GO_HOME,
    )
    site = Site(name="goto", profiles={"SIM-1": profile})

    async def fly(started: Started) -> None:
        config = SimulationConfig(
            home=HOME,
            station_port=started.link_port,
            vehicle_count=1,
            airborne=Airborne.ALL,
            pads={"SIM-1": HOME},
        )
        drone = asyncio.create_task(run_fleet(config, say=lambda line: None))
        try:
            await fly_there(started.console_url, "SIM-1")
        finally:
            drone.cancel()
            signal.raise_signal(signal.SIGINT)  # Stops the station, as Ctrl+C does.

    await run(RunConfig(site, link_port=0, http_port=0), fly)


if __name__ == "__main__":
    args = sys.argv[1:]
    if len(args) not in (0, 2):
        sys.exit(__doc__)
    asyncio.run(fly_there(*args) if args else with_a_simulated_drone())
