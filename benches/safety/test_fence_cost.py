"""What the rules about places and heights cost: a stick packet, and a long mission among zones.

python -m pytest benches/safety -p no:cacheprovider -s

The naive loop beside them walks flights and routes home in steps of 16 m in plain Python and asks
every edge of the boundary: a rougher answer to one question of many.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, inf
from time import process_time

import numpy as np
import pytest

from recon.geo import geo_from_enu
from recon.model.airspace import (
    Airspace,
    ElevationModel,
    FlightLimits,
    HeightDatum,
    Region,
    Zone,
    ZoneKind,
)
from recon.model.command import Body, Command, FlyMission, StickFrame, VirtualStick
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, VehicleProfile, VehicleState
from recon.safety import ClaimingLink, PreparedAirspace, Situation
from recon.safety.path.pieces import Kind, PathVolume
from recon.safety.path.volumes import path_volume
from recon.safety.rules.boundary import boundary
from recon.safety.rules.height_zones import height_zones
from recon.safety.rules.home_distance import home_distance
from recon.safety.rules.keep_out import keep_out
from recon.safety.rules.max_height import max_height
from recon.safety.rules.min_height import min_height
from recon.safety.rules.speed import speed

RULES = (speed, home_distance, boundary, keep_out, height_zones, min_height, max_height)
FRAME = LocalFrame(GeoPoint(42.0, -93.6, 270.0))
NOW = 10**9
ROUNDS = 9
STEP_M = 16.0

L_SHAPE = [(-40.0, -40.0), (900.0, -40.0), (900.0, 400.0), (400.0, 400.0), (400.0, 900.0),
           (-40.0, 900.0)]  # fmt: skip


@dataclass(frozen=True)
class Case:
    """One order and the air it is judged in."""

    name: str
    command: Command
    situation: Situation

    def judge(self) -> None:
        """Ask all the rules, as for a new order: nothing is remembered from the last time."""
        situation = Situation(
            self.situation.now_ns,
            self.situation.vehicle,
            self.situation.claiming_links,
            airspace=self.situation.airspace,
        )
        for rule in RULES:
            refusal = rule(self.command, situation)
            assert refusal is None, refusal


def place(east_m: float, north_m: float) -> LatLon:
    latitude, longitude, _ = geo_from_enu(FRAME, (east_m, north_m, 0.0))
    return LatLon(float(latitude[0]), float(longitude[0]))


def air(*, hilly: bool) -> PreparedAirspace:
    """An L-shaped site of 0.66 km2 with 20 zones along its fields' edges."""
    zones = tuple(zone(number) for number in range(20))
    model = None
    if hilly:
        random = np.random.default_rng(3)
        heights = 270.0 + np.cumsum(np.cumsum(random.normal(0.0, 0.004, (1100, 1100)), 0), 1) * 0.05
        model = ElevationModel(GroundGrid(FRAME, -100.0, 1000.0, 1.0, 1100, 1100), heights)
    limits = FlightLimits(max_distance_from_home_m=2_000.0)
    return PreparedAirspace(Airspace(limits, FRAME, Region(np.array(L_SHAPE)), zones, (), model))


def zone(number: int) -> Zone:
    """Half are keep-out zones with a ceiling under the flights, half height zones; 12 corners."""
    centre = np.array([30.0 + 42.0 * number, 180.0 + 90.0 * (number % 2)])
    angles = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    outline = centre + 18.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if number % 2:
        return Zone(f"yard {number}", ZoneKind.KEEP_OUT, Region(outline), None, 25.0,
                    HeightDatum.GROUND)  # fmt: skip
    return Zone(f"farm {number}", ZoneKind.HEIGHT, Region(outline), 15.0, 115.0, HeightDatum.GROUND)


def vehicle() -> VehicleState:
    profile = VehicleProfile("A", go_home_height_m=60.0, failsafe=Failsafe.GO_HOME)
    return VehicleState(
        serial="A",
        link_id=1,
        profile=profile,
        is_flying=Stamped(True, NOW),
        position=Stamped(place(20.0, 20.0), NOW),
        height_above_takeoff_m=Stamped(45.0, NOW),
        takeoff_point=place(0.0, 0.0),
    )


