"""What a look of all watchdogs costs with 64 vehicles, and what judging separation does.

The baseline, in the same run, asks each pair at each moment automatically, in plain Python. The
ratio to it is asserted; the budget of 5 ms a look on one core is reported. All times are the
processor's, so that what else runs on the machine does not count.

    python -m benches.safety.bench_watchdogs
"""

import sys
from collections.abc import Callable
from itertools import combinations
from math import hypot
from random import Random
from time import process_time

import numpy as np

from recon.geo.distance import moved_m
from recon.model.airspace import Airspace, HeightDatum, Region, Zone, ZoneKind
from recon.model.command import Body, Command, FlyMission, StickFrame, VirtualStick
from recon.model.control import Commanded, Intent
from recon.model.geo import GeoPoint, LatLon, LocalFrame
from recon.model.mission import Mission, Waypoint
from recon.model.units import Stamped
from recon.model.vehicle import FlightMode, VehicleProfile, VehicleState, VelocityNed
from recon.safety import ClaimingLink, PreparedAirspace, SafetySettings, Situation, Traffic
from recon.safety.prediction.trajectory import Samples
from recon.safety.rules.separation import separation as rule
from recon.safety.watchdogs import WATCHDOGS, TrafficPicture, WatchedVehicle, build_traffic_picture
from recon.safety.watchdogs.closest_approach import closeness, near_pairs
from recon.station.kernel.driver import freeze_loaded_objects

VEHICLES = 64
ZONES = 20
LINES = 49
LINE_M, APART_M, BLOCK_M = 110.0, 5.0, 300.0
SPEED_MPS = 8.0
LOOKS = 600
BUDGET_MS = 5.0
LEAST_RATIO = 20.0

S = 1_000_000_000
NOW = 1_000 * S
ORIGIN = GeoPoint(42.0, -93.6, 275.0)
SETTINGS = SafetySettings()


def place(north_m: float, east_m: float) -> LatLon:
    return moved_m(LatLon(ORIGIN.latitude_deg, ORIGIN.longitude_deg), north_m, east_m)


