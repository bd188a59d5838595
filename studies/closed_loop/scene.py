"""One random site and fleet, as the station and as the oracles see it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import cos, hypot, pi, sin
from random import Random

import numpy as np
from tests.oracles.flown_air import EastNorth, TrueGround, TrueSite, TrueZone, depth_m

from recon.geo import point_from_enu
from recon.model.airspace import (
    ElevationModel,
    FlightLimits,
    HeightDatum,
    Region,
    Zone,
    ZoneKind,
)
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile
from recon.sim.app.app import SimulatedApp
from recon.sim.app.commands import HoverOnGround
from recon.sim.app.faults import FaultKind, InjectedFault
from recon.sim.fleet import Airborne, SimulationConfig, build_fleet
from recon.sim.flight.estimate import FIELD_DRIFT, DriftSettings
from recon.sim.flight.flight_modes import PositionHold
from recon.sim.world import WindSettings
from recon.site import Site
from recon.site.site import Layers

ORIGIN = GeoPoint(41.9, -93.6, 275.0)
FRAME = LocalFrame(ORIGIN)
CELL_M, HALF_M = 20.0, 1_500.0
FAULTS: Mapping[FaultKind, tuple[float, float]] = {
    FaultKind.ACK_THEN_NOTHING: (5.0, 40.0),
    FaultKind.NO_ACK: (5.0, 60.0),
    FaultKind.NEGATIVE_ACK: (5.0, 40.0),
    FaultKind.TELEMETRY_DROPOUT: (0.5, 15.0),
    FaultKind.HALF_OPEN: (5.0, 40.0),
    FaultKind.SECOND_LINK: (5.0, 30.0),
    FaultKind.RESTART: (0.5, 8.0),
    FaultKind.PLACEHOLDER_SERIAL: (1.0, 20.0),
    FaultKind.BURSTS: (10.0, 60.0),
    FaultKind.DELAYED_ACKS: (10.0, 60.0),
    FaultKind.IGNORED_MISSIONS: (10.0, 60.0),
    FaultKind.CORRUPTED_BYTES: (10.0, 60.0),
    FaultKind.SLOW_READER: (5.0, 30.0),
    FaultKind.FALLS_SILENT: (1.0, 2.0),
    FaultKind.TAKEOFF_ALTITUDE_LOST: (5.0, 40.0),
    FaultKind.TAKEOFF_ALTITUDE_STALE: (5.0, 40.0),
    FaultKind.GUSTS: (10.0, 60.0),
    FaultKind.GNSS_LOSS: (2.0, 20.0),
    FaultKind.LOW_BATTERY: (1.0, 2.0),
}
"""Faults that are drawn, with their shortest and longest duration; pilots are drawn elsewhere."""


@dataclass(frozen=True, slots=True)
class RunSettings:
    """How rough one run is; all of it drawn from the seed."""

    has_faults: bool
    has_bad_links: bool
    has_pilots: bool
    sends_invalid_orders: bool
    has_survey: bool
    restart_at_s: float | None
    switches_holds: bool
    operator_pace_s: float
    reacts_to_battery: bool


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """One seed's site and fleet."""

    seed: int
    truth: TrueSite
    site: Site
    apps: tuple[SimulatedApp, ...]
    homes_m: Mapping[str, tuple[float, float, float]]
    wgs84: frozenset[str]
    settings: RunSettings


def draw(seed: int, seconds: float) -> Scene:
    """Return the scene of a seed."""
    rng = Random(f"{seed}/scene")
    settings = _settings(rng, seconds)
    count = rng.randint(2, 10)
    truth, drift = _truth(rng)
    homes = _homes(rng, truth, count)
    truth = replace(truth, zones=tuple(_zones(rng, truth, homes)))
    serials = [f"SIM-{number}" for number in range(1, count + 1)]
    pads = {
        serial: point_from_enu(FRAME, home) for serial, home in zip(serials, homes, strict=True)
    }
    profiles = {
        serial: _profile(rng, serial, pads[serial], truth, n) for n, serial in enumerate(serials)
    }
    faults = tuple(_faults(rng, serials, seconds)) if settings.has_faults else ()
    apps = _apps(rng, seed, pads, profiles, faults, drift)
    homes_m = dict(zip(serials, homes, strict=True))
    if rng.random() < 0.6:
        _lift(rng, truth, apps, homes_m)
    wgs84 = frozenset(
        s for s, p in profiles.items() if p.waypoint_altitude is AltitudeReference.WGS84
    )
    return Scene(seed, truth, _site(truth, profiles), tuple(apps), homes_m, wgs84, settings)


