"""Bounds spare predictions and change no finding."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.safety.traffic import NOTHING, aircraft, at, flies, route, waypoint
from tests.safety.watchdogs.looks import (
    NOW,
    WATCHDOGS,
    Commanded,
    FlightMode,
    Intent,
    S,
    held,
    in_context,
    picture,
)
from tests.safety.watchdogs.test_fences import LAYER, TREES, WALL, site

from recon.model.mission import Mission
from recon.safety.watchdogs import TrafficPicture, WatchedVehicle
from recon.safety.watchdogs.fences import fences
from recon.safety.watchdogs.reach import near_each_other, near_limits
from recon.safety.watchdogs.separation import separation

SITE = site(WALL, LAYER)
AGREES = {
    Commanded.MISSION: FlightMode.GPS_WAYPOINT,
    Commanded.STICK: FlightMode.JOYSTICK,
    Commanded.RETURN: FlightMode.GO_HOME,
}

offsets = st.floats(-400.0, 400.0)
near_offsets = st.floats(-60.0, 60.0)
heights = st.floats(5.0, 140.0)
speeds = st.floats(0.5, 15.0)
places = st.tuples(offsets, offsets)
velocities = st.tuples(
    st.one_of(st.just(0.0), st.floats(-14.0, 14.0)),
    st.one_of(st.just(0.0), st.floats(-14.0, 14.0)),
    st.one_of(st.just(0.0), st.floats(-4.0, 4.0)),
)


@st.composite
def missions(draw: st.DrawFn, start: tuple[float, float]) -> Mission:
    """Waypoints near the vehicle; some legs are too short to be predicted as flown."""
    north_m, east_m = start
    waypoints = []
    for _ in range(draw(st.integers(1, 5))):
        if draw(st.booleans()):
            north_m, east_m = north_m + draw(near_offsets), east_m + draw(near_offsets)
        else:
            east_m += 0.0015
        waypoints.append(
            waypoint(
                north_m,
                east_m,
                draw(heights),
                speed_mps=draw(speeds),
                loiter_s=draw(st.sampled_from([None, 2.0])),
            )
        )
    is_curved, lands = draw(st.integers(0, 9)) == 0, draw(st.integers(0, 9)) == 0
    return Mission(tuple(waypoints), curved=is_curved, land_at_end=lands)


@st.composite
def intents(draw: st.DrawFn, place: tuple[float, float]) -> Intent:
    commanded = draw(st.sampled_from([*Commanded, Commanded.MISSION, Commanded.STICK]))
    intent = Intent(commanded, NOW - round(draw(st.floats(0.0, 8.0)) * S))
    if commanded is Commanded.MISSION:
        mission = draw(missions(place))
        passed = draw(st.integers(0, len(mission.waypoints)))
        return replace(intent, mission=mission, passed=passed)
    if commanded is Commanded.STICK:
        is_aimed = draw(st.booleans())
        return replace(
            intent,
            target=at(place[0] + draw(near_offsets), place[1] + draw(near_offsets))
            if is_aimed
            else None,
            target_height_above_takeoff_m=draw(st.none() | heights),
            speed_mps=draw(st.none() | speeds) if is_aimed else None,
        )
    return intent


@st.composite
def vehicles(draw: st.DrawFn, serial: str) -> WatchedVehicle:
    place = draw(places)
    intent = draw(intents(place))
    agreeing = AGREES.get(intent.commanded, FlightMode.GPS_ATTI)
    state = aircraft(
        serial,
        place,
        draw(st.sampled_from([None, *[draw(heights) for _ in range(7)]])),
        draw(st.sampled_from([None, *[draw(velocities) for _ in range(7)]])),
        age_s=draw(st.sampled_from([0.0, 0.1, 0.5, 0.9, 30.0] + [0.0] * 15)),
        mode=draw(st.sampled_from([agreeing, agreeing, FlightMode.GPS_ATTI, None])),
    )
    stop = held(draw(st.floats(0.0, 4.0)), draw(speeds)) if draw(st.booleans()) else None
    return in_context(state, intent=intent, held=stop)


fleets = st.lists(st.integers(), min_size=1, max_size=4).flatmap(
    lambda seats: st.tuples(*(vehicles(f"V{number}") for number in range(len(seats))))
)


def unbounded(of: TrafficPicture) -> TrafficPicture:
    """The same picture as if no vehicle had a bound."""
    copied = replace(of)
    vars(copied)["reaches"] = None
    return copied


@pytest.mark.flight
@settings(max_examples=300, deadline=None)
@given(fleets)
def test_bounds_change_no_finding(fleet: tuple[WatchedVehicle, ...]) -> None:
    bounded = picture(*fleet, airspace=SITE)
    for watchdog in (separation, fences):
        assert list(watchdog(bounded)) == list(watchdog(unbounded(bounded)))


@settings(max_examples=300, deadline=None)
@given(vehicles("V1"))
def test_what_is_predicted_stays_within_its_bound(vehicle: WatchedVehicle) -> None:
    drawn = picture(vehicle, airspace=SITE)
    if not drawn.reaches:
        return
    (reach,), flies_on, times_s = drawn.reaches, drawn.ahead.as_it_flies, drawn.ahead.times_s
    far_m = np.hypot(flies_on.east_m[0] - reach.east_m, flies_on.north_m[0] - reach.north_m)
    assert (far_m <= [reach.radius_m(float(time_s)) for time_s in times_s]).all()
    assert (flies_on.radius_m == 0.0).all()
    assert reach.low_m <= flies_on.low_m.min()
    assert reach.high_m >= flies_on.high_m.max()


def test_nothing_is_predicted_of_vehicles_far_from_each_other_and_from_all_fences() -> None:
    looked_at = picture(
        in_context(aircraft("A", (0.0, -200.0)), intent=flies(route((40.0, -200.0)))),
        in_context(aircraft("B", (0.0, 200.0)), intent=Intent(Commanded.HOLD)),
        in_context(aircraft("C", (0.0, -200.0), 90.0), intent=NOTHING),
        airspace=site(TREES),
    )
    assert not [found for watchdog in WATCHDOGS for found in watchdog(looked_at)]
    assert "ahead" not in vars(looked_at)


def test_a_vehicle_without_a_bound_is_predicted_and_so_are_all() -> None:
    unknown = (
        Intent(Commanded.LAND),
        Intent(Commanded.RETURN),
        Intent(Commanded.MISSION),
        flies(route((0.0, 50.0), (50.0, 50.0), curved=True)),
        flies(route((0.0, 50.0), land=True)),
    )
    for intent in unknown:
        assert picture(in_context(aircraft("A"), intent=intent), aircraft("B")).reaches is None
    assert picture(aircraft("A"), aircraft("B", age_s=30.0)).reaches is None


def test_only_vehicles_near_each_other_or_near_a_limit_are_predicted() -> None:
    looked_at = picture(
        in_context(aircraft("A", (0.0, -200.0)), intent=NOTHING),
        in_context(aircraft("B", (0.0, -190.0)), intent=NOTHING),
        in_context(aircraft("C", (0.0, 0.0)), intent=NOTHING),
        in_context(aircraft("D", (0.0, 100.0), 140.0), intent=NOTHING),
        airspace=SITE,
    )
    assert looked_at.reaches is not None
    horizon_s = looked_at.settings.horizon_s
    assert near_each_other(looked_at.reaches, looked_at.minima, horizon_s) == {0, 1}
    assert near_each_other(looked_at.reaches[:1], looked_at.minima, horizon_s) == set()
    assert SITE.airspace.frame is not None
    ask = SITE, SITE.airspace.frame, looked_at.settings, looked_at.prediction
    assert 3 in near_limits(looked_at.reaches, *ask)
    assert 2 not in near_limits(looked_at.reaches, *ask)
    assert [one.name for one in looked_at.only({0, 3}).predicted] == ["A", "D"]
    assert looked_at.only({0, 1, 2, 3}) is looked_at


def test_height_limits_hold_without_a_boundary() -> None:
    (found,) = fences(picture(aircraft("A", (0.0, 200.0), 300.0)))
    assert found.rule == "height_limit"
