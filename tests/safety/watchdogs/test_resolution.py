"""Whom the separation watchdog holds: never makes a pair come nearer than doing nothing.

The paths of each option are predicted anew here and measured point by point.
"""

from math import hypot
from random import Random

import numpy as np
import pytest
from tests.examples import family
from tests.safety.traffic import NOW, S, aircraft, flies, route
from tests.safety.watchdogs.looks import held, in_context, looks, picture

from recon.model.control import AuthorityHolder, Commanded, Intent
from recon.model.vehicle import FlightMode
from recon.safety.prediction.trajectory import Samples
from recon.safety.watchdogs import TrafficPicture, WatchedVehicle
from recon.safety.watchdogs.separation import separation

MODES = {
    Commanded.MISSION: FlightMode.GPS_WAYPOINT,
    Commanded.RETURN: FlightMode.GO_HOME,
    Commanded.LAND: FlightMode.AUTO_LANDING,
    Commanded.HOLD: FlightMode.GPS_ATTI,
    Commanded.NOTHING: FlightMode.GPS_ATTI,
}


def drawn(rng: Random, serial: str) -> WatchedVehicle:
    """A vehicle near the origin that flies, climbs, returns, lands or hovers."""
    place = rng.uniform(-60.0, 60.0), rng.uniform(-60.0, 60.0)
    if rng.random() < 0.4:  # above or below the other, near both pads
        place = rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0)
    height_m, home = rng.uniform(5.0, 60.0), (rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0))
    commanded = rng.choice(list(MODES))
    speed_mps, up_mps = rng.choice((0.0, rng.uniform(0.0, 12.0))), 0.0
    towards = (0.0 - place[0], 0.0 - place[1])
    far_m = max(1.0, hypot(*towards))
    mode, intent = MODES[commanded], Intent(commanded, NOW - rng.randint(0, 30) * S)
    if commanded is Commanded.MISSION:
        end = (place[0] + 40.0 * towards[0] / far_m, place[1] + 40.0 * towards[1] / far_m)
        intent = flies(route((*place, height_m), (*end, height_m), land=rng.random() < 0.5), 1)
    elif commanded is Commanded.RETURN and rng.random() < 0.5:
        mode = FlightMode.AUTO_LANDING
    if mode is FlightMode.AUTO_LANDING:
        speed_mps, up_mps = 0.0, rng.uniform(-3.0, 0.0)
    elif rng.random() < 0.3:
        speed_mps, up_mps = 0.0, rng.uniform(-3.0, 3.0)
    velocity = (speed_mps * towards[0] / far_m, speed_mps * towards[1] / far_m, up_mps)
    state = aircraft(
        serial,
        place,
        height_m,
        velocity,
        home=home,
        mode=mode,
        go_home_m=rng.uniform(20.0, 60.0),
        priority=rng.randint(0, 2),
    )
    return in_context(
        state,
        intent=intent,
        holder=rng.choice(
            (AuthorityHolder.OPERATOR, AuthorityHolder.OPERATOR, AuthorityHolder.PILOT)
        ),
        held=held(rng.uniform(0.0, 8.0), speed_mps) if rng.random() < 0.2 else None,
    )


def nearest(one: tuple[Samples, int], other: tuple[Samples, int], now: TrafficPicture) -> float:
    """The least over all moments of the larger share of the two minima."""
    (a, first), (b, second) = one, other
    shares = []
    for k in range(a.east_m.shape[1]):
        level_m = hypot(
            a.east_m[first, k] - b.east_m[second, k], a.north_m[first, k] - b.north_m[second, k]
        )
        up_m = max(a.low_m[first, k] - b.high_m[second, k], b.low_m[second, k] - a.high_m[first, k])
        shares.append(max(level_m / now.minima.horizontal_m, up_m / now.minima.vertical_m))
    return float(np.min(shares))


@pytest.mark.parametrize("block", family(0, 1, 2, 3))
def test_holding_is_never_predicted_to_bring_a_pair_nearer(block: int) -> None:
    rng, conflicts, holds = Random(block), 0, 0
    for _ in range(1_000):
        pair = drawn(rng, "A"), drawn(rng, "B")
        for finding in looks(separation, *pair):
            conflicts += 1
            if finding.holds is None:
                continue
            holds += 1
            now = picture(*pair)
            flies_on, stops = now.ahead.as_it_flies, now.ahead.if_held
            paths = [stops if serial == finding.holds else flies_on for serial in ("A", "B")]
            instead = nearest((paths[0], 0), (paths[1], 1), now)
            nothing = nearest((flies_on, 0), (flies_on, 1), now)
            assert instead >= min(1.0, nothing) - 1e-9, pair
    assert conflicts > 150
    assert holds > 30


def test_the_hold_that_keeps_them_farther_apart_comes_before_the_order_of_yielding() -> None:
    """The lower one lands: held it would stay where the upper one sinks to."""
    lower = in_context(
        aircraft("B", (0.0, 0.0), 20.0, (0.0, 0.0, -3.0), mode=FlightMode.AUTO_LANDING),
        intent=Intent(Commanded.LAND, NOW - S),
    )
    upper = in_context(
        aircraft("A", (5.0, 0.0), 31.0, (0.0, 0.0, -3.0), mode=FlightMode.AUTO_LANDING, priority=9),
        intent=Intent(Commanded.LAND, NOW - S),
    )
    (found,) = looks(separation, lower, upper)
    assert found.holds == "A"


def test_a_return_that_lands_already_is_not_predicted_to_climb_again() -> None:
    """It was seen to be held below one that came home over it."""
    lands = in_context(
        aircraft("B", (0.0, 0.0), 28.0, (0.0, 0.0, -3.0), mode=FlightMode.AUTO_LANDING),
        intent=Intent(Commanded.RETURN, NOW - 20 * S),
    )
    passes = aircraft("A", (-40.0, 0.0), 50.0, (10.0, 0.0, 0.0))
    assert looks(separation, lands, passes) == []
