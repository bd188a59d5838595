"""Other methods over a recorded flight: the same ones give the same maps, true maps no error."""

from pathlib import Path

import numpy as np
import pytest
from tests.replay.flights import FOLDER, skip_if_recorded_elsewhere
from tests.score.scenes import small, written

from recon.detection import DetectionState
from recon.forecast import ForecastSettings, ForecastState
from recon.forecast.persistence import PERSISTENCE
from recon.model.errors import ReconError
from recon.model.shade import ShadeMap
from recon.model.units import NS_PER_S
from recon.score.scenario_schema import ScenarioError
from recon.score.scenario_sky import sky_of
from recon.score.score_grid import score_grid
from recon.score.truth import Truth, truth_of, world_text
from recon.score.what_if import MethodPair, WhatIf
from recon.station.imaging.shade import ShadeRead
from recon.station.recording.replay import check
from recon.station.state.imaging import SeenShade

ZERO_NS = 1_750_000_000 * NS_PER_S
SEED = 3


def test_the_recorded_methods_find_the_same_again() -> None:
    other = WhatIf("sunlit_reference", None)
    path = FOLDER / "pictures.mcap"
    found = check(path, on_start=skip_if_recorded_elsewhere, on_job=other.take)
    assert not found.differences
    assert other.recorded is not None
    assert other.asked is not None
    assert other.images >= 3
    was, is_now = other.recorded, other.asked
    assert (was.maps, was.rejected, was.names) == (is_now.maps, is_now.rejected, is_now.names)
    assert was.newest is not None
    assert is_now.newest is not None
    assert np.array_equal(was.newest.transmittance, is_now.newest.transmittance, equal_nan=True)
    assert other.same_cells == other.known_cells
    assert "forecasts are not compared" in other.report()


def test_an_unknown_method_is_one_sentence() -> None:
    with pytest.raises(ReconError, match=r"detection: expected sunlit_reference, .*, got 'moon'"):
        WhatIf("moon", None)


@pytest.mark.parametrize("off_s", [0.0, 40.0])
def test_true_maps_have_no_error_and_maps_of_another_time_do(tmp_path: Path, off_s: float) -> None:
    scenario = small(tmp_path)
    truth = truth_of(world_text(written(tmp_path), SEED, ZERO_NS), written(tmp_path), tmp_path)
    assert isinstance(truth, Truth)
    grid, state = score_grid(scenario), ForecastState()
    pair = MethodPair("test", "persistence")
    pair.compare_with(truth)
    for at_s in (10.0, 50.0, 90.0):
        value = sky_of(scenario, SEED).on_grid(grid, at_s + off_s).astype(np.float32)
        valid, ones = np.ones_like(value, bool), np.ones_like(value)
        at_ns = ZERO_NS + round(at_s * NS_PER_S)
        seen = SeenShade(ShadeMap(grid, at_ns, (), value, valid, ones, ones), valid)
        state, sun = PERSISTENCE.after(state, seen.shade, ForecastSettings(), seen.seen)
        pair.take(ShadeRead("SIM-IMAGER", DetectionState(), state, seen, (seen, sun)))
    figures = pair.score.shade
    assert (pair.maps, figures.unknown) == (3, 0)
    assert 0 < figures.shaded < figures.cells
    assert (figures.false + figures.missed == 0) == (off_s == 0.0)
    assert {lead_s for _method, lead_s, _cells in pair.score.forecasts} >= {15.0, 600.0}


def test_the_sky_of_a_record_is_that_of_its_scenario_as_flown(tmp_path: Path) -> None:
    path = written(tmp_path)
    text = world_text(path, SEED, ZERO_NS)
    found = truth_of(text, None, tmp_path)
    assert found is not None
    assert (found.scenario.name, found.sky.settings.seed, found.zero_ns) == ("small", SEED, ZERO_NS)
    assert truth_of("", None, tmp_path) is None
    with pytest.raises(ScenarioError, match="--scenario"):
        truth_of(text, None, tmp_path / "elsewhere")
    with pytest.raises(ScenarioError, match="expected file, seed"):
        truth_of("../small.toml x", None, tmp_path)
    path.write_text(path.read_text() + "\n")
    with pytest.raises(ScenarioError, match="not the scenario as it was flown"):
        truth_of(text, None, tmp_path)
