"""The perfect forecast is the sky to come, in view or not, and guidance flies by it."""

from dataclasses import replace

import numpy as np
import pytest
from tests.score.scenes import TINY, small

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import SUNLIT_TRANSMITTANCE, SURE, ShadeMap, SunForecast
from recon.model.units import NS_PER_S
from recon.score import Methods, Scenario, StationRun, run
from recon.score.forecast_figures import SeenCells
from recon.score.methods import settings_of
from recon.score.perfect_forecast import perfect_forecast
from recon.score.scenario import PERFECT
from recon.score.scenario_sky import sky_of
from recon.score.settings import SCORE
from recon.sim.world import LayerSettings, Sky, SkySettings

SETTINGS = ForecastSettings(lead_s=(0.0, 30.0, 240.0))
SUREST = 0.97
LOW = LayerSettings(cover=0.5, outer_scale_m=1000.0, speed_mps=8.0, heading_deg=90.0)
HIGH = LayerSettings(cover=0.3, base_height_m=4000.0, speed_mps=15.0, heading_deg=180.0)
CLOUDED = Sky(SkySettings(seed=3, layers=(LOW, HIGH)))
AT_S = 61.5


def half_seen(at_s: float) -> SunForecast:
    """A method's forecast from a map all in shade, seen in its western half."""
    grid = GroundGrid(LocalFrame(GeoPoint(41.9, -93.6, 280.0)), -200.0, 200.0, 8.0, 50, 60)
    shape = grid.rows, grid.cols
    seen = np.zeros(shape, dtype=np.bool_)
    seen[:, :30] = True
    nothing = np.where(seen, 0.0, np.nan).astype(np.float32)
    sure = seen.astype(np.float32)
    shade = ShadeMap(grid, round(at_s * NS_PER_S), ("SIM-IMAGER",), nothing, seen, sure, sure)
    return FORECASTERS["persistence"].after(ForecastState(), shade, SETTINGS)[1]


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    """A field of which the imaging drone sees a part, under low broken clouds."""
    lens = "[imager]\nfield_deg = 35.0\nreach_m = 400.0\ncell_m = 8.0"
    text = TINY.replace("[imager]", lens).replace("limit_min = 10.0", "limit_min = 1.0")
    loaded = small(tmp_path_factory.mktemp("scenarios"), text)
    survey = replace(loaded.survey, planner="sunlit_first")
    return replace(loaded, survey=survey, methods=Methods(forecast=PERFECT, scores_maps=False))


def test_each_cell_is_the_sky_at_each_later_time() -> None:
    found = perfect_forecast(CLOUDED, half_seen(AT_S), SUREST)
    assert found.issued_at_ns == AT_S * NS_PER_S
    assert found.lead_s.tolist() == list(SETTINGS.lead_s)
    skies = []
    for level, lead_s in zip(found.sun_probability, SETTINGS.lead_s, strict=True):
        is_sunlit = CLOUDED.on_grid(found.grid, AT_S + lead_s) >= SUNLIT_TRANSMITTANCE
        skies.append(is_sunlit)
        assert level[is_sunlit] / SURE == pytest.approx(SUREST, abs=0.5 / SURE)
        assert level[~is_sunlit] / SURE == pytest.approx(1.0 - SUREST, abs=0.5 / SURE)
        assert 0.05 < is_sunlit.mean() < 0.95
    assert (skies[0] != skies[1]).any()


def test_all_is_known_up_to_the_longest_lead_and_the_prior_is_the_methods() -> None:
    base = half_seen(AT_S)
    found = perfect_forecast(CLOUDED, base, SUREST)
    assert np.isnan(base.horizon_s).any()
    assert (found.horizon_s == SETTINGS.lead_s[-1]).all()
    assert found.prior_sunlit == base.prior_sunlit
    assert found.method == "perfect"


def test_the_velocity_is_that_of_the_lowest_shadows() -> None:
    """The sun moves shadows too, by less than half a metre a second."""
    velocity = perfect_forecast(CLOUDED, half_seen(AT_S), SUREST).velocity_mps
    assert velocity == pytest.approx((8.0, 0.0), abs=0.5)


def test_under_a_sky_without_clouds_all_is_in_sun_and_no_shadow_moves() -> None:
    found = perfect_forecast(Sky(SkySettings(layers=())), half_seen(AT_S), SUREST)
    assert (found.sun_probability == round(SUREST * SURE)).all()
    assert found.velocity_mps is None


def test_the_stations_own_method_is_a_real_one_with_the_leads_that_guidance_reads(
    scenario: Scenario,
) -> None:
    alone = settings_of(scenario).forecast
    scored = settings_of(replace(scenario, methods=Methods(forecast=PERFECT))).forecast
    assert alone.method in FORECASTERS
    assert alone.method == scored.method
    assert alone.lead_s == scored.lead_s[: len(alone.lead_s)] != scored.lead_s


def test_the_station_knows_the_sun_to_come_beyond_the_view(scenario: Scenario) -> None:
    flown = StationRun(scenario, 3)
    while flown.now_s < 40.0:
        flown.advance_a_second()
    shade, sun = flown.driver.station.shade.shade, flown.driver.station.shade.sun
    assert shade is not None
    assert sun is not None
    assert sun.issued_at_ns == shade.captured_at_ns
    unseen = np.argwhere(~shade.valid)
    assert len(unseen) > 0.3 * shade.valid.size
    sky = sky_of(scenario, 3)
    for lead_s in (0.0, 60.0, 240.0):
        at_ns = sun.issued_at_ns + round(lead_s * NS_PER_S)
        truth = sky.on_grid(sun.grid, at_ns / NS_PER_S)[~shade.valid] >= SUNLIT_TRANSMITTANCE
        assert ((sun.probability_sunlit(unseen, at_ns, at_ns) > 0.5) == truth).all()


@pytest.mark.flight
def test_a_survey_is_flown_by_it(scenario: Scenario) -> None:
    found = run(scenario, 3)
    assert found.missions > 0
    assert found.photos > 0
    assert (found.encounters, found.breaches, found.low_landings) == (0, 0, 0)
    assert found.forecasts == {}


@pytest.mark.flight
def test_its_score_is_that_of_what_it_leaves_open(scenario: Scenario) -> None:
    """Scored cells are the maps' cells: all that is wrong is the probability that is not stated."""
    found = run(replace(scenario, methods=Methods(forecast=PERFECT)), 3)
    open_share = 1.0 - round(SUREST * SURE) / SURE
    for lead_s in SCORE.lead_s:
        score = found.forecasts[PERFECT, lead_s, SeenCells.ALL]
        assert score.cells > 0
        assert score.brier == pytest.approx(open_share**2, rel=0.1)
    assert found.changes.predicted == 0
