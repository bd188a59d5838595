"""The next seconds of a vehicle: along its order, straight on, or braking once it is held."""

from dataclasses import replace
from math import cos, hypot, radians, sin

import numpy as np
import pytest
from tests.safety.traffic import NOW, SETTINGS, S, aircraft, at, flies, route, seen
from tests.safety.watchdogs.looks import SETTINGS as ALL_SETTINGS
from tests.safety.watchdogs.looks import held, in_context, picture

from recon.model.control import Commanded, Intent
from recon.model.mission import Mission
from recon.model.vehicle import FlightMode, GoHomeFlight, VehicleState
from recon.safety.prediction import FlightPart, PredictionSettings
from recon.safety.prediction.trajectory import PART, Samples
from recon.safety.watchdogs import WatchedVehicle
from recon.safety.watchdogs.look_ahead import ASIDE_COSINE, Braking, LookAhead, next_rows

HORIZON_S = ALL_SETTINGS.watchdogs.horizon_s
MISSION, JOYSTICK = FlightMode.GPS_WAYPOINT, FlightMode.JOYSTICK

Velocity = tuple[float, float, float]


def goes_straight_on(
    state: VehicleState,
    intent: Intent,
    braking: Braking | None = None,
    prediction: PredictionSettings = SETTINGS,
) -> bool:
    rows = next_rows(seen(state), intent, braking, HORIZON_S, NOW, prediction)
    return [row[PART] for row in rows] == [FlightPart.FREE]


def towards(bearing_deg: float, speed_mps: float = 10.0) -> Velocity:
    bearing = radians(bearing_deg)
    return speed_mps * cos(bearing), speed_mps * sin(bearing), 0.0


class TestBraking:
    """2.5 m/s2 from twice the reaction time on, and 2 m/s more."""

    @pytest.mark.parametrize("commanded", [Commanded.HOLD, Commanded.LAND])
    @pytest.mark.parametrize(
        ("since_s", "speed_mps", "is_believed"),
        [
            (0.0, 12.0, True),
            (2.0, 12.0, True),
            (2.0, 12.1, False),
            (4.0, 6.9, True),
            (4.0, 7.1, False),
            (20.0, 1.9, True),
            (20.0, 2.1, False),
        ],
    )
    def test_a_hold_is_believed_of_one_that_brakes(
        self, commanded: Commanded, since_s: float, speed_mps: float, is_believed: bool
    ) -> None:
        state = aircraft(velocity=(speed_mps, 0.0, 0.0))
        intent = Intent(commanded, NOW - round(since_s * S))
        assert goes_straight_on(state, intent, Braking(since_s, 10.0)) is not is_believed

    def test_it_has_twice_the_reaction_time(self) -> None:
        slower = replace(SETTINGS, reaction_s=0.5)
        state, intent = aircraft(velocity=(10.0, 0.0, 0.0)), Intent(Commanded.HOLD)
        assert not goes_straight_on(state, intent, Braking(1.7, 10.0), slower)
        assert goes_straight_on(state, intent, Braking(1.9, 10.0), slower)

    @pytest.mark.parametrize(("since_s", "is_believed"), [(3.9, True), (4.1, False)])
    def test_of_an_order_to_hold_the_speed_before_is_taken_for_the_highest(
        self, since_s: float, is_believed: bool
    ) -> None:
        """15 m/s braked for 2 s, and 2 m/s more: 12 m/s."""
        intent = Intent(Commanded.HOLD, NOW - round(since_s * S))
        state = aircraft(velocity=(12.0, 0.0, 0.0))
        assert goes_straight_on(state, intent) is not is_believed

    @pytest.mark.parametrize(("since_s", "stops_m"), [(0.0, 30.0), (0.4, 26.0), (1.0, 20.0)])
    def test_what_is_left_of_the_reaction_time_comes_before_the_braking(
        self, since_s: float, stops_m: float
    ) -> None:
        """10 m/s on, and then 20 m to stop."""
        holds = in_context(
            aircraft(velocity=(10.0, 0.0, 0.0)),
            intent=Intent(Commanded.HOLD, NOW - round(since_s * S)),
        )
        assert end_m(holds) == pytest.approx((stops_m, 0.0), abs=0.01)

    def test_a_hold_of_the_station_counts_from_its_giving_unless_it_lands_or_a_newer_order_came(
        self,
    ) -> None:
        on = replace(flies(route((0.0, 0.0), (500.0, 0.0)), 1), since_ns=NOW - S)
        state = aircraft(velocity=(5.0, 0.0, 0.0), mode=MISSION)
        for since_s, end in ((0.4, 3.0 + 5.0), (1.0, 5.0)):
            flown = in_context(state, intent=on, held=held(since_s, 5.0))
            assert end_m(flown) == pytest.approx((end, 0.0), abs=0.01)
        assert end_m(in_context(state, intent=on, held=held(1.1, 5.0)))[0] > 45.0


