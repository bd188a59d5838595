"""Go to a place and hold there, steered by the station: five lines of a program, and what happens.

Run: uv run python examples/05_goto_a_place.py             (a station and a drone of its own)
     uv run python examples/05_goto_a_place.py URL SERIAL   (a station that runs; IT FLIES 15 m)
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
from recon.station.kernel.run import RunConfig, Started, run

HOME = GeoPoint(41.9012, -93.6034, 275.0)


async def fly_there(url: str, serial: str) -> None:
    """Fly 15 m north and say what became of it; the vehicle is held there until this ends."""
    async with Station(url) as station:
        vehicle = await station.vehicle(serial)
        there = north_of(vehicle.now().position, 15.0)
        order = await vehicle.goto(*there, height_above_takeoff_m=40.0, speed_mps=4.0)
        print("goto:", order.reason if isinstance(order, Refusal) else (await order.arrival()).note)


def north_of(start: Position, metres: float) -> tuple[float, float]:
    """Return latitude and longitude of a place so far north of a vehicle."""
    if start.latitude_deg is None or start.longitude_deg is None:
        raise SystemExit("the vehicle has not told its position")
    place = moved_m(LatLon(start.latitude_deg, start.longitude_deg), metres, 0.0)
    return place.latitude_deg, place.longitude_deg


async def with_a_simulated_drone() -> None:
    """Start a station and a simulated drone in the air on free ports, fly, and end both."""
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
            signal.raise_signal(signal.SIGINT)  # as Ctrl+C would: the station ends

    await run(RunConfig(site, link_port=0, http_port=0), fly)


if __name__ == "__main__":
    given = sys.argv[1:]
    if len(given) not in (0, 2):
        sys.exit(__doc__)
    asyncio.run(fly_there(*given) if given else with_a_simulated_drone())
