"""Canonical refusals of every rule, compared whole.

A line of `EXPECTED` has the rule, its sentence, the parameters that programs read, and *stale* where only
old telemetry is the cause.
"""

from dataclasses import replace
from math import nan
from numbers import Real

from tests.safety.cases import (
    AIRSPACE,
    NOW,
    STICK,
    WGS84,
    S,
    command,
    situation,
    vehicle,
    waypoint,
)
from tests.safety.cases import mission as northward
from tests.safety.fenced import (
    WIDE,
    airspace,
    flier,
    goto,
    height_zone,
    here,
    keep_out_zone,
    mission,
    square,
    stick,
)
from tests.safety.traffic import AIR, aircraft, at

from recon.model.command import Body, Command, GoTo, Hover, Nudge, StartCamera
from recon.model.control import AuthorityHolder, ControlAuthority, OperatorLease, StopLatch
from recon.model.geo import LatLon
from recon.model.units import Stamped
from recon.model.vehicle import BatteryWarning, FlightMode, VehicleState
from recon.safety import ClaimingLink, PreparedAirspace, Situation, Traffic
from recon.safety.rules import RULES

RULES_BY_NAME = {rule.__name__: rule for rule in RULES}
FAR = mission((0.0, 50.0, 40.0), (300.0, 50.0, 40.0))
HERE = here(AIRSPACE)
YARD = square(100.0, 0.0, 200.0, 100.0)
FENCED = airspace(boundary=square(-100.0, -100.0, 100.0, 100.0))


Case = tuple[str, Command, Situation]


def case(rule: str, order: Body | Command, where: Situation) -> Case:
    return rule, order if isinstance(order, Command) else command(order), where


def limited(state: VehicleState | None = None, **changes: float) -> Situation:
    return here(airspace(limits=replace(WIDE, **changes)), state)


def corners(*radii_m: float) -> Body:
    points = (waypoint(20.0 * n, corner_radius_m=r) for n, r in enumerate(radii_m))
    return northward(*points, curved=True)


def among(*others: VehicleState, air: PreparedAirspace = AIR) -> Situation:
    own = aircraft("A")
    traffic = tuple(Traffic(other) for other in others)
    return Situation(NOW, own, (ClaimingLink(1, own.is_flying),), airspace=air, traffic=traffic)


ORDERS = [
    case("known_order", replace(command(FAR), body="loop"), HERE),  # type: ignore[arg-type]
    case("reachable", FAR, replace(HERE, vehicle=None)),
    case("reachable", FAR, replace(HERE, claiming_links=())),
    case("identified", FAR, situation(None, Stamped(True, NOW))),
    case("not_expired", replace(command(FAR), expires_at_ns=NOW - S), HERE),
    case("stop_latch", command(FAR), replace(HERE, stop_latch=StopLatch("Ann", NOW - 3 * S))),
    case("finite_numbers", goto(0.0, 0.0, nan), HERE),
    case(
        "operator_lease",
        replace(command(northward()), person="bea"),
        replace(HERE, lease=OperatorLease("ann", NOW - 90 * S, NOW)),
    ),
    case(
        "authority",
        FAR,
        replace(HERE, authority=ControlAuthority(AuthorityHolder.PILOT, reason="taken over")),
    ),
]

DJI_NUMBERS = [
    case("dji_limits", GoTo(LatLon(42.0, -93.6), -1.0, 5.0), HERE),
    case("dji_limits", GoTo(LatLon(91.0, -181.0), 40.0, 5.0), HERE),
    case("dji_limits", goto(0.0, 0.0, speed_mps=16.0), HERE),
    case("dji_limits", StartCamera(31.0), HERE),
    case("dji_limits", Nudge(101.0, 0.0, 0.0), HERE),
    case("dji_limits", Nudge(0.0, 101.0, 0.0), HERE),
    case("dji_limits", Nudge(0.0, 0.0, -101.0), HERE),
    case("dji_limits", replace(STICK, velocity_x_mps=16.0), HERE),
    case("dji_limits", replace(STICK, velocity_y_mps=-16.0), HERE),
    case("dji_limits", Nudge(1.0, 0.0, 0.0, 16.0), HERE),
    case("dji_limits", replace(STICK, height_above_takeoff_m=501.0), HERE),
    case("dji_limits", replace(STICK, timeout_s=6.0), HERE),
]

