"""How far off followed edges are, against errors of a known size."""

import numpy as np
import pytest
from tests.detection.shaded_field import FIELD, DriftingShade
from tests.forecast.moving_shade import forecasts, is_sunlit, shade_map

from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.forecast.edge_errors import edge_error_m, spread
from recon.model.shade import ShadeMap

SETTINGS = ForecastSettings(lead_s=(0.0, 15.0, 30.0))
VELOCITY = (5.0, 2.0)
DRAWN = DriftingShade(31, 0.4, VELOCITY)


def jittered(error_m: float) -> list[ShadeMap]:
    """Maps each of which is off by an error of its own, of this deviation along each axis."""
    rng = np.random.default_rng(4)
    maps = []
    for at_s in np.arange(0.0, 120.0, 5.0):
        right, down = np.rint(rng.normal(0.0, error_m, 2) / FIELD.cell_m).astype(int)
        direct = np.roll(DRAWN.transmittance(FIELD, at_s), (down, right), axis=(0, 1))
        maps.append(shade_map(direct, at_s, confidence=1.0))
    return maps


def measured_m(error_m: float, lead_s: float) -> float:
    state = ForecastState()
    for shade in jittered(error_m):
        state = FORECASTERS["advection"].observed(state, shade, SETTINGS)
    return edge_error_m(state, lead_s, SETTINGS)


def test_the_error_is_that_of_the_maps() -> None:
    assert measured_m(0.0, 15.0) < 6.0
    # A pair differs by the errors of both.
    assert measured_m(12.0, 15.0) == pytest.approx(12.0 * 2.0**0.5, rel=0.35)


def test_chances_are_spread_as_far_as_edges_may_be_off() -> None:
    chances = np.zeros((40, 60), np.float32)
    chances[:, 30:] = 1.0
    assert spread(chances, 0.5, 4.0) is chances
    wide = spread(chances, 20.0, 4.0)[20]
    deviation_m = float(np.sqrt((np.diff(wide) * (np.arange(59) - 29.0) ** 2).sum())) * 4.0
    assert deviation_m == pytest.approx(20.0, rel=0.1)
    assert spread(np.ones((9, 9), np.float32), 400.0, 4.0) == pytest.approx(1.0)


def wrong() -> float:
    """Brier score half a minute ahead of maps that are off by 16 m, within the horizon."""
    found = []
    for one in forecasts("advection", jittered(16.0), SETTINGS)[-8:]:
        near = one.horizon_s >= 30.0
        truth = is_sunlit(DRAWN, one.issued_at_ns / 1e9 + 30.0)
        found.append(float(((one.sun_probability[2] / 255.0 - truth)[near] ** 2).mean()))
    return float(np.mean(found))


def test_forecasts_of_inexact_maps_are_less_sure_near_edges(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ours = wrong()
    monkeypatch.setattr("recon.forecast.advection.edge_error_m", lambda *_: 0.0)
    assert ours < 0.95 * wrong()