def _settings(rng: Random, seconds: float) -> RunSettings:
    is_calm = rng.random() < 0.35
    return RunSettings(
        has_faults=not is_calm and rng.random() < 0.7,
        has_bad_links=not is_calm and rng.random() < 0.7,
        has_pilots=rng.random() < 0.5,
        sends_invalid_orders=rng.random() < 0.4,
        has_survey=rng.random() < 0.35,
        restart_at_s=rng.uniform(30.0, seconds) if rng.random() < 0.15 else None,
        switches_holds=rng.random() < 0.05,
        operator_pace_s=rng.choice((1.0, 3.0, 6.0)),
        reacts_to_battery=rng.random() < 0.85,
    )


def _truth(rng: Random) -> tuple[TrueSite, DriftSettings]:
    ground = TrueGround()
    if rng.random() < 0.6:
        rises = rng.uniform(-0.06, 0.06), rng.uniform(-0.06, 0.06)
        ground = TrueGround(*rises, rng.uniform(0.0, 4.0), rng.uniform(400.0, 900.0))
    drift = FIELD_DRIFT if rng.random() < 0.4 else DriftSettings()
    is_field = drift is FIELD_DRIFT
    truth = TrueSite(
        boundary_m=_star(rng, (0.0, 0.0), rng.uniform(180.0, 450.0)),
        ground=ground,
        least_height_m=rng.uniform(3.0, 10.0),
        most_height_m=rng.uniform(60.0, 120.0),
        most_distance_m=rng.choice((250.0, 500.0, 1_000.0)),
        apart_level_m=rng.uniform(10.0, 20.0),
        apart_up_m=rng.uniform(4.0, 8.0),
        # Three sigma of what a sensor's error is; the ground between two cells differs by less.
        error_level_m=2.2 if is_field else 0.5,
        error_up_m=2.5 if is_field else 0.5,
    )
    return truth, drift


def _star(rng: Random, centre_m: EastNorth, radius_m: float) -> tuple[EastNorth, ...]:
    count = rng.randint(4, 10)
    corners = []
    for number in range(count):
        angle = (number + rng.uniform(0.25, 0.75)) / count * 2.0 * pi
        reach_m = radius_m * rng.uniform(0.6, 1.0)
        corners.append((centre_m[0] + reach_m * cos(angle), centre_m[1] + reach_m * sin(angle)))
    return tuple(corners)


def _homes(rng: Random, truth: TrueSite, count: int) -> list[tuple[float, float, float]]:
    apart_m = rng.choice((6.0, 12.0, 25.0, 60.0))
    centre_m = somewhere(rng, truth, 40.0)
    homes: list[tuple[float, float, float]] = []
    spread_m = apart_m * 2.0
    while len(homes) < count:
        spread_m *= 1.02
        east_m = centre_m[0] + rng.uniform(-spread_m, spread_m)
        north_m = centre_m[1] + rng.uniform(-spread_m, spread_m)
        if depth_m(truth.boundary_m, (east_m, north_m)) < 15.0 and spread_m < 2_000.0:
            continue
        least_m = apart_m if spread_m < 300.0 else 5.0
        if all(hypot(east_m - h[0], north_m - h[1]) >= least_m for h in homes):
            homes.append((east_m, north_m, truth.ground.height_m(east_m, north_m)))
    return homes


