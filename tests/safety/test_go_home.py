"""What a flight home is judged by, value by value, and what prediction makes of it."""

from collections.abc import Iterator
from dataclasses import replace
from math import cos, radians, sin

import pytest
from tests.safety.traffic import NOW, S, aircraft, at, seen
from tests.safety.watchdogs.looks import Commanded, Intent, in_context, looks

from recon.model.geo import GeoPoint
from recon.model.severity import Severity
from recon.model.units import Stamped
from recon.model.vehicle import FlightMode, GoHomeFlight, VehicleProfile, VehicleState
from recon.safety.go_home import (
    GoHomeDeviation,
    asked_height_m,
    deviations,
    home_distance_m,
    is_off_track,
    seen_height_m,
)
from recon.safety.prediction import Predictor
from recon.safety.prediction.trajectory import HIGH_0, LOW_0
from recon.safety.prediction_settings import PredictionSettings
from recon.safety.settings import GoHomeSettings
from recon.safety.watchdogs.go_home import go_home
from recon.safety.watchdogs.separation import separation

FLIGHT = GoHomeFlight(NOW - 20 * S, 30.0, 0.0, 300.0, 60.0, NOW - S, at(300.0, 0.0))
WEST = (0.0, -10.0, 0.0)
SOUTH = (-10.0, 0.0, 0.0)


def goes_home(
    place: tuple[float, float] | None = (200.0, 0.0),
    height_m: float | None = 60.0,
    velocity: tuple[float, float, float] | None = SOUTH,
    *,
    flight: GoHomeFlight | None = FLIGHT,
    mode: FlightMode = FlightMode.GO_HOME,
    home: tuple[float, float] | None = (0.0, 0.0),
    go_home_m: float | None = 60.0,
) -> VehicleState:
    """A vehicle returning home, asked to keep 60 m."""
    state = aircraft("B", place, height_m, velocity, home=home, mode=mode, go_home_m=go_home_m)
    return replace(state, go_home=flight)


def kinds(state: VehicleState) -> list[str]:
    return [found.kind for found in deviations(state, NOW)]


def fault_free() -> Iterator[VehicleState]:
    yield goes_home()
    yield goes_home(flight=None, height_m=20.0, velocity=WEST)
    yield goes_home(height_m=57.5)
    yield goes_home(height_m=40.0, velocity=(0.0, 0.0, 3.0))  # climbs on the spot
    yield goes_home(height_m=40.0, velocity=(-5.0, 0.0, 2.0))  # climbs on its way
    yield goes_home((15.0, 0.0), 20.0)  # may land without a climb
    yield goes_home((15.0, 0.0), 60.0, WEST)
    yield goes_home((200.0, 9.0))
    yield goes_home(height_m=None)
    yield goes_home(None)
    yield goes_home(home=None)
    yield goes_home(velocity=None)
    yield goes_home(height_m=20.0, go_home_m=None)
    yield goes_home(height_m=80.0, flight=replace(FLIGHT, start_height_m=80.0))
    yield goes_home(height_m=60.0, flight=replace(FLIGHT, start_height_m=None))
    yield goes_home(height_m=20.0, flight=replace(FLIGHT, since_ns=NOW - S))  # brakes
    yield goes_home(velocity=WEST, flight=replace(FLIGHT, level_from=None))
    yield goes_home((6.0, 6.0), 20.0, (0.0, 0.0, -3.0), mode=FlightMode.AUTO_LANDING)
    yield replace(goes_home(height_m=20.0), core_received_at_ns=None)


@pytest.mark.parametrize("state", list(fault_free()))
def test_what_is_asked_or_cannot_be_known_is_no_deviation(state: VehicleState) -> None:
    assert kinds(state) == []


HEIGHTS = "expected 60 m above takeoff, seen"
HOLD = "hold it or clear its way, and check the height set in the aircraft"
OFF_TRACK = GoHomeDeviation(
    "track",
    Severity.CRITICAL,
    "goes home, expected straight to its home 200 m away; seen more than 10 m beside that way, or "
    "turned away from it. The home point set in the aircraft may be elsewhere: hold it, and have "
    "its pilot check the home point",
    2.0,
)


