"""The bound of what guidance could reach, on skies for which it can be told by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from studies.guidance import FOLDER
from studies.guidance_bound import bound_s, earliest_s, plan_of

from recon.score import load_scenario

AREA_M2 = np.array([1000.0, 1000.0])


def earliest(lit_share: list[list[float]], rate_m2ps: float, share: float = 1.0) -> float | None:
    lit_m2 = AREA_M2[:, np.newaxis] * np.array(lit_share)
    return earliest_s(lit_m2, AREA_M2, rate_m2ps, slot_s=10.0, share=share)


def test_under_a_clear_sky_it_is_the_time_to_fly_all_rows() -> None:
    assert earliest([[1.0] * 40, [1.0] * 40], rate_m2ps=20.0) == pytest.approx(100.0, abs=0.1)
    assert earliest([[1.0] * 40, [1.0] * 40], 20.0, share=0.5) == pytest.approx(50.0, abs=0.1)


def test_it_waits_for_the_segment_that_is_lit_last() -> None:
    late = [0.0] * 30 + [1.0] * 10
    assert earliest([[1.0] * 40, late], rate_m2ps=20.0) == pytest.approx(350.0, abs=0.1)
    # The other way round it would be too late for the first one.
    early = [1.0] * 5 + [0.0] * 35
    assert earliest([early, late], rate_m2ps=20.0) == pytest.approx(350.0, abs=0.1)
    assert earliest([early, late], rate_m2ps=10.0) is None


def test_what_is_never_lit_is_never_reached() -> None:
    assert earliest([[1.0] * 40, [0.0] * 40], rate_m2ps=20.0) is None
    assert earliest([[1.0] * 40, [0.0] * 40], 20.0, share=0.5) == pytest.approx(50.0, abs=0.1)


@given(
    st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=12),
    st.floats(5.0, 200.0),
)
def test_more_sun_or_more_drones_are_never_later(
    lit: list[tuple[bool, bool]], rate_m2ps: float
) -> None:
    share = [[float(each[segment]) for each in lit] for segment in (0, 1)]
    found = earliest(share, rate_m2ps, 0.9) or np.inf
    assert (earliest(share, 2.0 * rate_m2ps, 0.9) or np.inf) <= found + 0.2
    assert (earliest([[1.0] * len(lit)] * 2, rate_m2ps, 0.9) or np.inf) <= found + 0.2
    assert found >= 0.9 * AREA_M2.sum() / rate_m2ps - 0.2


def test_a_scenario_without_cloud_takes_its_rows_and_the_takeoff() -> None:
    scenario = load_scenario(FOLDER / "clear-sky.toml")
    plan = plan_of(scenario)
    drones, spacing_m = len(scenario.fleet.serials), plan.lattice.spacing_m
    area_m2 = plan.cells.cell_m2 * plan.cells.is_reached.sum()
    rows_s = 0.95 * area_m2 / (drones * scenario.survey.speed_mps * spacing_m)
    settings = plan.settings
    climb_s = scenario.survey.height_above_takeoff_m / settings.climb_mps
    begins_s = settings.start_s + settings.takeoff_s + climb_s
    assert bound_s(scenario, plan, seed=1) == pytest.approx(begins_s + rows_s, abs=1.0)
