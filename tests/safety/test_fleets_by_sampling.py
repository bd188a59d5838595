"""Separation agrees with an independent, slow checker; `make study` draws 10,000 fleets."""

from dataclasses import replace
from math import hypot

import pytest
from tests.oracles.drawn_fleets import NAMES, compare

from recon.geo.distance import offset_north_east_m
from recon.model.command import Command, Refusal
from recon.model.geo import LatLon
from recon.model.vehicle import VehicleState
from recon.safety.prediction import PredictionSettings
from recon.safety.rules import Rule
from recon.safety.rules.separation import separation
from recon.safety.settings import SafetySettings
from recon.safety.situation import Situation

SEEDS = range(20_000, 20_300)
"""None that `make study` draws too."""


def present_places(command: Command, situation: Situation) -> Refusal | None:
    """What separation gets wrong elsewhere: only where vehicles are now is compared."""
    limits = situation.airspace.airspace.limits
    assert situation.vehicle is not None
    here, up_m = place(situation.vehicle)
    for traffic in situation.traffic:
        there, other_up_m = place(traffic.vehicle)
        far_m = hypot(*offset_north_east_m(here, there))
        is_level = abs(other_up_m - up_m) < limits.min_separation_vertical_m
        if is_level and far_m < limits.min_separation_horizontal_m:
            return Refusal("now", "too near now")
    return None


def place(vehicle: VehicleState) -> tuple[LatLon, float]:
    """Where it is, and how high: above its own pad, and that above the ellipsoid."""
    position, height_m = vehicle.position.value, vehicle.height_above_takeoff_m.value
    assert position is not None
    assert height_m is not None
    assert vehicle.profile is not None
    assert vehicle.profile.pad is not None
    return position, height_m + vehicle.profile.pad.ellipsoid_height_m


def with_prediction(settings: PredictionSettings) -> Rule:
    """The rule with other figures."""

    def rule(command: Command, situation: Situation) -> Refusal | None:
        return separation(command, replace(situation, settings=SafetySettings(prediction=settings)))

    return rule


whole_paths = with_prediction(PredictionSettings(time_uncertainty=1000.0, start_delay_s=1e5))
exact_times = with_prediction(
    PredictionSettings(time_uncertainty=0.0, slack_s=0.5, start_delay_s=0.0)
)


def test_the_rule_agrees_with_dense_sampling_on_every_drawn_fleet() -> None:
    found = compare(SEEDS)
    assert found.disagreements == []
    for name in NAMES:
        assert found.kept[name] > 0
        assert found.broken[name] > 0


@pytest.mark.parametrize(
    ("rule", "seeds", "answer"),
    [
        pytest.param(present_places, range(20_000, 20_050), "approves", id="present places"),
        pytest.param(whole_paths, range(20_000, 20_100), "refuses", id="whole paths at once"),
        pytest.param(
            *(exact_times, range(20_000, 20_300), "approves"),
            id="times as if exact",
            marks=pytest.mark.flight,
        ),
    ],
)
def test_the_sampling_finds_out_a_rule_that_does_without_time(
    rule: Rule, seeds: range, answer: str
) -> None:
    found = compare(seeds, rule)
    assert any(answer in text for text in found.disagreements)
