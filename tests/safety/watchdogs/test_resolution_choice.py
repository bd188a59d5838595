"""Whom to hold of two: what counts as better, who comes first, and when to wait for an effect."""

from dataclasses import replace
from math import inf

import pytest
from tests.safety.traffic import aircraft
from tests.safety.watchdogs.looks import AuthorityHolder, held, in_context, looks, picture

from recon.model.failsafe_matrix import FailsafeCondition
from recon.safety.settings import WatchdogSettings
from recon.safety.watchdogs import WatchedVehicle
from recon.safety.watchdogs.closest_approach import Approach
from recon.safety.watchdogs.resolution import (
    ROUNDING,
    PairConflict,
    is_better,
    speed_mps,
    vehicle_to_hold,
)
from recon.safety.watchdogs.separation import separation

SETTINGS = replace(WatchdogSettings(), helps_share=0.0625)
"""With a share of binary fractions, so that limits can be met exactly."""


def met(in_s: float | None, least: float, height_gap_m: float = -4.0) -> Approach:
    return Approach(in_s, least, 0.0, 0.0, height_gap_m)


@pytest.mark.parametrize(
    ("instead", "is_so"),
    [
        (met(None, 1.0, inf), True),
        (met(3.0, 0.5), False),
        (met(3.25, 0.5), True),
        (met(3.24, 0.5), False),
        (met(9.0, 0.49), False),
        (met(9.0, 0.5 - 0.5e-9), True),
        (met(9.0, 0.5 - ROUNDING), True),
        (met(9.0, 0.5 - 2e-9), False),
        (met(3.0, 0.5625), True),
        (met(3.0, 0.5624), False),
        (met(3.0, 0.5, -3.0), True),
        (met(3.0, 0.5, -3.01), False),
        (met(3.0, 0.5624, -5.0), False),
        (met(3.0, 0.5625, -9.0), True),
        (met(2.99, 0.9, 9.0), False),
    ],
)
def test_a_hold_is_better_if_it_puts_the_conflict_off_or_widens_it_and_never_if_nearer(
    instead: Approach, is_so: bool
) -> None:
    assert is_better(SETTINGS, met(3.0, 0.5), instead) is is_so


def test_one_that_was_never_placed_has_no_speed() -> None:
    assert speed_mps(WatchedVehicle(aircraft())) == 0.0


def crossing(a_mps: float, a_m: float, b_mps: float, b_m: float) -> list[WatchedVehicle]:
    """A comes from the south and B from the west, so far before they cross."""
    return list(
        picture(
            aircraft("A", (-a_m, 0.0), velocity=(a_mps, 0.0, 0.0)),
            aircraft("B", (0.0, -b_m), velocity=(0.0, b_mps, 0.0)),
        ).watched
    )


def held_of(*vehicles: WatchedVehicle) -> str | None:
    (found,) = looks(separation, *vehicles)
    return found.holds


class TestTheOrderOfYielding:
    def test_decides_between_holds_that_keep_the_minima(self) -> None:
        """Held, A stops 25 m before the other's path and B 20 m, or the other way round."""
        for a_m, b_m in ((55.0, 50.0), (50.0, 55.0)):
            a, b = crossing(10.0, a_m, 10.0, b_m)
            assert held_of(a, b) == "B"
            assert held_of(a, in_context(b.state, is_imager=True)) == "A"

    def test_gives_way_to_the_hold_that_alone_keeps_the_minima(self) -> None:
        """The slow one stops 10 m before the other's path; held, the fast one keeps 20 m."""
        a, b = crossing(5.0, 30.0, 2.2, 13.2)
        assert held_of(a, b) == "A"
        assert held_of(in_context(a.state, holder=AuthorityHolder.PILOT), b) == "B"
        a, b = crossing(2.2, 13.2, 5.0, 30.0)
        assert held_of(a, b) == "B"
        assert held_of(a, in_context(b.state, holder=AuthorityHolder.PILOT)) == "A"

    def test_gives_way_to_the_hold_that_keeps_more_distance(self) -> None:
        """Held, one stops 12 m before the other's path, and the other 5 m before its."""
        assert held_of(*crossing(4.0, 19.2, 3.0, 9.8)) == "A"
        assert held_of(*crossing(3.0, 9.8, 4.0, 19.2)) == "B"


class TestWaitingForAnEffect:
    """The other needs 1 s to react, its speed over 2.5 m/s2 to stop, and half of 2 s more."""

    def second(self, in_s: float, a_held_s: float | None, b_held_s: float | None) -> str | None:
        """A at 10 m/s needs 6 s; B at 5 m/s needs 4 s."""
        a, b = crossing(10.0, 60.0, 5.0, 30.0)
        a = a._replace(held=None if a_held_s is None else held(a_held_s, 10.0))
        b = b._replace(held=None if b_held_s is None else held(b_held_s, 5.0))
        now = picture(a, b)
        yielding, other = now.flying[1], now.flying[0]
        conflict = PairConflict((yielding, other), (1, 0), met(in_s, 0.0), now.minima, None)
        found = vehicle_to_hold(now, conflict)
        return None if found is None else found.name

    @pytest.mark.parametrize(("in_s", "second"), [(6.0, "A"), (6.01, None)])
    def test_of_the_first(self, in_s: float, second: str | None) -> None:
        assert self.second(in_s, None, 1.9) == second

    @pytest.mark.parametrize(("in_s", "second"), [(4.0, "B"), (4.01, None)])
    def test_of_the_other(self, in_s: float, second: str | None) -> None:
        assert self.second(in_s, 1.9, None) == second

    def test_lasts_two_seconds(self) -> None:
        assert self.second(9.0, None, 1.9) is None
        assert self.second(9.0, None, 2.0) == "A"


def test_a_site_may_leave_it_to_an_alarm() -> None:
    a, b = crossing(10.0, 50.0, 10.0, 50.0)
    for left, holds in ((FailsafeCondition.SEPARATION, "A"), (FailsafeCondition.GEOFENCE, "B")):
        assert held_of(a, b._replace(alarm_only=frozenset({left}))) == holds


def test_heights_that_cannot_be_compared_make_no_hold_help() -> None:
    """The one in front is not held for the one behind, though it reports 30 m more."""
    front = aircraft("B", (60.0, 0.0), 70.0, (4.0, 0.0, 0.0), home=(80.0, 0.0))
    behind = aircraft("A", (0.0, 0.0), 40.0, (12.0, 0.0, 0.0))
    assert held_of(in_context(front), in_context(behind)) == "A"