DJI_MISSIONS = [
    case("dji_limits", mission((0.0, 50.0, 40.0)), HERE),
    case("dji_limits", northward(waypoint(0.0), waypoint(50.0, latitude_deg=91.0)), HERE),
    case(
        "dji_limits", northward(waypoint(0.0), waypoint(50.0, height_above_takeoff_m=501.0)), HERE
    ),
    case("dji_limits", northward(waypoint(0.0, speed_mps=0.0), waypoint(50.0)), HERE),
    case("dji_limits", northward(waypoint(0.0, loiter_s=-1.0), waypoint(50.0)), HERE),
    case("dji_limits", northward(waypoint(0.0, gimbal_pitch_deg=-100.0), waypoint(50.0)), HERE),
    case(
        "dji_limits",
        northward(waypoint(0.0, gimbal_pitch_deg=-10.0), waypoint(50.0), curved=True),
        HERE,
    ),
    case(
        "dji_limits",
        northward(waypoint(50.0), waypoint(0.0), waypoint(0.0, height_above_takeoff_m=40.25)),
        HERE,
    ),
    case(
        "dji_limits",
        northward(waypoint(0.0), waypoint(50.0), waypoint(0.0, height_above_takeoff_m=40.25)),
        HERE,
    ),
    case("dji_limits", northward(*(waypoint(1900.0 * (n % 2) + n) for n in range(18))), HERE),
    case("dji_limits", corners(1.0, 5.0, 0.2), HERE),
    case("dji_limits", corners(0.2, 5.0, 0.3), HERE),
    case("dji_limits", corners(0.2, 1000.1, 0.2), HERE),
    case("dji_limits", corners(0.2, 15.0, 15.0, 0.2), HERE),
]

TELEMETRY = [
    case("altitude_reference", FAR, situation(vehicle(WGS84, offset_m=None))),
    case(
        "altitude_reference",
        FAR,
        situation(vehicle(WGS84, altitude_offset_m=Stamped(260.0, NOW - 4 * S))),
    ),
    case("altitude_reference", FAR, situation(vehicle(WGS84, offset_m=12_001.0))),
    case("altitude_reference", FAR, situation(vehicle(WGS84, offset_m=257.0))),
    case("flying", Hover(), situation(vehicle(age_s=3.5))),
    case("flying", Hover(), situation(vehicle(flying=False, age_s=3.5))),
    case("link_age", FAR, situation(vehicle(core_received_at_ns=NOW - 2 * S))),
    case("link_age", FAR, situation(vehicle(extended_received_at_ns=NOW - 4 * S))),
    case("gnss", FAR, situation(vehicle(position=Stamped()))),
    case("gnss", FAR, situation(vehicle(gnss_satellite_count=None))),
    case("gnss", FAR, situation(vehicle(flight_mode=None))),
    case("gnss", FAR, situation(vehicle(flight_mode=FlightMode.ATTI))),
    case("gnss", FAR, situation(vehicle(gnss_satellite_count=7))),
    case("gnss", FAR, situation(vehicle(gnss_signal_level=None))),
    case("gnss", FAR, situation(vehicle(gnss_signal_level=1))),
    case("gnss", FAR, situation(vehicle(gnss_signal_level=3, flying=False))),
    case("battery", FAR, here(airspace(), flier(battery_warning=BatteryWarning.SERIOUS))),
    case("battery", FAR, here(airspace(), flier(battery_warning=BatteryWarning.LOW))),
    case("battery", FAR, here(airspace(), flier(battery_warning=None))),
    case("battery", FAR, here(airspace(), flier(battery_fraction=0.3))),
    case("battery", goto(0.0, 0.0), here(airspace(), flier(300.0, battery_fraction=0.02))),
    case("preflight", FAR, here(AIRSPACE, flier(go_home_m=None))),
]