def case(name: str, body: Body, *, hilly: bool) -> Case:
    state = vehicle()
    order = Command(1, body, "bench", NOW, NOW + 10**9, serial="A")
    situation = Situation(
        NOW, state, (ClaimingLink(1, state.is_flying),), airspace=air(hilly=hilly)
    )
    return Case(name, order, situation)


def survey() -> FlyMission:
    """99 waypoints, rows of 380 m 16 m apart up the west arm, with rounded turns."""
    points = []
    for row in range(50):
        ends = (10.0, 370.0) if row % 2 == 0 else (370.0, 10.0)
        points += [(east_m, 16.0 * row + 5.0) for east_m in ends]
    waypoints = []
    for number, (east_m, north_m) in enumerate(points[:99]):
        at = place(east_m, north_m)
        radius_m = 7.0 if 0 < number < 98 else 0.2
        waypoints.append(Waypoint(at.latitude_deg, at.longitude_deg, 45.0, 8.0, radius_m))
    return FlyMission(Mission(tuple(waypoints), curved=True))


STICK = VirtualStick(StickFrame.GROUND, 0.0, 4.0, 3.0, 45.0, 1.0)
BODY_STICK = VirtualStick(StickFrame.BODY, 90.0, 4.0, 3.0, 45.0, 1.0)


def cost_ms(work: Callable[[], object], times: int) -> float:
    """What one call takes of a core: the least over rounds, for others disturb it only upwards."""
    found = []
    for _ in range(ROUNDS):
        begin_s = process_time()
        for _ in range(times):
            work()
        found.append(1e3 * (process_time() - begin_s) / times)
    return min(found)


@pytest.mark.parametrize("hilly", [False, True], ids=["flat", "hills of 1.2 million cells"])
def test_a_stick_packet(hilly: bool) -> None:
    for name, body in (("stick", STICK), ("turning stick", BODY_STICK)):
        asked = case(name, body, hilly=hilly)
        took_ms = cost_ms(asked.judge, 200)
        print(f"\n{name}: {1e3 * took_ms:.0f} us by {len(RULES)} rules, 20 zones")
        assert took_ms < 1.0


@pytest.mark.parametrize("hilly", [False, True], ids=["flat", "hills of 1.2 million cells"])
def test_a_long_curved_mission(hilly: bool) -> None:
    asked = case("mission", survey(), hilly=hilly)
    took_ms = cost_ms(asked.judge, 3)
    path = path_volume(asked.command, asked.situation)
    assert isinstance(path, PathVolume)
    begin_s = process_time()
    assert naive_room_m(path) > 5.0
    naive_ms = 1e3 * (process_time() - begin_s)
    print(
        f"\nmission of 99 waypoints, {len(path.pieces)} pieces: {took_ms:.1f} ms by all rules; "
        f"its boundary alone by a naive loop: {naive_ms:.0f} ms, {naive_ms / took_ms:.0f} times it"
    )
    assert took_ms < 50.0


def naive_room_m(path: PathVolume) -> float:
    """How near the path comes to the boundary: flights and routes home in steps, edge by edge."""
    edges = list(zip(L_SHAPE, [*L_SHAPE[1:], L_SHAPE[0]], strict=True))
    home_east_m, home_north_m = float(path.home_m[0]), float(path.home_m[1])
    nearest_m = inf
    for index in np.flatnonzero(path.of_kinds(Kind.FLIGHT)):
        (ae, an), (be, bn), _ = path.pieces.triangles_m[index].tolist()
        steps = max(1, int(hypot(be - ae, bn - an) / STEP_M))
        for step in range(steps + 1):
            east_m, north_m = ae + (be - ae) * step / steps, an + (bn - an) * step / steps
            back_steps = max(1, int(hypot(east_m - home_east_m, north_m - home_north_m) / STEP_M))
            for back in range(back_steps + 1):
                share = back / back_steps
                e = east_m + (home_east_m - east_m) * share
                n = north_m + (home_north_m - north_m) * share
                nearest_m = min(nearest_m, *(distance_m(e, n, *edge) for edge in edges))
    return nearest_m


def distance_m(
    east_m: float, north_m: float, start: tuple[float, float], end: tuple[float, float]
) -> float:
    de, dn = end[0] - start[0], end[1] - start[1]
    share = ((east_m - start[0]) * de + (north_m - start[1]) * dn) / (de * de + dn * dn)
    share = min(1.0, max(0.0, share))
    return hypot(east_m - start[0] - share * de, north_m - start[1] - share * dn)
