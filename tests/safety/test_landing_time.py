"""A stop goes out without telemetry only while no aircraft could have come down to the ground."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.cases import (
    NOW,
    S,
    approved,
    command,
    mission,
    refused_by,
    situation,
    vehicle,
)
from tests.safety.fenced import airspace, hills, place

from recon.model.command import Hover, ReturnHome
from recon.model.units import Stamped
from recon.safety import Situation, approve
from recon.safety.landing_time import cannot_have_landed


def silent(age_s: float, height_m: float | None = 60.0, **changes: object) -> Situation:
    return situation(vehicle(age_s=age_s, height_above_takeoff_m=height_m, **changes))


@pytest.mark.parametrize(
    ("height_m", "age_s", "is_blind"),
    [
        (60.0, 4.0, True),
        (60.0, 5.49, True),
        (60.0, 5.5, False),
        (60.0, 20.0, False),
        (120.0, 11.0, True),
        (35.0, 3.1, False),
        (5.0, 0.0, False),
    ],
)
def test_the_fastest_descent_must_take_longer(
    height_m: float, age_s: float, is_blind: bool
) -> None:
    assert cannot_have_landed(silent(age_s, height_m)) is is_blind


def test_a_hover_goes_out_blind_and_a_return_or_mission_does_not() -> None:
    high = silent(4.0)
    assert approved(approve(command(Hover()), high)).link_ids == (1,)
    assert refused_by(approve(command(ReturnHome()), high)) == "flying"
    assert refused_by(approve(command(mission()), high)) == "flying"
    assert refused_by(approve(command(Hover()), silent(5.5))) == "flying"


def test_what_is_unknown_may_have_landed() -> None:
    assert not cannot_have_landed(silent(4.0, None))
    assert not cannot_have_landed(silent(4.0, 60.0, flying=None))
    assert not cannot_have_landed(silent(4.0, 60.0, flying=False))
    assert not cannot_have_landed(replace(silent(4.0), vehicle=None))
    never = vehicle(age_s=4.0, height_above_takeoff_m=Stamped())
    assert not cannot_have_landed(situation(never))


def test_two_links_that_claim_it_may_be_two_vehicles() -> None:
    rival = Stamped(True, NOW - 4 * S)
    two = situation(vehicle(age_s=4.0, height_above_takeoff_m=60.0), rival)
    assert not cannot_have_landed(two)


class TestOverAnElevationModel:
    """Ground at 0 m around home, and a hill of 40 m that begins 400 m east of it."""

    HILL = hills([[0.0] * 14 + [40.0] * 6] * 20)

    def blind(self, age_s: float, **changes: object) -> bool:
        state = vehicle(age_s=age_s, height_above_takeoff_m=60.0, **changes)
        return cannot_have_landed(replace(situation(state), airspace=airspace(elevation=self.HILL)))

    def test_low_ground_leaves_the_whole_height(self) -> None:
        assert self.blind(5.4)
        assert not self.blind(5.5)

    def test_ground_that_it_may_have_come_over_counts(self) -> None:
        near = place(350.0, 0.0)
        assert self.blind(1.9, position=near)
        assert not self.blind(2.1, position=near)
        assert not self.blind(4.0, position=near)

    def test_without_a_place_or_off_the_model_it_may_have_landed(self) -> None:
        assert not self.blind(4.0, position=None)
        assert not self.blind(4.0, position=place(-950.0, 0.0))

    @pytest.mark.parametrize(
        "peak_m",
        [(0, 50), (40, 30), (50, 0), (40, -30), (0, -50), (-40, -30), (-50, 0), (-40, 30)],
    )
    def test_a_peak_within_its_reach_counts_on_every_side(self, peak_m: tuple[int, int]) -> None:
        assert not self.blind_beside(peak_m)

    def test_a_peak_beyond_its_reach_does_not_count(self) -> None:
        assert self.blind_beside((0, -70))

    def blind_beside(self, peak_m: tuple[int, int]) -> bool:
        """After 2.02 s it may have come 50.5 m; a peak of 40 m stands this far east and north."""
        ground_m = np.zeros((40, 40))
        ground_m[19 - peak_m[1] // 10, 20 + peak_m[0] // 10] = 40.0
        here = place(5.0, 5.0)
        state = vehicle(age_s=2.02, height_above_takeoff_m=60.0, position=here, takeoff_point=here)
        model = hills(ground_m, cell_m=10.0)
        return cannot_have_landed(replace(situation(state), airspace=airspace(elevation=model)))