PLACES = [
    case("speed", FAR, limited(max_speed_mps=4.0)),
    case("home_distance", FAR, limited(max_distance_from_home_m=100.0)),
    case("boundary", FAR, here(FENCED)),
    case("boundary", goto(95.0, 0.0), here(FENCED)),
    case("boundary", goto(110.0, 0.0), here(FENCED, flier(105.0))),
    case("keep_out", FAR, here(airspace(keep_out_zone(YARD)))),
    case(
        "keep_out",
        goto(94.0, 50.0),
        here(airspace(keep_out_zone(YARD, ceiling_m=60.0)), flier(0.0, 50.0)),
    ),
    case("height_zones", FAR, here(airspace(height_zone(YARD, floor_m=50.0, ceiling_m=60.0)))),
    case("height_zones", FAR, here(airspace(height_zone(YARD, ceiling_m=30.0)))),
    case("min_height", FAR, limited(min_height_above_ground_m=45.0)),
    case("max_height", FAR, limited(max_height_above_ground_m=30.0)),
    case(
        "max_height",
        stick(0.0, 0.0, 60.0),
        limited(flier(height_m=59.0, position=Stamped()), max_height_above_ground_m=30.0),
    ),
    case("separation", GoTo(at(0.0, 300.0), 40.0, 5.0), among(aircraft("B", place=None))),
    case("separation", GoTo(at(0.0, 300.0), 40.0, 5.0), among(aircraft("B", (10.0, 150.0), 44.0))),
    case(
        "separation",
        GoTo(at(0.0, 300.0), 40.0, 5.0),
        among(
            aircraft("B", (10.0, 150.0), 44.0),
            air=airspace(
                limits=replace(
                    WIDE, min_separation_horizontal_m=20.26, min_separation_vertical_m=5.26
                )
            ),
        ),
    ),
    case(
        "separation",
        GoTo(at(0.0, 300.0), 40.0, 5.0),
        among(aircraft("B", (0.0, 250.0), home=(0.0, 250.0), age_s=20.0)),
    ),
]

CASES = (*ORDERS, *DJI_NUMBERS, *DJI_MISSIONS, *TELEMETRY, *PLACES)