def somewhere(rng: Random, truth: TrueSite, inside_m: float) -> EastNorth:
    """Return a place so far inside the boundary and outside every zone, where there is one."""
    east, north = zip(*truth.boundary_m, strict=True)
    place = (0.0, 0.0)
    for _ in range(40):
        place = rng.uniform(min(east), max(east)), rng.uniform(min(north), max(north))
        if depth_m(truth.boundary_m, place) >= inside_m and all(
            depth_m(zone.corners_m, place) < -inside_m / 2.0 for zone in truth.zones
        ):
            return place
    return place


def _zones(rng: Random, truth: TrueSite, homes: list[tuple[float, float, float]]) -> list[TrueZone]:
    zones: list[TrueZone] = []
    for number in range(rng.randint(0, 4)):
        corners = _star(rng, somewhere(rng, truth, 0.0), rng.uniform(12.0, 60.0))
        if any(depth_m(corners, home[:2]) > -15.0 for home in homes):
            continue
        is_keep_out = rng.random() < 0.6
        floor_m = rng.uniform(8.0, 35.0) if rng.random() < 0.4 else None
        ceiling_m = rng.uniform(40.0, 90.0) if rng.random() < 0.4 else None
        if not is_keep_out and floor_m is None and ceiling_m is None:
            ceiling_m = 50.0
        over_ground = rng.random() < 0.6
        zones.append(
            TrueZone(f"zone {number}", corners, is_keep_out, floor_m, ceiling_m, over_ground)
        )
    return zones


def _profile(
    rng: Random, serial: str, pad: GeoPoint, truth: TrueSite, number: int
) -> VehicleProfile:
    is_layered = rng.random() < 0.8
    room_m = truth.most_height_m - 25.0
    layer_m = 20.0 + ((truth.apart_up_m + 3.0) * number) % max(8.0, room_m)
    return VehicleProfile(
        serial,
        waypoint_altitude=rng.choice((AltitudeReference.TAKEOFF, AltitudeReference.WGS84)),
        pad=pad,
        endurance_s=rng.choice((500.0, 900.0, 1_500.0, 1_500.0)),
        go_home_height_m=layer_m if is_layered else rng.uniform(20.0, truth.most_height_m - 5.0),
        failsafe=rng.choice((Failsafe.GO_HOME, Failsafe.GO_HOME, Failsafe.HOVER, Failsafe.LAND)),
        camera_interval_s=2.0,
        priority=rng.randint(0, 2),
        packet_gap_s=rng.choice((0.1, 0.1, 0.25)),
        max_waypoints=rng.choice((99, 99, 5)),
    )


def _faults(rng: Random, serials: list[str], seconds: float) -> list[InjectedFault]:
    kinds = list(FAULTS)
    found = []
    for _ in range(rng.randint(1, 2 + len(serials))):
        kind = rng.choice(kinds)
        start_s, duration_s = rng.uniform(5.0, seconds), rng.uniform(*FAULTS[kind])
        found.append(InjectedFault(kind, rng.choice(serials), start_s, duration_s))
    return found


def _apps(
    rng: Random,
    seed: int,
    pads: Mapping[str, GeoPoint],
    profiles: Mapping[str, VehicleProfile],
    faults: tuple[InjectedFault, ...],
    drift: DriftSettings,
) -> list[SimulatedApp]:
    wind_mps = rng.choice((0.0, 0.0, 3.0, 6.0))
    wind = WindSettings(seed, wind_mps, rng.uniform(0.0, 360.0)) if wind_mps else None
    heights = {s: p.go_home_height_m for s, p in profiles.items() if p.go_home_height_m}
    apps: dict[str, SimulatedApp] = {}
    for serial, profile in profiles.items():
        config = SimulationConfig(
            home=ORIGIN,
            vehicle_count=len(pads),
            altitude_reference=profile.waypoint_altitude,
            hover_on_ground=rng.choice(list(HoverOnGround)),
            airborne=Airborne.NONE,
            endurance_s=profile.endurance_s or 1_500.0,
            drift=drift,
            wind=wind,
            reports_mission_id=rng.random() < 0.9,
            seed=seed,
            faults=faults,
            pads=pads,
            go_home_heights_m=heights,
        )
        built = build_fleet(config, 0)
        apps[serial] = next(app for app in built if app.settings.serial == serial)
    return list(apps.values())


