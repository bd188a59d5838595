"""What a flight home is judged by, value by value, and what prediction makes of it."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from tests.safety.traffic import NOW, S, aircraft, at, seen
from tests.safety.watchdogs.looks import Commanded, Intent, in_context, looks

from recon.model.geo import GeoPoint
from recon.model.units import Stamped
from recon.model.vehicle import FlightMode, GoHomeFlight, VehicleProfile, VehicleState
from recon.safety.go_home import asked_height_m, deviations, is_off_track, seen_height_m
from recon.safety.prediction import Predictor
from recon.safety.prediction.trajectory import HIGH_0, LOW_0
from recon.safety.settings import PredictionSettings
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
    """A vehicle on its way home, asked to keep 60 m."""
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


@pytest.mark.parametrize(
    ("state", "kind", "words"),
    [
        (goes_home(height_m=20.0), "height", "expected 60 m above takeoff, seen 20 m"),
        (goes_home(height_m=70.0), "height", "too high: expected 60 m above takeoff, seen 70 m"),
        (goes_home(velocity=WEST), "track", "expected straight to its home 200 m away"),
        (goes_home((200.0, 12.0)), "track", "more than 10 m beside that way"),
        (
            goes_home(flight=replace(FLIGHT, progress_at_ns=NOW - 12 * S)),
            "progress",
            "seen 200 m from home without progress for 12 s",
        ),
        (
            goes_home((200.0, 0.0), 20.0, (0.0, 0.0, -3.0), mode=FlightMode.AUTO_LANDING),
            "landing",
            "lands 200 m from home, expected within 10 m",
        ),
    ],
)
def test_each_deviation_states_what_is_expected_and_seen(
    state: VehicleState, kind: str, words: str
) -> None:
    (found,) = deviations(state, NOW)
    assert found.kind == kind
    assert words in found.text


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


@pytest.mark.parametrize("state", [goes_home(None), goes_home((15.0, 0.0), velocity=WEST)])
def test_without_a_place_or_near_home_no_track_is_wrong(state: VehicleState) -> None:
    assert not is_off_track(state)


class TestPrediction:
    """Others are kept apart from where it flies, not from where it was asked to."""

    def test_the_height_that_is_seen_takes_the_place_of_the_asked_one(self) -> None:
        assert seen(goes_home(height_m=59.0)).go_home_up_m == 60.0
        assert seen(goes_home(height_m=20.0)).go_home_up_m == 20.0
        assert seen_height_m(goes_home(height_m=20.0, go_home_m=None)) is None
        assert seen_height_m(goes_home((10.0, 0.0), 20.0)) is None
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
        rows = predictor.writer.trajectory("B", "B").rows
        assert rows[0, LOW_0] < -1_000.0
        assert rows[0, HIGH_0] > 1_000.0