def end_m(watched: WatchedVehicle) -> tuple[float, float]:
    """How far north and east of the origin it is predicted to be at last."""
    ahead = picture(watched).ahead.as_it_flies
    return float(ahead.north_m[0, -1]), float(ahead.east_m[0, -1])


NORTHWARD = route((0.0, 0.0), (400.0, 0.0))
SQUARE = route((0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0), (0.0, 0.0))


class TestAside:
    """More than 50 degrees beside every commanded direction, at 2 m/s and faster."""

    @pytest.mark.parametrize(
        ("velocity", "is_aside"),
        [
            (towards(50.0), False),
            (towards(-50.0), False),
            (towards(51.0), True),
            (towards(-51.0), True),
            (towards(180.0), True),
            (towards(180.0, 1.99), False),
            (towards(180.0, 2.01), True),
            ((0.0, 2.0, 0.0), True),
            ((0.0, 0.0, 3.0), False),
        ],
    )
    def test_a_mission_and_a_target_are_flown_towards_their_place(
        self, velocity: Velocity, is_aside: bool
    ) -> None:
        mission = aircraft(place=(100.0, 30.0), velocity=velocity, mode=MISSION)
        towards_it = flies(route((0.0, 30.0), (400.0, 30.0)), 1)
        assert goes_straight_on(mission, towards_it) is is_aside
        stick = aircraft(place=(100.0, 30.0), velocity=velocity, mode=JOYSTICK)
        target = Intent(Commanded.STICK, target=at(400.0, 30.0), speed_mps=5.0)
        assert goes_straight_on(stick, target) is is_aside
        home = aircraft(
            place=(-300.0, 30.0), velocity=velocity, mode=FlightMode.GO_HOME, home=(0.0, 30.0)
        )
        assert goes_straight_on(home, Intent(Commanded.RETURN)) is is_aside
        homeless = replace(home, takeoff_point=None)
        assert not goes_straight_on(homeless, Intent(Commanded.RETURN))

    def test_exactly_at_its_limits_it_is_not_aside_and_a_place_has_a_direction(self) -> None:
        returns = aircraft(velocity=towards(180.0), mode=FlightMode.GO_HOME, home=(512.0, 0.0))
        motion = seen(returns)._replace(east_m=0.0, north_m=0.0)

        def is_aside(home_m: float, along_mps: float) -> bool:
            moves = motion._replace(home_m=(0.0, home_m), velocity_mps=(0.0, along_mps, 0.0))
            rows = next_rows(moves, Intent(Commanded.RETURN), None, HORIZON_S, NOW, SETTINGS)
            return len(rows) == 1

        assert not is_aside(512.0, ASIDE_COSINE * motion.speed_mps)
        assert is_aside(512.0, ASIDE_COSINE * motion.speed_mps - 1e-9)
        assert is_aside(1.0, -10.0)
        assert not is_aside(0.999, -10.0)

    @pytest.mark.parametrize(
        ("passed", "bearings_deg"),
        [
            (0, {0}),
            (1, {0, 90}),
            (2, {0, 90, 180}),
            (3, {90, 180, 270}),
            (4, {180, 270}),
            (5, {270}),
        ],
    )
    def test_at_a_waypoint_the_legs_before_and_after_are_commanded_too(
        self, passed: int, bearings_deg: set[int]
    ) -> None:
        """Half-path to each of the five waypoints, and half-path along the last leg at the end."""
        flown = flies(SQUARE, passed)
        place = {0: (-50.0, 0.0), 1: (50.0, 0.0), 2: (100.0, 50.0), 3: (50.0, 100.0)}
        here = place.get(passed, (0.0, 50.0))
        found = {
            bearing
            for bearing in (0, 90, 180, 270)
            if not goes_straight_on(
                aircraft(place=here, velocity=towards(bearing), mode=MISSION), flown
            )
        }
        assert found == bearings_deg

    @pytest.mark.parametrize(
        ("passed", "here", "bearing_deg", "is_aside"),
        [
            (1, (200.0, 50.0), 207.0, False),
            (1, (200.0, 50.0), 153.0, True),
            (4, (-100.0, 0.0), 0.0, False),
            (4, (-100.0, 0.0), 60.0, True),
        ],
    )
    def test_off_its_legs_it_may_fly_to_its_next_waypoint_and_not_to_the_one_after(
        self, passed: int, here: tuple[float, float], bearing_deg: float, is_aside: bool
    ) -> None:
        state = aircraft(place=here, velocity=towards(bearing_deg), mode=MISSION)
        assert goes_straight_on(state, flies(SQUARE, passed)) is is_aside

    @pytest.mark.parametrize(
        ("commanded", "modes"),
        [
            (Commanded.MISSION, {MISSION}),
            (Commanded.STICK, {JOYSTICK}),
            (
                Commanded.RETURN,
                {FlightMode.GO_HOME, FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING},
            ),
            (Commanded.NOTHING, set()),
        ],
    )
    def test_a_known_mode_must_fit_the_order(
        self, commanded: Commanded, modes: set[FlightMode]
    ) -> None:
        intent = Intent(commanded, mission=NORTHWARD, passed=1)
        if commanded is not Commanded.MISSION:
            intent = Intent(commanded)
        state = aircraft(place=(-200.0, 0.0), velocity=towards(0.0))
        for mode in (None, *FlightMode):
            fits = mode in modes or (mode is None and commanded is not Commanded.NOTHING)
            shown = replace(state, flight_mode=replace(state.flight_mode, value=mode))
            assert goes_straight_on(shown, intent) is not fits, mode

    def test_one_off_its_track_home_is_not_believed_to_go_there(self) -> None:
        track = GoHomeFlight(NOW - 20 * S, 30.0, 0.0, 300.0, 60.0, NOW)
        state = aircraft(
            place=(-200.0, 30.0), height_m=60.0, velocity=towards(0.0), mode=FlightMode.GO_HOME
        )
        for level_from, is_off in ((at(-300.0, 0.0), True), (at(-300.0, 40.0), False)):
            flown = replace(state, go_home=replace(track, level_from=level_from))
            assert goes_straight_on(flown, Intent(Commanded.RETURN)) is is_off