def _lift(
    rng: Random,
    truth: TrueSite,
    apps: list[SimulatedApp],
    homes_m: Mapping[str, tuple[float, float, float]],
) -> None:
    """Start vehicles in the air: well apart, within all limits."""
    lowest_m, highest_m = truth.least_height_m + 8.0, truth.most_height_m - 10.0
    taken: list[tuple[float, float, float]] = []
    for app in apps:
        home = homes_m[app.settings.serial]
        east_m, north_m = somewhere(rng, truth, 20.0)
        up_m = truth.ground.height_m(east_m, north_m) + rng.uniform(lowest_m, highest_m)
        is_near = hypot(east_m - home[0], north_m - home[1]) < truth.most_distance_m - 40.0
        is_clear = all(
            hypot(east_m - t[0], north_m - t[1]) > truth.apart_level_m + 25.0 for t in taken
        )
        is_in = depth_m(truth.boundary_m, (east_m, north_m)) > 15.0 and all(
            depth_m(zone.corners_m, (east_m, north_m)) < -12.0 for zone in truth.zones
        )
        if not (is_near and is_clear and is_in) or rng.random() < 0.15:
            continue
        taken.append((east_m, north_m, up_m))
        aircraft = app.aircraft
        aircraft.motion = aircraft.motion._replace(
            east_m=east_m - home[0], north_m=north_m - home[1], height_m=max(5.0, up_m - home[2])
        )
        aircraft.active_mode = PositionHold()


def _site(truth: TrueSite, profiles: Mapping[str, VehicleProfile]) -> Site:
    limits = FlightLimits(
        max_height_above_ground_m=truth.most_height_m,
        min_height_above_ground_m=truth.least_height_m,
        max_distance_from_home_m=truth.most_distance_m,
        min_separation_horizontal_m=truth.apart_level_m,
        min_separation_vertical_m=truth.apart_up_m,
    )
    boundary = Region(np.array(truth.boundary_m))
    return Site(
        name="closed loop",
        frame=FRAME,
        profiles=profiles,
        layers=Layers(boundary=boundary, zones=tuple(_zone(zone) for zone in truth.zones)),
        limits=limits,
        elevation=None if truth.ground.is_flat else _elevation(truth.ground),
    )


def _zone(zone: TrueZone) -> Zone:
    has_heights = zone.floor_m is not None or zone.ceiling_m is not None
    raised_m = 0.0 if zone.over_ground else ORIGIN.ellipsoid_height_m
    return Zone(
        zone.name,
        ZoneKind.KEEP_OUT if zone.is_keep_out else ZoneKind.HEIGHT,
        Region(np.array(zone.corners_m)),
        None if zone.floor_m is None else zone.floor_m + raised_m,
        None if zone.ceiling_m is None else zone.ceiling_m + raised_m,
        (HeightDatum.GROUND if zone.over_ground else HeightDatum.WGS84) if has_heights else None,
    )


def _elevation(ground: TrueGround) -> ElevationModel:
    cells = round(2.0 * HALF_M / CELL_M)
    middles_m = -HALF_M + CELL_M * (np.arange(cells) + 0.5)
    heights_m = np.array(
        [[ground.height_m(east_m, north_m) for east_m in middles_m] for north_m in middles_m[::-1]]
    )
    grid = GroundGrid(FRAME, -HALF_M, HALF_M, CELL_M, cells, cells)
    return ElevationModel(grid, heights_m + ORIGIN.ellipsoid_height_m)


def degrees(east_m: float, north_m: float) -> LatLon:
    """Return the position of a place of the site."""
    point = point_from_enu(FRAME, (east_m, north_m, 0.0))
    return LatLon(point.latitude_deg, point.longitude_deg)
