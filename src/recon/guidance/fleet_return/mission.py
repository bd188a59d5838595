"""A planned flight as the landing mission that is sent."""

from math import hypot

import numpy as np

from recon.geo import geo_from_enu
from recon.guidance.fleet_return.flight import Flight, Place
from recon.guidance.fleet_return.settings import FleetReturnSettings
from recon.model.geo import LocalFrame
from recon.model.mission import Mission, Waypoint

LEAST_LEG_M = 1.0
"""DJI refuses waypoints nearer than 0.5 m; over its pad a vehicle sinks by this much instead."""


def mission_of(
    flight: Flight,
    frame: LocalFrame,
    place_m: Place,
    settings: FleetReturnSettings,
    speed_mps: float,
) -> Mission:
    """Return the mission of a flight that begins where the vehicle hovers now, `place_m`.

    The first waypoint is over that place, so that the aircraft climbs or sinks on the spot, however
    its app flies to a first waypoint.
    """
    way_m = [place_m[:2], *flight.way_m[1:]]
    up_m = [flight.layer_up_m] * len(way_m)
    if hypot(way_m[0][0] - way_m[-1][0], way_m[0][1] - way_m[-1][1]) < LEAST_LEG_M:
        up_m[-1] -= LEAST_LEG_M
    flat_m = np.column_stack([np.array(way_m), np.zeros(len(way_m))])
    latitude_deg, longitude_deg, _ = geo_from_enu(frame, flat_m)
    speed = min(speed_mps, settings.speed_mps)
    return Mission(
        tuple(
            Waypoint(float(latitude), float(longitude), height_m - flight.takeoff_up_m, speed)
            for latitude, longitude, height_m in zip(latitude_deg, longitude_deg, up_m, strict=True)
        ),
        land_at_end=True,
        purpose=f"fleet return: to {flight.pad.name}",
    )