def test_straight_on_keeps_the_velocity_to_the_horizon_from_telemetry_of_any_age() -> None:
    for age_s in (0.0, 0.8):
        state = aircraft("A", (10.0, 20.0), 40.0, (3.0, -4.0, 1.0), age_s=age_s)
        ahead = picture(state).ahead
        for k, time_s in enumerate(ahead.times_s):
            flown_s = time_s + age_s
            where = (ahead.as_it_flies.north_m[0, k], ahead.as_it_flies.east_m[0, k])
            assert where == pytest.approx((10.0 + 3.0 * flown_s, 20.0 - 4.0 * flown_s), abs=0.01)
            assert ahead.as_it_flies.high_m[0, k] == pytest.approx(40.0 + flown_s)


def test_the_moments_are_a_quarter_of_a_second_apart_from_now_to_the_horizon() -> None:
    times_s = picture(aircraft()).ahead.times_s
    assert times_s.tolist() == [0.25 * number for number in range(41)]
    with pytest.raises(ValueError, match="read-only"):
        times_s[0] = 1.0


def test_a_mission_is_predicted_no_farther_than_is_asked() -> None:
    many = Mission(route(*((20.0 * number, 0.0) for number in range(90))).waypoints)
    state = aircraft(velocity=(5.0, 0.0, 0.0), mode=MISSION)
    assert len(next_rows(seen(state), flies(many, 1), None, HORIZON_S, NOW, SETTINGS)) < 20


def braked_m(start_m: float, speed_mps: float, mps2: float, after_s: float) -> float:
    """Where one is that flies on for a second and then brakes, in steps of a millisecond."""
    at_m, left_mps = start_m, abs(speed_mps)
    for step in range(round(after_s * 1_000)):
        if step >= 1_000:
            left_mps = max(0.0, left_mps - 0.001 * mps2)
        at_m += 0.001 * (left_mps if speed_mps > 0.0 else -left_mps)
    return at_m


@pytest.mark.parametrize(
    "velocity",
    [
        (0.0, 0.0, 0.0),
        (10.0, 0.0, 0.0),
        (-6.0, 8.0, 3.0),
        (9.0, -12.0, -2.0),
        (1.0, 12.0, 0.5),
        (0.0, 0.3, -0.4),
    ],
)
def test_if_held_it_flies_on_for_the_reaction_time_and_brakes(velocity: Velocity) -> None:
    """At 2.5 m/s2 along its path, and at 2 m/s2 in height."""
    east_mps, north_mps, up_mps = velocity
    times_s = np.arange(41) * 0.25
    low_mps, speed_mps = 0.5 * up_mps, hypot(east_mps, north_mps)
    grows_m = np.linspace(1.0, 5.0, 41)[np.newaxis]
    flown = Samples(
        *(
            (start_m + mps * times_s)[np.newaxis]
            for start_m, mps in (
                (100.0, east_mps),
                (-200.0, north_mps),
                (40.0, low_mps),
                (50.0, up_mps),
            )
        ),
        grows_m,
    )
    stops = LookAhead(times_s, flown, SETTINGS).if_held
    assert stops.radius_m is grows_m
    shares = [abs(mps) / max(speed_mps, 1e-9) for mps in (east_mps, north_mps)]
    for values, start_m, mps, mps2 in (
        (stops.east_m, 100.0, east_mps, 2.5 * shares[0]),
        (stops.north_m, -200.0, north_mps, 2.5 * shares[1]),
        (stops.low_m, 40.0, low_mps, 2.0),
        (stops.high_m, 50.0, up_mps, 2.0),
    ):
        expected = [braked_m(start_m, mps, mps2, time_s) for time_s in times_s]
        assert values[0] == pytest.approx(expected, abs=0.02)
