"""One velocity for all shadows: against known motion, persistence, and a slow horizon."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.detection.shaded_field import FIELD, DriftingShade, centres
from tests.examples import examples
from tests.forecast.moving_shade import (
    SEEN,
    drawn_velocity,
    forecasts,
    is_sunlit,
    noisy_map,
    shade_map,
)

from recon.forecast import FORECASTERS, ForecastSettings
from recon.forecast.motion import ShadowMotion
from recon.forecast.upwind import visible_upwind_s
from recon.model.geo import GroundGrid
from recon.model.shade import ShadeMap, SunForecast

SEEDS = range(700, 710)
SETTINGS = ForecastSettings(lead_s=(0.0, 30.0, 60.0, 120.0, 300.0))


def with_gaps(one: ShadeMap, share: float, seed: int) -> ShadeMap:
    """Return the map with this share of its cells unknown, drawn at random."""
    unknown = np.random.default_rng([900, seed]).random(one.valid.shape) < share
    return shade_map(one.transmittance, one.captured_at_ns / 1e9, seen=one.valid & ~unknown)


def brier(issued: SunForecast, lead: int, truth: np.ndarray, where: np.ndarray) -> float:
    chances = issued.sun_probability[lead] / 255.0
    return float(((chances - truth) ** 2)[where].mean())


class TestUnknownCells:
    def test_single_ones_do_not_end_the_horizon_of_all_downwind(self) -> None:
        """A tenth of the cells undecided, elsewhere in each map."""
        covered = []
        for seed in SEEDS[:3]:
            shade = DriftingShade(seed, velocity_mps=drawn_velocity(seed, fastest=5.0))
            whole = [noisy_map(shade, at_s) for at_s in np.arange(0.0, 60.0, 5.0)]
            holed = [with_gaps(one, 0.1, number) for number, one in enumerate(whole)]
            issued = forecasts("advection", holed, SETTINGS)[-1]
            complete = forecasts("advection", whole, SETTINGS)[-1]
            assert np.isnan(issued.horizon_s[~holed[-1].valid]).all()
            known = holed[-1].valid
            reached = (issued.horizon_s >= 30.0)[known].mean()
            covered.append(reached / (complete.horizon_s >= 30.0)[known].mean())
            truth = is_sunlit(shade, 55.0 + 30.0)
            near = issued.horizon_s >= 30.0
            assert brier(issued, 1, truth, near) < brier(complete, 1, truth, near) + 0.02
        assert min(covered) > 0.9

    @pytest.mark.parametrize("method", FORECASTERS)
    def test_a_map_without_any_known_cell_predicts_nothing_and_keeps_the_prior(
        self, method: str
    ) -> None:
        shade = DriftingShade(700, velocity_mps=(3.0, 1.0))
        whole = [noisy_map(shade, at_s) for at_s in np.arange(0.0, 60.0, 5.0)]
        unknown = with_gaps(noisy_map(shade, 60.0), 1.0, 0)
        *_, before, after = forecasts(method, [*whole, unknown], SETTINGS)
        assert after.prior_sunlit == before.prior_sunlit
        assert np.isnan(after.horizon_s).all()
        assert (after.sun_probability == round(after.prior_sunlit * 255.0)).all()


class TestAgainstPersistence:
    @pytest.mark.flight
    def test_a_minute_ahead_its_brier_score_is_half_within_the_horizon_and_no_worse_beyond(
        self,
    ) -> None:
        seen: dict[str, list[float]] = {method: [] for method in FORECASTERS}
        unseen: dict[str, list[float]] = {method: [] for method in FORECASTERS}
        for seed in SEEDS:
            velocity = drawn_velocity(seed, fastest=5.0)
            shade = DriftingShade(seed, cover=0.4, velocity_mps=velocity)
            maps = [noisy_map(shade, at_s) for at_s in np.arange(0.0, 90.0, 5.0)]
            issued = {method: forecasts(method, maps, SETTINGS) for method in FORECASTERS}
            for i in (13, 17):
                truth = is_sunlit(shade, 5.0 * i + 60.0)
                near = issued["advection"][i].horizon_s >= 60.0
                assert near.any()
                for method in FORECASTERS:
                    seen[method].append(brier(issued[method][i], 2, truth, near))
                    unseen[method].append(brier(issued[method][i], 2, truth, SEEN & ~near))
        shifted, still = np.mean(seen["advection"]), np.mean(seen["persistence"])
        assert shifted < 0.5 * still, (shifted, still)
        assert shifted < 0.15, (shifted, still)
        # A coin would have 0.25 where nothing is known.
        assert np.mean(unseen["advection"]) < np.mean(unseen["persistence"])
        assert np.mean(unseen["advection"]) < 0.27

    def test_probabilities_are_calibrated(self) -> None:
        predicted, true = [], []
        for seed in SEEDS:
            shade = DriftingShade(seed, cover=0.5, velocity_mps=drawn_velocity(seed, fastest=5.0))
            maps = [noisy_map(shade, at_s) for at_s in np.arange(0.0, 65.0, 5.0)]
            issued = forecasts("advection", maps, SETTINGS)[-1]
            near = issued.horizon_s >= 30.0
            predicted.append(issued.sun_probability[1][near] / 255.0)
            true.append(is_sunlit(shade, 90.0)[near])
        chances, happened = np.concatenate(predicted), np.concatenate(true)
        for low, high in ((0.0, 0.2), (0.2, 0.8), (0.8, 1.0)):
            among = (chances >= low) & (chances < high)
            assert abs(chances[among].mean() - happened[among].mean()) < 0.2, (low, high)


class TestMotion:
    def test_the_velocity_is_found_within_half_a_metre_a_second(self) -> None:
        for seed in SEEDS:
            velocity = drawn_velocity(seed)
            shade = DriftingShade(seed, cover=0.4, velocity_mps=velocity)
            maps = [noisy_map(shade, at_s) for at_s in np.arange(0.0, 45.0, 5.0)]
            issued = forecasts("advection", maps, SETTINGS)[-1]
            assert issued.velocity_mps == pytest.approx(velocity, abs=0.5), seed

    def test_a_turn_of_the_wind_is_followed_within_its_window(self) -> None:
        before = DriftingShade(710, cover=0.4, velocity_mps=(6.0, 0.0))
        after = DriftingShade(711, cover=0.4, velocity_mps=(0.0, -5.0))
        maps = [noisy_map(before, at_s) for at_s in np.arange(0.0, 60.0, 5.0)]
        maps += [noisy_map(after, at_s) for at_s in np.arange(60.0, 130.0, 5.0)]
        issued = forecasts("advection", maps, SETTINGS)
        assert issued[11].velocity_mps == pytest.approx((6.0, 0.0), abs=0.5)
        assert issued[-1].velocity_mps == pytest.approx((0.0, -5.0), abs=0.5)


class TestHorizon:
    @settings(max_examples=examples(30), deadline=None)
    @given(
        st.integers(0, 99),
        st.floats(-9.0, 9.0),
        st.floats(-9.0, 9.0),
        st.floats(0.1, 1.0),
    )
    @example(seed=0, east_mps=0.25, north_mps=0.2, share=0.5)  # places on edges at every step
    def test_it_is_how_long_each_cells_upwind_places_are_seen(
        self, seed: int, east_mps: float, north_mps: float, share: float
    ) -> None:
        rng = np.random.default_rng(seed)
        grid = GroundGrid(FIELD.frame, 0.0, 0.0, 4.0, 12, 15)
        seen = rng.random((12, 15)) < share
        found = visible_upwind_s(seen, grid, ShadowMotion(east_mps, north_mps), SETTINGS)
        for row in range(12):
            for col in range(15):
                least_s, most_s = self.slow_s(seen, row, col, (east_mps / 4.0, -north_mps / 4.0))
                # Where a place lies within a thousandth of an edge, either side will do.
                assert least_s <= found[row, col] <= most_s, (row, col)

    @staticmethod
    def slow_s(
        seen: np.ndarray, row: int, col: int, cells_per_s: tuple[float, float]
    ) -> tuple[float, float]:
        """One cell traced back step by step; at edges of cells the least and the most it may be."""
        horizons_s = []
        for is_seen in (all, any):
            horizon_s = at_s = 0.0
            alive = bool(seen[row, col])
            while alive and at_s < 300.0:
                at_s += SETTINGS.horizon_step_s
                cols = {
                    int(np.floor(col - cells_per_s[0] * at_s + 0.5 + nudge))
                    for nudge in (-2e-3, 2e-3)
                }
                rows = {
                    int(np.floor(row - cells_per_s[1] * at_s + 0.5 + nudge))
                    for nudge in (-2e-3, 2e-3)
                }
                alive = is_seen(
                    0 <= y < seen.shape[0] and 0 <= x < seen.shape[1] and bool(seen[y, x])
                    for y in rows
                    for x in cols
                )
                horizon_s = at_s if alive else horizon_s
            horizons_s.append(horizon_s)
        return horizons_s[0], horizons_s[1]

    def test_downwind_has_the_longest_horizon(self) -> None:
        shade = DriftingShade(712, cover=0.4, velocity_mps=(5.0, 0.0))
        maps = [noisy_map(shade, at_s) for at_s in np.arange(0.0, 65.0, 5.0)]
        issued = forecasts("advection", maps, SETTINGS)[-1]
        assert issued.method == "advection"
        middle = issued.horizon_s[64]
        assert middle[20] < middle[64] < middle[110]
        # 448 m of footprint lie upwind of its eastern edge: 90 s at 5 m/s.
        assert middle[SEEN[64]].max() == pytest.approx(480.0 / 5.0, abs=10.0)


class TestWithoutAMotion:
    @pytest.mark.parametrize("level", [0.0, 0.6, 1.0])
    def test_an_even_sky_has_none(self, level: float) -> None:
        maps = [shade_map(np.full(SEEN.shape, level), 5.0 * i) for i in range(14)]
        issued = forecasts("advection", maps, SETTINGS)[-1]
        assert issued.velocity_mps is None
        assert (issued.horizon_s[SEEN] == 0.0).all()

    def test_a_pattern_of_the_ground_in_the_maps_is_no_motion(self) -> None:
        """A detector's reference leaves the same errors at the same places in every map."""
        still = DriftingShade(739, cover=0.4, velocity_mps=(0.0, 0.0))
        maps = [noisy_map(still, 5.0 * i) for i in range(14)]
        assert {t.velocity_mps for t in forecasts("advection", maps, SETTINGS)} == {None}

    def test_maps_that_have_nothing_in_common_persist(self) -> None:
        maps = [noisy_map(DriftingShade(720 + i), 5.0 * i) for i in range(14)]
        assert forecasts("advection", maps, SETTINGS)[-1].velocity_mps is None

    def test_the_first_maps_persist(self) -> None:
        shade = DriftingShade(740, cover=0.4)
        maps = [noisy_map(shade, 5.0 * i) for i in range(3)]
        assert {t.velocity_mps for t in forecasts("advection", maps, SETTINGS)[:1]} == {None}

    def test_another_grid_begins_anew(self) -> None:
        shade = DriftingShade(741, cover=0.4)
        maps = [noisy_map(shade, 5.0 * i) for i in range(12)]
        moved = replace(maps[-1], grid=replace(FIELD, west_m=-200.0), captured_at_ns=60 * 10**9)
        issued = forecasts("advection", [*maps, moved], SETTINGS)
        assert [t.velocity_mps is None for t in issued[-2:]] == [False, True]


def test_the_middle_of_the_field_is_the_middle_of_the_tests() -> None:
    east_m, north_m = centres(FIELD)
    assert (float(east_m.mean()), float(north_m.mean())) == pytest.approx((0.0, 0.0))
