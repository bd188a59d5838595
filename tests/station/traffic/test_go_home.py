"""Flights home by the aircraft's own go-home: deviations are alarms within seconds, others none."""

from random import Random

import pytest
from tests.examples import family
from tests.station.returning_world import ReturningWorld, returning_world

from recon.model.command import Body, Hover, LandNow, ReturnHome
from recon.model.severity import Severity
from recon.sim.flight.air import Air
from recon.sim.flight.flight_modes import GoHome
from recon.sim.world import Wind, WindSettings

PADS_M = [(0.0, 0.0), (60.0, 0.0)]
PLACES_M = [(-150.0, 100.0, 30.0), (200.0, 100.0, 34.0)]


def flown(
    made: ReturningWorld,
    *bodies: Body,
    at_most_s: float = 120.0,
) -> dict[str, tuple[float, Severity, str]]:
    """Order each vehicle; return when each kind of deviation was first an alarm, and its text."""
    for serial, body in zip(made.pads_m, bodies, strict=True):
        made.world.order(serial, body)
    found: dict[str, tuple[float, Severity, str]] = {}
    now_s = 0.0
    while now_s < at_most_s and any(made.flies(serial) for serial in made.pads_m):
        made.runs(0.2)
        now_s += 0.2
        for alarm in made.world.driver.station.alarms.alarms.values():
            if alarm.condition.rule == "go_home":
                condition = alarm.condition
                found.setdefault(condition.key, (now_s, condition.severity, condition.text))
    return found


def test_one_that_flies_home_below_its_go_home_height_is_a_critical_alarm_in_seconds() -> None:
    made = returning_world(PLACES_M[:1], PADS_M[:1], faults=("go-home-height:1",))
    made.put("SIM-1", (-150.0, 100.0, 12.0))
    made.runs(1.0)
    found = flown(made, ReturnHome())
    ((at_s, severity, text),) = found.values()
    assert severity is Severity.CRITICAL
    assert "expected 40 m above takeoff, seen 20 m" in text
    track = made.heights_m["SIM-1"]
    sets_out_s = next(at for at, _up_m, far_m in track if far_m < 175.0)
    assert at_s < sets_out_s - track[0][0] + 5.0


def test_one_whose_home_was_moved_is_a_critical_alarm_in_seconds() -> None:
    made = returning_world(PLACES_M[:1], PADS_M[:1], faults=("home-moved:1:1",))
    found = flown(made, ReturnHome())
    at_s, severity, text = found["go_home:SIM-1:track"]
    assert severity is Severity.CRITICAL
    assert "home point" in text
    assert at_s < 15.0
    assert found["go_home:SIM-1:landing"][1] is Severity.CRITICAL


def test_one_that_makes_no_way_is_an_alarm() -> None:
    made = returning_world(PLACES_M[:1], PADS_M[:1])
    made.world.order("SIM-1", ReturnHome())
    made.runs(10.0)
    mode = made.world.app("SIM-1").aircraft.active_mode
    assert isinstance(mode, GoHome)
    mode.speed_mps = 0.0
    made.runs(14.0)
    assert ("go_home", "SIM-1") in made.alarms()


@pytest.mark.parametrize("seed", family(*range(6)))
def test_returns_in_wind_and_gusts_are_no_alarm(seed: int) -> None:
    rng = Random(seed)
    places = [(rng.uniform(-250.0, 250.0), rng.uniform(-250.0, 250.0), h) for h in (30.0, 90.0)]
    faults = ("gusts:*:6:60",) if seed % 2 else ()
    made = returning_world(places, PADS_M, faults=faults, seed=seed)
    for number, serial in enumerate(made.pads_m):
        wind = Wind(WindSettings(seed, rng.uniform(2.0, 7.0), rng.uniform(0.0, 360.0)))
        aircraft = made.world.app(serial).aircraft
        aircraft.air = Air(wind, 0.0, 20.0 * number, aircraft.now_ns)
    assert flown(made, ReturnHome(), ReturnHome()) == {}
    assert not any(made.flies(serial) for serial in made.pads_m)


def test_a_landing_ordered_on_the_route_home_is_no_alarm() -> None:
    made = returning_world(PLACES_M[:1], PADS_M[:1])
    made.world.order("SIM-1", ReturnHome())
    made.runs(12.0)
    assert flown(made, LandNow()) == {}


def test_a_hold_ends_it() -> None:
    made = returning_world(PLACES_M[:1], PADS_M[:1], faults=("go-home-height:1",))
    made.world.order("SIM-1", ReturnHome())
    made.runs(1.5)
    flight = made.world.vehicle("SIM-1").go_home
    assert flight is not None
    assert flown(made, Hover(), at_most_s=3.0) == {}
    assert made.world.vehicle("SIM-1").go_home is None
