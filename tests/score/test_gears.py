"""Flights worked out by events against the same flown by the simulator through the whole station.

A short version of `python -m studies.gears`.
"""

from pathlib import Path
from random import Random

import pytest
from studies.gears import (
    Arrival,
    compared,
    compared_shares,
    compared_survey,
    drawn_curve,
    drawn_flight,
)


def assert_all_agree(found: list[Arrival], at_least: int) -> None:
    assert len(found) >= at_least
    assert [each for each in found if each.share_of_allowed >= 1.0] == []
    assert any(each.is_end for each in found)


@pytest.mark.parametrize("seed", [1, 4])
def test_a_single_mission_takes_as_long(seed: int) -> None:
    assert_all_agree(compared(drawn_flight(Random(seed))), at_least=3)


def test_a_mission_past_rounded_corners_takes_as_long() -> None:
    assert_all_agree(compared(drawn_curve(Random(6))), at_least=2)


def test_a_survey_by_one_drone_takes_as_long_from_its_first_order_to_its_landing(
    tmp_path: Path,
) -> None:
    assert_all_agree(list(compared_survey(tmp_path, 1)), at_least=12)


def test_each_mission_of_three_drones_takes_as_long(tmp_path: Path) -> None:
    found = list(compared_shares(tmp_path, 1))
    assert_all_agree(found, at_least=20)
    assert sum(each.is_end for each in found) == 3
    assert {each.flight.split(", ")[1] for each in found} == {"SIM-1", "SIM-2", "SIM-3"}