@pytest.mark.parametrize(
    ("state", "expected"),
    [
        (
            goes_home(height_m=20.0),
            GoHomeDeviation(
                "height",
                Severity.CRITICAL,
                f"goes home too low: {HEIGHTS} 20 m. Zones and other vehicles' layers may be in "
                f"its way: {HOLD}",
                1.5,
            ),
        ),
        (
            goes_home(height_m=70.0),
            GoHomeDeviation(
                "height",
                Severity.ERROR,
                f"goes home too high: {HEIGHTS} 70 m. Other vehicles' layers may be there: {HOLD}",
                1.5,
            ),
        ),
        (goes_home(velocity=WEST), OFF_TRACK),
        (goes_home((200.0, 12.0)), OFF_TRACK),
        (
            goes_home(flight=replace(FLIGHT, progress_at_ns=NOW - 12 * S)),
            GoHomeDeviation(
                "progress",
                Severity.ERROR,
                "goes home, expected nearer to home or higher every 10 s; seen 200 m from home "
                "without progress for 12 s. Wind or an obstacle may stop it: have its pilot steer "
                "it, or land it",
                0.0,
            ),
        ),
        (
            goes_home((200.0, 0.0), 20.0, (0.0, 0.0, -3.0), mode=FlightMode.AUTO_LANDING),
            GoHomeDeviation(
                "landing",
                Severity.CRITICAL,
                "lands 200 m from home, expected within 10 m. Its home point may be elsewhere, or "
                "its battery low: keep persons clear there; its pilot must take over",
                0.5,
            ),
        ),
    ],
)
def test_each_deviation_is_stated_whole(state: VehicleState, expected: GoHomeDeviation) -> None:
    assert list(deviations(state, NOW)) == [expected]


class TestLimits:
    """At a limit nothing is wrong; just beyond it is."""

    def test_of_height(self) -> None:
        for height_m, is_wrong in [(56.9, True), (57.0, False), (63.0, False), (63.1, True)]:
            state = goes_home(height_m=height_m)
            assert kinds(state) == ["height"] * is_wrong
            assert seen_height_m(state) == (height_m if is_wrong else None)

    def test_of_climb(self) -> None:
        for climb_mps, is_level in [(1.0, False), (0.9, True)]:
            state = goes_home(height_m=20.0, velocity=(-10.0, 0.0, climb_mps))
            assert kinds(state) == ["height"] * is_level

    def test_of_progress(self) -> None:
        for waits_s, is_late in [(10.0, False), (10.1, True)]:
            late = replace(FLIGHT, progress_at_ns=NOW - round(waits_s * S))
            assert kinds(goes_home(flight=late)) == ["progress"] * is_late

    def test_of_distance_from_home(self) -> None:
        wrong = goes_home(height_m=20.0, velocity=WEST)
        lands = replace(wrong, flight_mode=Stamped(FlightMode.AUTO_LANDING, NOW))
        far_m = home_distance_m(wrong)
        assert far_m is not None
        at_limit = GoHomeSettings(near_home_m=far_m, lands_within_m=far_m)
        beyond = GoHomeSettings(near_home_m=far_m - 0.1, lands_within_m=far_m - 0.1)
        assert list(deviations(wrong, NOW, at_limit)) == []
        assert [found.kind for found in deviations(wrong, NOW, beyond)] == ["height", "track"]
        assert seen_height_m(wrong, at_limit) is None
        assert seen_height_m(wrong, beyond) == 20.0
        assert not is_off_track(wrong, at_limit)
        assert is_off_track(wrong, beyond)
        assert list(deviations(lands, NOW, at_limit)) == []
        assert [found.kind for found in deviations(lands, NOW, beyond)] == ["landing"]

    @pytest.mark.parametrize("bearing_deg", [0.0, 45.0, 90.0, 200.0, 330.0])
    def test_of_direction_and_of_distance_beside_the_way(self, bearing_deg: float) -> None:
        """Home is south of it at a bearing of 0, wherever it goes home from."""
        flight = replace(FLIGHT, level_from=at(*turned(300.0, 0.0, bearing_deg)))

        def off(beside_m: float, turns_deg: float, speed_mps: float) -> bool:
            north_mps, east_mps = turned(-speed_mps, 0.0, bearing_deg + turns_deg)
            here = turned(200.0, beside_m, bearing_deg)
            return is_off_track(goes_home(here, velocity=(north_mps, east_mps, 0.0), flight=flight))

        for turns_deg, is_turned in [(39.9, False), (40.1, True)]:
            for speed_mps in (4.0, 15.0):
                assert off(0.0, turns_deg, speed_mps) is is_turned
                assert off(0.0, -turns_deg, speed_mps) is is_turned
        for beside_m, is_beside in [(9.9, False), (10.1, True)]:
            assert off(beside_m, 0.0, 10.0) is is_beside
            assert off(-beside_m, 0.0, 10.0) is is_beside

    def test_of_no_tolerance_at_all(self) -> None:
        settings = GoHomeSettings(off_track_deg=0.0, off_track_m=0.0)
        assert not is_off_track(goes_home(velocity=(-8.0, 0.0, 0.0)), settings)

    def test_a_setting_of_the_site_is_used_for_every_part(self) -> None:
        loose = GoHomeSettings(off_track_m=20.0)
        assert list(deviations(goes_home((200.0, 12.0)), NOW, loose)) == []


