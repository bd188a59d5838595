"""What goes into a plan and what comes out. Places are (east, north, up) metres of the site.

Up counts from the height of the frame's origin, in one datum for all vehicles: each one's own
height above takeoff is added to the height of its takeoff point before it comes in here.
"""

from dataclasses import dataclass
from math import hypot

import numpy as np

from recon.geo import geo_from_enu
from recon.guidance.fleet_return.settings import FleetReturnSettings
from recon.guidance.fleet_return.volume import Volume, column, level_legs
from recon.model.geo import LocalFrame
from recon.model.mission import Mission, Waypoint

Place = tuple[float, float, float]
EastNorth = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Pad:
    """Where a vehicle lands."""

    name: str
    east_m: float
    north_m: float
    up_m: float

    @property
    def east_north_m(self) -> EastNorth:
        """Its place on the ground."""
        return self.east_m, self.north_m


@dataclass(frozen=True, slots=True)
class Hovering:
    """Something in the air that stays where it is. `key` is its own alone, its name may not be."""

    key: str
    name: str
    place_m: Place


@dataclass(frozen=True, slots=True)
class CalledVehicle:
    """A vehicle that hovers and is called home. `battery_fraction` None: not known, taken for
    the lowest."""

    serial: str
    name: str
    place_m: Place
    takeoff_up_m: float
    pad: Pad
    battery_fraction: float | None = None

    @property
    def hovering(self) -> Hovering:
        """The vehicle as the others see it while it waits."""
        return Hovering(self.serial, self.name, self.place_m)


@dataclass(frozen=True, slots=True)
class ReturnFlight:
    """One way home: up or down to the layer on the spot, along `way_m` in it, down at the pad.

    `way_m` begins over the vehicle's place and ends over its pad, at least two points. `wave`
    counts from 1.
    """

    serial: str
    name: str
    start_m: Place
    takeoff_up_m: float
    pad: Pad
    layer_up_m: float
    way_m: tuple[EastNorth, ...]
    wave: int

    @property
    def volumes(self) -> tuple[Volume, ...]:
        """Every place it passes, in order: its column, its way, the pad's column."""
        east_m, north_m, up_m = self.start_m
        return (
            column((east_m, north_m), up_m, self.layer_up_m),
            *level_legs(self.way_m, self.layer_up_m),
            column(self.pad.east_north_m, self.layer_up_m, self.pad.up_m),
        )


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A vehicle without a flight, and why, in words for its operator."""

    serial: str
    name: str
    reason: str


@dataclass(frozen=True, slots=True)
class ReturnPlan:
    """Flights in the order of their turn, and those left out. `layers_up_m` from the lowest."""

    layers_up_m: tuple[float, ...]
    flights: tuple[ReturnFlight, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def waves(self) -> tuple[tuple[ReturnFlight, ...], ...]:
        """The flights by wave; in a wave every vehicle has a layer of its own."""
        numbers = sorted({flight.wave for flight in self.flights})
        return tuple(tuple(f for f in self.flights if f.wave == number) for number in numbers)


LEAST_LEG_M = 1.0
"""DJI refuses waypoints nearer than 0.5 m; over its pad a vehicle sinks by this much instead."""


def mission_of(
    flight: ReturnFlight,
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
