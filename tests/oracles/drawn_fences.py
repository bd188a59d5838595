"""Drawn sites, vehicles and orders: the gate's fence rules against a slow checker that samples.

Every rule's answer is compared with the margin that `sampled_fences` measures, wherever the margin
exceeds what lies between two samples.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from tests.oracles import sampled_fences as sampled
from tests.oracles.agreement import Agreement, over
from tests.oracles.places import NOW_NS, ORIGIN, FloatArray, degrees, lat_lon

from recon.model.airspace import (
    Airspace,
    ElevationModel,
    FlightLimits,
    HeightDatum,
    Region,
    Zone,
    ZoneKind,
)
from recon.model.command import Body, Command, FlyMission, GoTo, StickFrame, VirtualStick
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, VehicleProfile, VehicleState
from recon.safety import PreparedAirspace, Situation
from recon.safety.rules import Rule
from recon.safety.rules.boundary import boundary
from recon.safety.rules.height_zones import height_zones
from recon.safety.rules.home_distance import home_distance
from recon.safety.rules.keep_out import keep_out
from recon.safety.rules.max_height import max_height
from recon.safety.rules.min_height import min_height

RULES: dict[str, Rule] = {
    "boundary": boundary,
    "keep_out": keep_out,
    "height_zones": height_zones,
    "min_height": min_height,
    "max_height": max_height,
    "home_distance": home_distance,
}
GROUND_CELL_M = 25.0
GROUND_HALF_M = 1500.0


@dataclass(slots=True, eq=False)
class Scene:
    """One site, vehicle and order, as the gate and as the sampling see it."""

    situation: Situation
    command: Command
    place: sampled.Place
    aircraft: sampled.Aircraft
    pieces: list[sampled.Piece]


def compare(seeds: range, rules: Mapping[str, Rule] = RULES, progress: bool = False) -> Agreement:
    """Return how rules and sampling agree on the scenes of these seeds."""
    return over(seeds, partial(_compare, rules), progress)


def _compare(rules: Mapping[str, Rule], seed: int, found: Agreement) -> None:
    scene = draw(seed)
    margins = sampled.margins(scene.place, scene.aircraft, scene.pieces)
    for name, rule in rules.items():
        if not margins.is_sure(name):
            found.unsure[name] += 1
            continue
        refusal = rule(scene.command, scene.situation)
        found.compare(f"scene {seed}", name, margins.values_m[name], refusal)


def draw(seed: int) -> Scene:
    """Return the scene of a seed."""
    rng = np.random.default_rng(seed)
    ground_m = _ground(rng)
    margin_m = float(rng.uniform(0.0, 10.0))
    limits = FlightLimits(
        max_height_above_ground_m=float(rng.uniform(60.0, 130.0)),
        min_height_above_ground_m=float(rng.uniform(2.0, 15.0)),
        max_distance_from_home_m=float(rng.uniform(100.0, 500.0)),
        boundary_margin_m=margin_m,
    )
    ring = _star(rng, np.zeros(2), float(rng.uniform(120.0, 350.0)))
    zones = tuple(_zone(rng, number) for number in range(rng.integers(0, 4)))
    place = sampled.Place(
        boundary=ring,
        zones=zones,
        margin_m=margin_m,
        least_height_m=limits.min_height_above_ground_m,
        most_height_m=limits.max_height_above_ground_m,
        most_distance_m=limits.max_distance_from_home_m,
        ground_m=ground_m,
        west_m=-GROUND_HALF_M,
        north_m=GROUND_HALF_M,
        cell_m=GROUND_CELL_M,
    )
    aircraft = _aircraft(rng, place)
    airspace = PreparedAirspace(_airspace(limits, place))
    body, pieces = _order(rng, place, aircraft)
    return Scene(
        Situation(NOW_NS, _vehicle(aircraft), (), airspace=airspace),
        Command(1, body, "study", NOW_NS, NOW_NS + 5 * 10**9, serial="A"),
        place,
        aircraft,
        pieces,
    )


def _ground(rng: np.random.Generator) -> FloatArray:
    """Flat in half of the scenes, else waves of up to 10 m."""
    cells = round(2 * GROUND_HALF_M / GROUND_CELL_M)
    if rng.random() < 0.5:
        return np.zeros((cells, cells))
    middles = -GROUND_HALF_M + GROUND_CELL_M * (np.arange(cells) + 0.5)
    east, north = np.meshgrid(middles, middles[::-1])
    height_m, wave_m = rng.uniform(2.0, 10.0), rng.uniform(300.0, 900.0)
    turn = rng.uniform(0.0, 6.28, 2)
    waves: FloatArray = (
        height_m * np.sin(east / wave_m * 6.28 + turn[0]) * np.cos(north / wave_m * 6.28 + turn[1])
    )
    return waves


def _star(rng: np.random.Generator, centre_m: FloatArray, radius_m: float) -> sampled.Ring:
    """A polygon whose corners all see its centre: never crossing, seldom convex."""
    count = int(rng.integers(5, 12))
    angles = (np.arange(count) + rng.uniform(0.25, 0.75, count)) / count * 2.0 * np.pi
    radii = radius_m * rng.uniform(0.55, 1.0, count)
    outline = centre_m + np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    if radius_m < 100.0 or rng.random() < 0.7:
        return sampled.Ring(outline)
    hole = _star(rng, centre_m + rng.uniform(-10.0, 10.0, 2), 12.0)
    return sampled.Ring(outline, (hole.outline_m,))


def _zone(rng: np.random.Generator, number: int) -> sampled.SampledZone:
    ring = _star(rng, rng.uniform(-150.0, 150.0, 2), float(rng.uniform(10.0, 60.0)))
    is_keep_out = bool(rng.random() < 0.6)
    floor_m = float(rng.uniform(5.0, 40.0)) if rng.random() < 0.5 else None
    ceiling_m = float(rng.uniform(45.0, 100.0)) if rng.random() < 0.5 else None
    if not is_keep_out and floor_m is None and ceiling_m is None:
        floor_m = 20.0
    return sampled.SampledZone(ring, is_keep_out, floor_m, ceiling_m, bool(rng.random() < 0.5))


def _aircraft(rng: np.random.Generator, place: sampled.Place) -> sampled.Aircraft:
    home_m, here_m = np.zeros(3), np.zeros(3)
    home_m[:2] = rng.uniform(-80.0, 80.0, 2)
    here_m[:2] = home_m[:2] + rng.uniform(-120.0, 120.0, 2)
    home_m[2] = sampled.ground_m(place, home_m[np.newaxis, :2])[0]
    here_m[2] = home_m[2] + rng.uniform(15.0, 90.0)
    go_home_m = home_m[2] + rng.uniform(20.0, 110.0)
    failsafe = str(rng.choice(["go_home", "go_home", "hover", "land"]))
    return sampled.Aircraft(here_m, home_m, float(go_home_m), failsafe)


def _order(
    rng: np.random.Generator, place: sampled.Place, aircraft: sampled.Aircraft
) -> tuple[Body, list[sampled.Piece]]:
    takeoff_m = float(aircraft.home_m[2])
    kind = rng.random()
    if kind < 0.15:
        target_m = _somewhere(rng, aircraft)
        body: Body = GoTo(lat_lon(target_m), float(target_m[2] - takeoff_m), 5.0)
        return body, sampled.goto_pieces(aircraft, target_m)
    if kind < 0.3:
        velocity_mps, up_m = rng.uniform(-10.0, 10.0, 2), aircraft.here_m[2] + rng.uniform(-20, 20)
        timeout_s = float(np.float32(rng.uniform(0.5, 5.0)))
        height_m = float(up_m - takeoff_m)
        north_mps, east_mps = float(velocity_mps[1]), float(velocity_mps[0])
        body = VirtualStick(StickFrame.GROUND, 0.0, north_mps, east_mps, height_m, timeout_s)
        return body, sampled.stick_pieces(aircraft, velocity_mps, float(up_m), timeout_s)
    return _mission(rng, aircraft)


def _mission(
    rng: np.random.Generator, aircraft: sampled.Aircraft
) -> tuple[Body, list[sampled.Piece]]:
    points_m = np.array([_somewhere(rng, aircraft) for _ in range(rng.integers(2, 7))])
    curved, land_at_end = bool(rng.random() < 0.5), bool(rng.random() < 0.3)
    radii_m = rng.uniform(0.2, 40.0, len(points_m))
    waypoints = tuple(
        Waypoint(
            *degrees(point),
            float(point[2] - aircraft.home_m[2]),
            5.0,
            corner_radius_m=float(radius),
        )
        for point, radius in zip(points_m, radii_m, strict=True)
    )
    pieces = sampled.mission_pieces(
        aircraft, points_m, radii_m, curved=curved, land_at_end=land_at_end
    )
    return FlyMission(Mission(waypoints, land_at_end, curved)), pieces


def _somewhere(rng: np.random.Generator, aircraft: sampled.Aircraft) -> FloatArray:
    spread_m = float(rng.choice([40.0, 120.0, 220.0]))
    place = aircraft.home_m + np.array([*rng.uniform(-spread_m, spread_m, 2), 0.0])
    place[2] += rng.uniform(8.0, 110.0)
    return place


def _airspace(limits: FlightLimits, place: sampled.Place) -> Airspace:
    frame = LocalFrame(ORIGIN)
    is_flat = not place.ground_m.any()
    rows, cols = place.ground_m.shape
    grid = GroundGrid(frame, place.west_m, place.north_m, place.cell_m, rows, cols)
    model = ElevationModel(grid, place.ground_m + ORIGIN.ellipsoid_height_m)
    return Airspace(
        limits=limits,
        frame=frame,
        boundary=Region(place.boundary.outline_m, place.boundary.holes_m),
        zones=tuple(_model_zone(zone, n) for n, zone in enumerate(place.zones)),
        elevation=None if is_flat else model,
    )


def _model_zone(zone: sampled.SampledZone, number: int) -> Zone:
    has_heights = zone.floor_m is not None or zone.ceiling_m is not None
    datum = HeightDatum.GROUND if zone.over_ground else HeightDatum.WGS84
    raised_m = 0.0 if zone.over_ground else ORIGIN.ellipsoid_height_m
    return Zone(
        f"zone {number}",
        ZoneKind.KEEP_OUT if zone.is_keep_out else ZoneKind.HEIGHT,
        Region(zone.ring.outline_m, zone.ring.holes_m),
        None if zone.floor_m is None else zone.floor_m + raised_m,
        None if zone.ceiling_m is None else zone.ceiling_m + raised_m,
        datum if has_heights else None,
    )


def _vehicle(aircraft: sampled.Aircraft) -> VehicleState:
    at_ns = NOW_NS - 10**8
    takeoff_m = float(aircraft.home_m[2])
    return VehicleState(
        serial="A",
        link_id=1,
        profile=VehicleProfile(
            "A",
            go_home_height_m=aircraft.go_home_m - takeoff_m,
            failsafe=Failsafe(aircraft.failsafe),
        ),
        is_flying=Stamped(True, at_ns),
        position=Stamped(lat_lon(aircraft.here_m), at_ns),
        height_above_takeoff_m=Stamped(float(aircraft.here_m[2]) - takeoff_m, at_ns),
        takeoff_point=lat_lon(aircraft.home_m),
    )