def survey(number: int) -> Mission:
    """99 waypoints over a block of one's own: 49 lines, 5 m apart."""
    north_m, east_m = (number // 8) * BLOCK_M, (number % 8) * BLOCK_M
    ends = [
        place(north_m + APART_M * line, east_m + LINE_M * ((line + end) % 2))
        for line in range(LINES + 1)
        for end in range(2)
    ]
    points = (Waypoint(p.latitude_deg, p.longitude_deg, 40.0, SPEED_MPS) for p in ends[:99])
    return Mission(tuple(points))


def vehicle(serial: str, at: LatLon, velocity: VelocityNed, home: LatLon) -> VehicleState:
    at_ns = NOW - S // 20
    return VehicleState(
        serial,
        link_id=1,
        profile=VehicleProfile(serial, endurance_s=1_500.0, go_home_height_m=60.0),
        is_flying=Stamped(True, at_ns),
        position=Stamped(at, at_ns),
        height_above_takeoff_m=Stamped(40.0, at_ns),
        velocity_ned=Stamped(velocity, at_ns),
        battery_fraction=Stamped(0.8, at_ns),
        flight_mode=Stamped(FlightMode.GPS_WAYPOINT, at_ns),
        core_received_at_ns=at_ns,
        takeoff_point=home,
    )


def fleet(rng: Random) -> list[WatchedVehicle]:
    """Vehicles somewhere on their surveys; every eighth on its way into the one before."""
    found = []
    for number in range(VEHICLES):
        mission = survey(number)
        passed = rng.randrange(2, 98) // 2 * 2 + 1
        start, end = mission.waypoints[passed - 1 : passed + 1]
        share = rng.random()
        at = LatLon(
            start.latitude_deg + share * (end.latitude_deg - start.latitude_deg),
            start.longitude_deg + share * (end.longitude_deg - start.longitude_deg),
        )
        east_mps = SPEED_MPS if end.longitude_deg > start.longitude_deg else -SPEED_MPS
        home = place((number // 8) * BLOCK_M, (number % 8) * BLOCK_M)
        intent = Intent(Commanded.MISSION, mission=mission, passed=passed)
        if number % 8 == 7:
            at, east_mps, intent = (
                moved_m(found[-1].state.position.value, 0.0, 130.0),
                -15.0,
                Intent(),
            )
        state = vehicle(f"V{number:02d}", at, VelocityNed(0.0, east_mps, 0.0), home)
        found.append(WatchedVehicle(state, intent))
    return found


def airspace(rng: Random) -> PreparedAirspace:
    zones = tuple(
        Zone(
            f"zone {number}",
            ZoneKind.KEEP_OUT,
            square(rng.uniform(0.0, 2_400.0), rng.uniform(0.0, 2_400.0), 15.0),
            0.0,
            30.0,
            HeightDatum.GROUND,
        )
        for number in range(ZONES)
    )
    boundary = square(1_200.0, 1_200.0, 2_000.0)
    return PreparedAirspace(Airspace(frame=LocalFrame(ORIGIN), boundary=boundary, zones=zones))


def square(east_m: float, north_m: float, half_m: float) -> Region:
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return Region(np.array([(east_m + e * half_m, north_m + n * half_m) for e, n in corners]))


def timed_ms(work: Callable[[], object], times: int) -> np.ndarray:
    found = []
    for _ in range(times):
        begin_s = process_time()
        work()
        found.append(1e3 * (process_time() - begin_s))
    return np.array(found)


def naive(picture: TrafficPicture) -> int:
    """How many pairs come too near, asked one by one."""
    flies, need, count = (
        picture.ahead.as_it_flies,
        picture.minima,
        0,
    )
    tracks = [_track(flies, number) for number in range(len(picture.flying))]
    for one, other in combinations(tracks, 2):
        count += any(
            hypot(a[0] - b[0], a[1] - b[1]) < need.horizontal_m
            and abs(a[2] - b[2]) < need.vertical_m
            for a, b in zip(one, other, strict=True)
        )
    return count


def _track(flies: Samples, number: int) -> list[tuple[float, float, float]]:
    columns = (flies.east_m[number], flies.north_m[number], flies.low_m[number])
    return list(zip(*(column.tolist() for column in columns), strict=True))


def vectorised(picture: TrafficPicture) -> int:
    flies, need = (
        picture.ahead.as_it_flies,
        picture.minima,
    )
    first, second = near_pairs(flies, need)
    return int((closeness(flies, first, flies, second, need)[0] < 1.0).any(axis=1).sum())


def judge_ms(air: PreparedAirspace, watched: list[WatchedVehicle], body: Body, times: int) -> float:
    own, others = watched[0], watched[1:]
    traffic = tuple(Traffic(one.state, one.intent) for one in others)
    claiming_links = (ClaimingLink(1, own.state.is_flying),)
    situation = Situation(NOW, own.state, claiming_links, airspace=air, traffic=traffic)
    command = Command(1, body, "bench", NOW, NOW + 5 * S, serial=own.state.serial)
    return float(np.median(timed_ms(lambda: rule(command, situation), times)))


def main() -> int:
    freeze_loaded_objects()
    rng = Random(7)
    air, watched = airspace(rng), fleet(rng)

    def take() -> TrafficPicture:
        return build_traffic_picture(watched, air, SETTINGS, NOW, {})

    def look() -> int:
        picture = take()
        return sum(1 for watchdog in WATCHDOGS for _ in watchdog(picture))

    findings, picture = look(), take()
    looks_ms = timed_ms(look, LOOKS)
    parts = {w.__name__: timed_ms(lambda w=w: list(w(picture)), 100) for w in WATCHDOGS}
    naive_ms = float(np.median(timed_ms(lambda: naive(picture), 5)))
    pairs_ms = float(np.median(timed_ms(lambda: vectorised(picture), 200)))
    same = naive(picture) == vectorised(picture)
    ratio = naive_ms / pairs_ms
    mean_ms, p99_ms = float(looks_ms.mean()), float(np.quantile(looks_ms, 0.99))
    mission_ms = judge_ms(air, watched, FlyMission(survey(0)), 15)
    stick = VirtualStick(StickFrame.GROUND, 0.0, 5.0, 0.0, 40.0, 1.0)
    print(
        f"a look at {VEHICLES} vehicles, {len(WATCHDOGS)} watchdogs, {ZONES} zones: mean "
        f"{mean_ms:.2f} ms, median {float(np.median(looks_ms)):.2f} ms, p99 {p99_ms:.2f} ms "
        f"({findings} findings); budget {BUDGET_MS:g} ms: "
        f"{'kept' if mean_ms < BUDGET_MS else 'MISSED'}\n"
        f"  of it the picture {float(np.median(timed_ms(take, 100))):.2f} ms, "
        + ", ".join(f"{name} {float(np.median(ms)):.2f}" for name, ms in parts.items())
        + f"\nall pairs: {pairs_ms:.3f} ms; one by one {naive_ms:.1f} ms, {ratio:.0f} times as long"
        f" (the same pairs found: {same})\n"
        f"judging separation among {VEHICLES - 1} missions of 99 waypoints: a mission of 99 "
        f"{mission_ms:.1f} ms, a stick {judge_ms(air, watched, stick, 200):.2f} ms"
    )
    if not same or ratio < LEAST_RATIO:
        print(f"expected the same pairs, and {LEAST_RATIO:g} times faster at least")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