EXPECTED = """
known_order | Order type str is unknown; known types: hover, land, return_home, camera_start, camera_stop, camera_lock, mission, stick, goto, nudge, hold_position, follow_path
reachable | A is unknown: no app has reported this serial
reachable | A is not connected: its companion app must connect first |  | stale
identified | A: links 1 and 2 claim this serial; only hold, land and return without takeoff are sent until one of them closes or becomes silent
not_expired | Order expired 1.0 s ago; give it again if still wanted | late_s=1, max_s=0
stop_latch | A: stopped by the all stop of Ann 3 s ago; release its stop first. Hold, land and return home are always accepted | age_s=3, by=Ann
finite_numbers | height_above_takeoff_m must be a finite number; got nan | field=height_above_takeoff_m, value=nan
operator_lease | A is operated by ann, since 90 s ago; ask ann, or take it over (console: Take over; shell: recon take --take-over). Hold, land and return home are always accepted | person=ann, age_s=90
authority | A is controlled by pilot (taken over), and the order comes from operator: ask the pilot, then take control
dji_limits | Height must be 0 to 500 m above takeoff; got -1 m | height_above_takeoff_m=-1, min_m=0, max_m=500
dji_limits | Target must be within 90 deg latitude and 180 deg longitude; got 91, -181 | latitude_deg=91, longitude_deg=-181, max_latitude_deg=90, max_longitude_deg=180
dji_limits | Speed must be 0.1 to 15 m/s; got 16 m/s | speed_mps=16, min_mps=0.1, max_mps=15
dji_limits | Frame rate must be above 0 and at most 30 Hz; got 31 Hz | frame_rate_hz=31, min_hz=0, max_hz=30
dji_limits | Nudge north must be -100 to 100 m; got 101 m; use a goto for larger distances | north_m=101, min_m=-100, max_m=100
dji_limits | Nudge east must be -100 to 100 m; got 101 m; use a goto for larger distances | east_m=101, min_m=-100, max_m=100
dji_limits | Nudge up must be -100 to 100 m; got -101 m; use a goto for larger distances | up_m=-101, min_m=-100, max_m=100
dji_limits | Stick velocity x must be -15 to 15 m/s; got 16 m/s | velocity_x_mps=16, min_mps=-15, max_mps=15
dji_limits | Stick velocity y must be -15 to 15 m/s; got -16 m/s | velocity_y_mps=-16, min_mps=-15, max_mps=15
dji_limits | Speed must be 0.1 to 15 m/s; got 16 m/s | speed_mps=16, min_mps=0.1, max_mps=15
dji_limits | Height must be 0 to 500 m above takeoff; got 501 m | height_above_takeoff_m=501, min_m=0, max_m=500
dji_limits | Stick timeout must be above 0 and at most 5 s, the time for which the app keeps flying it without a new stick; got 6 s | timeout_s=6, min_s=0, max_s=5
dji_limits | Mission must have 2 to 99 waypoints for this vehicle's app; got 1 | waypoint_count=1, min_count=2, max_count=99
dji_limits | Waypoint 2: position must be within 90 deg latitude and 180 deg longitude; got 91, -93.6 | waypoint=2, latitude_deg=91, longitude_deg=-93.6, max_latitude_deg=90, max_longitude_deg=180
dji_limits | Waypoint 2: height must be -200 to 500 m above takeoff; got 501 m | waypoint=2, height_above_takeoff_m=501, min_m=-200, max_m=500
dji_limits | Waypoint 1: speed must be above 0 and at most 15 m/s; got 0 m/s | waypoint=1, speed_mps=0, min_mps=0, max_mps=15
dji_limits | Waypoint 1: loiter must be 0 to 32.767 s; got -1 s | waypoint=1, loiter_s=-1, min_s=0, max_s=32.767
dji_limits | Waypoint 1: gimbal pitch must be -90 to 0 deg; got -100 deg | waypoint=1, gimbal_pitch_deg=-100, min_deg=-90, max_deg=0
dji_limits | Waypoint 1: a curved mission cannot have loiter or gimbal actions: the SDK ignores them | waypoint=1
dji_limits | Waypoints 2 and 3 must be 0.5 to 2000 m apart; got 0.25 m | distance_m=0.25, min_m=0.5, max_m=2000
dji_limits | The first and the last waypoint must be 0.5 to 2000 m apart; got 0.25 m | distance_m=0.25, min_m=0.5, max_m=2000
dji_limits | Mission path must be at most 30 km long; got 32.3 km | path_m=32301.797, max_m=30000
dji_limits | Waypoint 1: the first and last corner radius must be 0.2 m; got 1 m | waypoint=1, corner_radius_m=1, min_m=0.2, max_m=0.2
dji_limits | Waypoint 3: the first and last corner radius must be 0.2 m; got 0.3 m | waypoint=3, corner_radius_m=0.3, min_m=0.2, max_m=0.2
dji_limits | Waypoint 2: corner radius must be 0.2 to 1000 m; got 1000.1 m | corner_radius_m=1000.1, min_m=0.2, max_m=1000
dji_limits | Waypoints 2 and 3: the corner radii must sum to less than their leg of 20.00 m; got 30.00 m | corner_radii_m=30, max_m=20
altitude_reference | A reports no altitude: WGS84 cannot be related to its takeoff point
altitude_reference | A: altitude must be at most 2 s old; got 4.0 s | age_s=4, max_s=2
altitude_reference | A: altitude must be within 10000 m of the height above takeoff; got 12001 m; wait until it reports a valid altitude | altitude_offset_m=12001, max_m=10000
altitude_reference | A: WGS84 altitude must stay within 2 m of the height above takeoff; got a jump of 3.0 m since takeoff; land and take off again | jump_m=3, max_m=2
flying | A: telemetry must be at most 3 s old; got 3.5 s; if it has landed, the order would start a takeoff. Land is always sent | age_s=3.5, max_s=3 | stale
flying | A: telemetry must be at most 3 s old; got 3.5 s; if it has landed, the order would start a takeoff. Land is always sent | age_s=3.5, max_s=3
link_age | A: core telemetry must be at most 1 s old for motion; got 2.0 s; wait for the link, or order hold, land or return | age_s=2, max_s=1
link_age | A: extended telemetry must be at most 3 s old for motion; got 4.0 s; wait for the link, or order hold, land or return | age_s=4, max_s=3
gnss | A: no position reported; wait for a fix
gnss | A: satellite count unknown; wait for extended telemetry
gnss | A: flight mode unknown, so position hold is uncertain
gnss | A: flies in ATTI, without GNSS; the pilot must steer it
gnss | A: at least 8 satellites are needed; got 7; wait, or move to open sky | satellite_count=7, min_count=8
gnss | A: GNSS signal level unknown, at least 3 of 5 is needed; wait, or move to open sky | min_level=3
gnss | A: GNSS signal level must be at least 3 of 5; got 1; wait, or move to open sky | signal_level=1, min_level=3
gnss | A: GNSS signal level must be at least 4 of 5 before takeoff, to record the home point; got 3; wait, or move to open sky | signal_level=3, min_level=4
battery | A: the aircraft reports a critically low battery; land it or recall it now
battery | A: the aircraft reports a low battery: only motion towards home is accepted
battery | A: battery warning unknown; check its companion app
battery | A: the mission needs 40 % of its battery; got 30 %: 6 % to waypoint 2, 8 % home from there, and 25 % reserve; fly less far, or change the battery | battery_fraction=0.3, min_fraction=0.393, reserve_fraction=0.25
battery | A: the goto needs 21 % of its battery; got 2 %: 5 % to its end, 5 % home from there, and 10 % reserve; fly less far, or change the battery | battery_fraction=0.02, min_fraction=0.202, reserve_fraction=0.1
preflight | A: preflight checklist not passed: Go-home height: go-home height not set (read it from the aircraft's settings and write go_home_height_m = METRES under [[vehicles]] serial = "A" in site.toml). Resolve these points, or override the checklist with a reason
speed | Speed at waypoint 1 must be at most 4 m/s; got 5.00 m/s | speed_mps=5, max_mps=4
home_distance | A: leg 1 to 2 must stay within 100 m of home; got 304.1 m | distance_from_home_m=304.138, max_m=100
boundary | A: leg 1 to 2 goes 200.0 m beyond the site's boundary; it must stay inside, 5 m from the edge | distance_inside_m=-200, min_m=5
boundary | A: the leg to the target comes within 2.00 m of the site's boundary; it must stay inside, 5 m from the edge | distance_inside_m=2, min_m=5
boundary | A: the leg to the target goes 13.0 m beyond the site's boundary; the vehicle is 5.00 m outside now and may only be moved back in | distance_inside_m=-13, min_m=5
keep_out | A: leg 1 to 2 goes through the keep-out zone 'yard' at 40.0 m above takeoff; the margin is 5 m horizontally | zone=yard, gap_m=0, min_m=5, min_vertical_m=5
keep_out | A: the leg to the target comes within 3.00 m of the keep-out zone 'yard' (up to 60 m above ground) at 40.0 m above takeoff; the margin is 5 m horizontally or 5 m vertically | zone=yard, gap_m=3, min_m=5, min_vertical_m=5
height_zones | A: leg 1 to 2 is at 40.0 m above takeoff in the height zone 'yard'; fly no lower than 50 m above ground there | zone=yard, lowest_above_takeoff_m=40, highest_above_takeoff_m=40, min_m=50, max_m=60
height_zones | A: leg 1 to 2 is at 40.0 m above takeoff in the height zone 'yard'; fly no higher than 30 m above ground there | zone=yard, lowest_above_takeoff_m=40, highest_above_takeoff_m=40, max_m=30
min_height | A: the leg to waypoint 1 must be at least 45 m above ground (flat ground assumed) outside takeoff and landing; got 40.0 m; climb straight up first (a mission's first waypoint may be above the vehicle) | height_above_ground_m=40, min_m=45
max_height | A: leg 1 to 2 must be at most 30 m above ground (flat ground assumed); got 40.0 m | height_above_ground_m=40, max_m=30
max_height | Height must be at most 30 m above takeoff; got 60.0 m | height_above_takeoff_m=60, max_m=30
separation | A: B may be in the air at an unknown position: land it or dismiss it
separation | A: on its way to its target, about 27 s from now, it must keep 18 m, or 7.5 m in height, from B (while it hovers); got 10 m and 4 m in height: fly at another height, elsewhere, or later | other=B, time_s=26.571, horizontal_m=10, vertical_m=4, min_horizontal_m=18, min_vertical_m=7.5
separation | A: on its way to its target, about 27 s from now, it must keep 23.3 m, or 6.8 m in height, from B (while it hovers); got 10 m and 4 m in height: fly at another height, elsewhere, or later | other=B, time_s=26.571, horizontal_m=10, vertical_m=4, min_horizontal_m=23.26, min_vertical_m=6.76
separation | A: on its way to its target, about 15 s from now, it would come within 0 m of where B may be, telemetry lost; wait until it reconnects, or dismiss its hazard area once you have located it | other=B, time_s=14.762, horizontal_m=0, vertical_m=0, min_horizontal_m=18, min_vertical_m=7.5
"""


def test_every_rule_is_listed() -> None:
    assert {rule for rule, _, _ in CASES} == set(RULES_BY_NAME)


def test_refusals_are_exactly_these() -> None:
    found = sorted(row(*one) for one in CASES)
    assert found == sorted(EXPECTED.strip().splitlines())


def row(rule: str, order: Command, where: Situation) -> str:
    """Return a refusal as a line: rule, sentence, parameters, and whether it is only stale."""
    refusal = RULES_BY_NAME[rule](order, where)
    assert refusal is not None
    stated = (f"{name}={shown(value)}" for name, value in refusal.parameters.items())
    cells = (refusal.rule, refusal.reason, ", ".join(stated), "stale" * refusal.is_stale)
    return " | ".join(cells).rstrip(" |")


def shown(value: float | int | str) -> str:
    assert isinstance(value, (Real, str))
    return value if isinstance(value, str) else f"{round(value, 3):.10g}"
