"""A first flight from Python: take off, fly a short leg, land.

Run: uv run python examples/04_first_flight.py            (starts a station and a simulated drone)
     uv run python examples/04_first_flight.py URL SERIAL  (a running station; THE DRONE TAKES OFF)
"""

import asyncio
import signal
import sys

from recon.client import Mission, Position, Refusal, Station, Waypoint
from recon.sim.fleet import Airborne, SimulationConfig
from recon.sim.run import run_fleet
from recon.site import demo_site_folder, load_site
from recon.station.host.run import run
from recon.station.host.run_config import RunConfig, Started

LEG_DEG = 0.0001
"""About 11 m north."""


async def first_flight(url: str, serial: str) -> None:
    """Fly one leg at 10 m and land; print the phase of each order."""
    async with Station(url) as station:
        vehicle = await station.vehicle(serial)
        order = await vehicle.fly(leg_north(vehicle.now().position), takeoff=True)
        if isinstance(order, Refusal):
            raise SystemExit(f"refused: {order.reason}")
        print("flight:", (await order.wait()).phase.value)
        async for state in vehicle.telemetry():
            if state.is_live and (state.height_above_takeoff_m.value or 0.0) > 8.0:
                break
        order = await vehicle.land()
        print("landing:", order if isinstance(order, Refusal) else (await order.wait()).phase.value)


def leg_north(start: Position) -> Mission:
    """Return a mission of two waypoints, from the start position north."""
    if start.latitude_deg is None or start.longitude_deg is None:
        raise SystemExit("position of the vehicle unknown")
    return Mission(
        tuple(
            Waypoint(start.latitude_deg + north_deg, start.longitude_deg, 10.0, 3.0)
            for north_deg in (0.0, LEG_DEG)
        )
    )


async def with_a_simulated_drone() -> None:
    """Start a station and a simulated drone on free ports, fly, and stop both."""
    site = load_site(demo_site_folder())
    assert site.frame is not None
    pads = {serial: profile.pad for serial, profile in site.profiles.items() if profile.pad}
    home = site.frame.origin

    async def fly(started: Started) -> None:
        config = SimulationConfig(
            home=home,
            station_port=started.link_port,
            vehicle_count=1,
            airborne=Airborne.NONE,
            pads=pads,
        )
        drone = asyncio.create_task(run_fleet(config, say=lambda line: None))
        try:
            await first_flight(started.console_url, "SIM-1")
        finally:
            drone.cancel()
            signal.raise_signal(signal.SIGINT)  # Stops the station, as Ctrl+C does.

    await run(RunConfig(site, link_port=0, http_port=0), fly)


if __name__ == "__main__":
    args = sys.argv[1:]
    if len(args) not in (0, 2):
        sys.exit(__doc__)
    asyncio.run(first_flight(*args) if args else with_a_simulated_drone())
