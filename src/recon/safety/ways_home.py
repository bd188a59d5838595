"""How an aircraft comes down by itself when it loses its controller or its battery runs low."""

import numpy as np
import numpy.typing as npt

from recon.model.vehicle import Failsafe
from recon.safety.departure import Departure
from recon.safety.flown_path import Kind, Pieces, block, joined

FloatArray = npt.NDArray[np.float64]

HOME = "home"


def ways_home(flown: Pieces, departure: Departure) -> Pieces:
    """Return what may follow at every point of what is flown, by the aircraft's failsafe.

    Going home: a climb to the go-home height (where it is lower), then straight home at that
    height or the higher one it has, and down. From a flight these ways fill the triangle of the
    flight and home; those of a corner lie in the corner and in its legs' triangles. Landing: from
    everywhere straight down. Hovering: nothing.
    """
    if departure.failsafe is Failsafe.HOVER:
        return _none()
    if departure.failsafe is Failsafe.LAND:
        low_m = np.full(len(flown), -np.inf)
        return _like(flown, Kind.LANDING, flown.triangles_m, low_m, flown.high_m)
    return _going_home(flown, departure)


def _going_home(flown: Pieces, departure: Departure) -> Pieces:
    least_m, most_m = departure.go_home_m
    top_m = np.maximum(flown.high_m, most_m)
    climbs = _like(flown, Kind.CLIMB, flown.triangles_m, flown.low_m, top_m)
    flights = flown.only(flown.kinds == Kind.FLIGHT)
    triangles_m = flights.triangles_m.copy()
    return_m = np.maximum(flights.low_m, least_m), np.maximum(flights.high_m, most_m)
    # A flight is a leg (start, end, end): the way home starts anywhere on it.
    triangles_m[:, 2] = departure.home_m[:2]
    ways = _like(flights, Kind.WAY_HOME, triangles_m, *return_m)
    home_m = np.broadcast_to(departure.home_m[:2], (1, 3, 2))
    highest_m = np.array([return_m[1].max(initial=departure.takeoff_m)])
    return joined(
        climbs, ways, block(Kind.LANDING, home_m, np.array([-np.inf]), highest_m, (HOME,))
    )


def _like(
    flown: Pieces,
    kind: Kind,
    triangles_m: FloatArray,
    low_m: FloatArray,
    high_m: FloatArray,
) -> Pieces:
    return block(kind, triangles_m, low_m, high_m, flown.names, is_entry=flown.is_entry)


def _none() -> Pieces:
    nothing = np.zeros(0)
    return block(Kind.CLIMB, np.zeros((0, 3, 2)), nothing, nothing, ())