def turned(north: float, east: float, degrees: float) -> tuple[float, float]:
    """A vector turned clockwise."""
    c, s = cos(radians(degrees)), sin(radians(degrees))
    return north * c - east * s, north * s + east * c


def test_a_landing_at_its_pad_is_at_home_though_it_took_off_elsewhere() -> None:
    lands = goes_home((200.0, 0.0), 20.0, (0.0, 0.0, -3.0), mode=FlightMode.CONFIRM_LANDING)
    place = lands.position.value
    assert place is not None
    pad = replace(lands, profile=None)
    assert kinds(pad) == ["landing"]
    here = GeoPoint(place.latitude_deg, place.longitude_deg, 275.0)
    assert kinds(replace(lands, profile=VehicleProfile("B", pad=here))) == []


def test_an_ordered_landing_is_no_finding() -> None:
    lands = goes_home((200.0, 0.0), 20.0, (0.0, 0.0, -3.0), mode=FlightMode.AUTO_LANDING)
    assert [found.rule for found in looks(go_home, lands)] == ["go_home"]
    assert looks(go_home, in_context(lands, intent=Intent(Commanded.LAND, NOW))) == []


@pytest.mark.parametrize(
    "state",
    [goes_home(None), goes_home(home=None), goes_home((15.0, 0.0), velocity=WEST)],
)
def test_without_a_place_or_near_home_no_track_is_wrong(state: VehicleState) -> None:
    assert not is_off_track(state)


class TestPrediction:
    """Others are kept apart from where it flies, not from where it was asked to."""

    def test_the_height_that_is_seen_takes_the_place_of_the_asked_one(self) -> None:
        assert seen(goes_home(height_m=59.0)).go_home_up_m == 60.0
        assert seen(goes_home(height_m=20.0)).go_home_up_m == 20.0
        assert seen_height_m(goes_home(height_m=20.0, go_home_m=None)) is None
        assert seen_height_m(goes_home((10.0, 0.0), 20.0)) is None
        assert seen_height_m(goes_home(height_m=None)) is None
        assert asked_height_m(replace(goes_home(), profile=None)) is None
        assert asked_height_m(goes_home(flight=None)) is None

    def test_one_above_a_low_return_is_no_conflict_and_one_in_its_way_is(self) -> None:
        low = in_context(goes_home(height_m=20.0), intent=Intent(Commanded.RETURN, NOW - 20 * S))
        assert looks(separation, low, aircraft("A", (140.0, 0.0), 60.0)) == []
        assert len(looks(separation, low, aircraft("A", (140.0, 0.0), 20.0))) == 1

    def test_one_that_flies_elsewhere_is_predicted_straight_on(self) -> None:
        off = goes_home((200.0, 0.0), velocity=(-7.0, -5.0, 0.0))
        assert is_off_track(replace(off, position=Stamped(at(200.0, -30.0), NOW)))
        astray = in_context(
            replace(off, position=Stamped(at(200.0, -30.0), NOW)),
            intent=Intent(Commanded.RETURN, NOW - 20 * S),
        )
        assert len(looks(separation, astray, aircraft("A", (144.0, -70.0), 60.0))) == 1
        assert looks(separation, astray, aircraft("A", (130.0, -19.0), 60.0)) == []

    def test_the_gate_counts_it_anywhere_near_then(self) -> None:
        astray = seen(goes_home((200.0, -30.0)))
        predictor = Predictor(astray, PredictionSettings())
        predictor.return_home()
        rows = predictor.writer.trajectory("B").rows
        assert rows[0, LOW_0] < -1_000.0
        assert rows[0, HIGH_0] > 1_000.0
