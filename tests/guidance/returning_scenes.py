"""Fleets over fields, drawn: pads in a row, vehicles that hover apart, zones here and there."""

from dataclasses import dataclass
from math import hypot
from random import Random

import numpy as np

from recon.guidance.fleet_return import (
    CalledVehicle,
    FleetReturnSettings,
    Pad,
    ReturnPlan,
    RouteHome,
    Separation,
    plan_return,
    route_home,
)
from recon.model.airspace import Airspace, FlightLimits, HeightDatum, Region, Zone, ZoneKind
from recon.model.geo import GeoPoint, LocalFrame

SETTINGS = FleetReturnSettings()
LEAST = Separation(15.0, 6.0)
KEPT = Separation(18.0, 7.0)
"""What a flight is planned with: the least separation and the settings' slack."""

FRAME = LocalFrame(GeoPoint(41.9, -93.6, 275.0))
HALF_FIELD_M = 300.0
LOW_GROUND_M, HIGH_GROUND_M = -2.0, 3.0


@dataclass(frozen=True)
class Scene:
    """A fleet and its site. `airspace` has no boundary unless asked for."""

    vehicles: tuple[CalledVehicle, ...]
    airspace: Airspace
    home: RouteHome

    def plan(self) -> ReturnPlan:
        return plan_return(self.vehicles, self.home, KEPT, SETTINGS)

    def vehicle(self, name: str) -> CalledVehicle:
        return next(v for v in self.vehicles if v.name == name)


def box(east_m: float, north_m: float, half_m: float) -> Region:
    corners = [(-half_m, -half_m), (half_m, -half_m), (half_m, half_m), (-half_m, half_m)]
    return Region(np.array([(east_m + e, north_m + n) for e, n in corners]))


def keep_out(
    name: str, region: Region, floor_m: float | None = None, ceiling_m: float | None = None
) -> Zone:
    datum = None if floor_m is None and ceiling_m is None else HeightDatum.GROUND
    return Zone(name, ZoneKind.KEEP_OUT, region, floor_m, ceiling_m, datum)


def row_of_pads(count: int, spacing_m: float) -> list[Pad]:
    west_m = -0.5 * spacing_m * (count - 1)
    return [Pad(f"pad {i + 1}", west_m + i * spacing_m, -40.0, 0.0) for i in range(count)]


def scene_of(
    vehicles: list[CalledVehicle],
    ceiling_m: float = 120.0,
    zones: tuple[Zone, ...] = (),
    boundary: Region | None = None,
) -> Scene:
    limits = FlightLimits(max_height_above_ground_m=ceiling_m)
    airspace = Airspace(limits, FRAME, boundary, zones)
    points = [v.place_m[:2] for v in vehicles] + [v.pad.east_north_m for v in vehicles]
    ground = (LOW_GROUND_M, HIGH_GROUND_M)
    return Scene(tuple(vehicles), airspace, route_home(airspace, ground, points, SETTINGS))


def drawn_scene(
    seed: int,
    count: int,
    pads: int,
    ceiling_m: float,
    zone_count: int = 0,
    *,
    is_fenced: bool = False,
    hovers_apart: bool = True,
) -> Scene:
    """Return a scene; vehicles hover as far apart as a flight is planned, by default."""
    rng = Random(seed)
    row = row_of_pads(pads, rng.uniform(8.0, 30.0))
    zones = tuple(_zone(rng, number) for number in range(zone_count))
    vehicles: list[CalledVehicle] = []
    for _ in range(60 * count):
        if len(vehicles) == count:
            break
        place = (
            rng.uniform(-HALF_FIELD_M, HALF_FIELD_M),
            rng.uniform(0.0, HALF_FIELD_M),
            rng.uniform(8.0, 115.0),
        )
        if hovers_apart and not _is_clear(place, vehicles):
            continue
        number = len(vehicles) + 1
        takeoff_m, battery = rng.uniform(-2.0, 3.0), rng.uniform(0.15, 1.0)
        pad = rng.choice(row)
        vehicles.append(
            CalledVehicle(f"S-{number}", f"Drone {number}", place, takeoff_m, pad, battery)
        )
    fence = box(0.0, 100.0, 420.0) if is_fenced else None
    return scene_of(vehicles, ceiling_m, zones, fence)


def _zone(rng: Random, number: int) -> Zone:
    middle = rng.uniform(-250.0, 250.0), rng.uniform(30.0, 280.0)
    region = box(*middle, rng.uniform(5.0, 50.0))
    ceiling_m = rng.choice([None, None, rng.uniform(5.0, 150.0)])
    return keep_out(f"zone {number + 1}", region, None, ceiling_m)


def _is_clear(place: tuple[float, float, float], vehicles: list[CalledVehicle]) -> bool:
    return all(
        abs(place[2] - v.place_m[2]) >= KEPT.vertical_m
        or hypot(place[0] - v.place_m[0], place[1] - v.place_m[1]) >= KEPT.horizontal_m
        for v in vehicles
    )
