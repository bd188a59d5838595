"""Heights of approaches over terrain: apart from each other, from rows and from the ground."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.guidance.survey.fields import FRAME, rectangle, survey_of
from tests.guidance.survey.grounds import FloatArray, Ground, flat, hills, model, slope

from recon.guidance.survey import SurveyPlan, SurveySurroundings, plan_survey
from recon.guidance.survey.terrain import Terrain
from recon.model.airspace import LAYER_SPACING_M, Airspace
from recon.safety import PreparedAirspace
from recon.station.operations.survey.approach_layers import (
    LOWEST_M,
    SPARE_M,
    layers_over_terrain_m,
)

HEIGHT_M = 40.0
CEILING_M = 120.0


def over(ground: Ground) -> tuple[Terrain, PreparedAirspace]:
    elevation = model(ground, reach_m=500.0)
    survey = replace(
        survey_of(rectangle(), speed_mps=4.0),
        height_above_takeoff_m=None,
        height_above_ground_m=HEIGHT_M,
    )
    plan = plan_survey(survey, FRAME, SurveySurroundings(elevation=elevation))
    assert isinstance(plan, SurveyPlan)
    assert plan.terrain is not None
    return plan.terrain, PreparedAirspace(Airspace(frame=FRAME, elevation=elevation))


def path(number: int) -> tuple[FloatArray, FloatArray]:
    """From a pad south of the field to a row's beginning, and the end of the last row."""
    pad_m, first_m = (100.0 * number, -40.0), (100.0 * number, 20.0 + 30.0 * number)
    return np.array([pad_m, first_m]), np.array([290.0 - 80.0 * number, 150.0])


def places_of(path_m: FloatArray, end_m: FloatArray) -> FloatArray:
    share = np.linspace(0.0, 1.0, 200)[:, np.newaxis]
    return np.concatenate([path_m[0] * (1.0 - share) + path_m[1] * share, end_m[np.newaxis]])


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), steepest=st.floats(0.0, 0.35))
def test_no_two_vehicles_share_a_layer_and_none_meets_rows_or_ground(
    seed: int, steepest: float
) -> None:
    ground = hills(seed, steepest)
    terrain, air = over(ground)
    found: list[list[float]] = []
    for number in range(3):
        path_m, end_m = path(number)
        layers_m = layers_over_terrain_m(terrain, air, path_m, end_m, number, 3)
        places_m = places_of(path_m, end_m)
        wanted_m, ground_m = terrain.up_m(places_m), ground(*places_m.T)
        for layer_m in layers_m:
            assert np.abs(layer_m - wanted_m).min() >= LAYER_SPACING_M - 0.5
            assert layer_m >= ground_m.max() + LOWEST_M - 0.5
            assert layer_m <= ground_m.min() + CEILING_M - SPARE_M + 0.5
        found.append(layers_m)
    for one, other in combinations(found, 2):
        apart_m = [abs(a - b) for a in one for b in other]
        assert min(apart_m, default=LAYER_SPACING_M) >= LAYER_SPACING_M - 1e-6


def test_over_flat_ground_they_are_multiples_of_a_layer_off_the_rows_the_nearest_first() -> None:
    terrain, air = over(flat)
    assert layers_over_terrain_m(terrain, air, *path(0), 0, 2) == pytest.approx(
        [50.0, 30.0, 70.0, 90.0, 110.0]
    )
    assert layers_over_terrain_m(terrain, air, *path(1), 1, 2) == pytest.approx(
        [60.0, 20.0, 80.0, 100.0]
    )


def test_up_a_slope_a_vehicle_on_the_low_side_stays_lower_than_the_highest_rows() -> None:
    terrain, air = over(slope)
    path_m, end_m = np.array([(0.0, -40.0), (0.0, 20.0)]), np.array([10.0, 150.0])
    layers_m = layers_over_terrain_m(terrain, air, path_m, end_m, 0, 2)
    assert terrain.highest_up_m > 65.0
    assert layers_m[0] < terrain.highest_up_m


def test_where_the_ground_is_unknown_there_is_none() -> None:
    terrain, air = over(slope)
    beyond_m = np.array([(-900.0, -40.0), (0.0, 20.0)])
    assert layers_over_terrain_m(terrain, air, beyond_m, np.array([10.0, 150.0]), 0, 1) == []
