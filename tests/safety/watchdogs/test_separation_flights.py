"""Pairs on their path into each other, flown at 100 Hz, with and without the watchdog.

The stated minimum: 15 m, or 6 m in height. All conflicts are in sight ten seconds before.
"""

from math import cos, pi, sin
from random import Random

import pytest
from tests.examples import IS_THOROUGH, family
from tests.safety.watchdogs.flights import Air, Aircraft, Vector, closeness, straight_mission

from recon.model.vehicle import FlightMode

PAIRS = 32 if IS_THOROUGH else 16
APART_M = 2_500.0
MEETS_AFTER_S = 14.0


def _level(speed_mps: float, trajectory: float) -> Vector:
    return speed_mps * cos(trajectory), speed_mps * sin(trajectory), 0.0


def head_on(rng: Random) -> tuple[Vector, Vector]:
    trajectory = rng.uniform(0.0, 2.0 * pi)
    off = trajectory + pi + rng.uniform(-0.1, 0.1)
    return _level(rng.uniform(2.0, 15.0), trajectory), _level(rng.uniform(2.0, 15.0), off)


def crossing(rng: Random) -> tuple[Vector, Vector]:
    trajectory = rng.uniform(0.0, 2.0 * pi)
    turn = rng.choice((-1.0, 1.0)) * rng.uniform(0.5, 2.6)
    return _level(rng.uniform(3.0, 15.0), trajectory), _level(
        rng.uniform(3.0, 15.0), trajectory + turn
    )


def overtaking(rng: Random) -> tuple[Vector, Vector]:
    trajectory, slow = rng.uniform(0.0, 2.0 * pi), rng.uniform(0.0, 8.0)
    return _level(slow + rng.uniform(4.0, 7.0), trajectory), _level(slow, trajectory)


def climbing_into(rng: Random) -> tuple[Vector, Vector]:
    one, other = crossing(rng)
    return (one[0], one[1], rng.uniform(0.5, 2.5)), other


def pair(rng: Random, number: int, kind: object) -> tuple[Aircraft, Aircraft]:
    """Two that would be at the same place, or metres from it, at the same time."""
    one, other = kind(rng)  # type: ignore[operator]
    conflict = ((number % 6) * APART_M, (number // 6) * APART_M, 60.0)
    meets_s = MEETS_AFTER_S + rng.uniform(0.0, 4.0)
    found = []
    for name, velocity in (("A", one), ("B", other)):
        miss = (rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0), rng.uniform(-1.5, 1.5))
        place = tuple(
            at - meets_s * v + off for at, v, off in zip(conflict, velocity, miss, strict=True)
        )
        is_mission = rng.random() < 0.5
        flown = Aircraft(
            f"{name}{number}",
            place,  # type: ignore[arg-type]
            velocity,
            mode=FlightMode.GPS_WAYPOINT if is_mission else FlightMode.GPS_ATTI,
            priority=rng.choice((0, 0, 1)),
            delay_s=rng.uniform(0.0, 1.0),
        )
        if is_mission:
            flown.intent = straight_mission(flown.place, velocity)
        found.append(flown)
    return found[0], found[1]


def least(kind: object, seed: int, *, acts: bool) -> list[float]:
    """The least closeness of each pair."""
    rng = Random(seed)
    pairs = [pair(rng, number, kind) for number in range(PAIRS)]
    air = Air([one for both in pairs for one in both], rng, acts=acts)
    nearest = [float("inf")] * PAIRS

    def note() -> None:
        for number, (one, other) in enumerate(pairs):
            nearest[number] = min(nearest[number], closeness(one, other))

    air.runs(26.0, note)
    return nearest


KINDS = (crossing, head_on, overtaking, climbing_into)


@pytest.mark.drawn
@pytest.mark.parametrize("kind", family(*KINDS))
@pytest.mark.parametrize("seed", family(1, 2))
def test_the_minimum_is_never_violated(kind: object, seed: int) -> None:
    assert min(least(kind, seed, acts=True)) >= 1.0


@pytest.mark.parametrize("kind", family(*KINDS))
def test_the_control_without_it_violates_the_minimum_every_time(kind: object) -> None:
    assert max(least(kind, 1, acts=False)) < 1.0
