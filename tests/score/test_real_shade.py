"""Forecasts on real shade at 221 places of a plant and at 50 pyranometers, by RECON_DATA."""

from dataclasses import replace
from math import hypot

import pytest
from studies.real_shade import hours
from tests.conftest import real_data

from recon.forecast import FORECASTERS
from recon.light.points import LightPoints
from recon.score.forecast_figures import SeenCells
from recon.score.point_verification import verified_at_points

METHODS = {name: FORECASTERS[name] for name in ("advection", "persistence")}


@pytest.fixture(scope="module")
def real_hours() -> dict[str, LightPoints]:
    return dict(hours(real_data("real-shade", "pv-plant.npz")))


def part(points: LightPoints, begin_s: float, end_s: float) -> LightPoints:
    """A part of an hour, as a file of its own."""
    rows = slice(round(begin_s / points.step_s), round(end_s / points.step_s))
    return replace(points, times_ns=points.times_ns[rows], light=points.light[rows])


@pytest.mark.parametrize(
    ("hour", "begin_s", "most"), [("plant-a", 1_500.0, 0.75), ("plant-c", 0.0, 0.75)]
)
def test_it_is_better_than_persistence_on_real_shade(
    real_hours: dict[str, LightPoints], hour: str, begin_s: float, most: float
) -> None:
    found = verified_at_points(part(real_hours[hour], begin_s, begin_s + 600.0), METHODS)
    ours, still = (found.sums[name, 30.0, SeenCells.ALL].brier for name in METHODS)
    assert ours is not None
    assert still is not None
    assert ours < most * still


def test_where_shadows_are_fast_and_sensors_few_the_velocity_is_right_or_none(
    real_hours: dict[str, LightPoints],
) -> None:
    found = verified_at_points(part(real_hours["hope"], 900.0, 1_400.0), METHODS)
    claimed = [each for each in found.velocities_mps["advection"] if each is not None]
    assert len(claimed) >= 12
    assert max(hypot(east, north - 20.0) for east, north in claimed) < 3.0
