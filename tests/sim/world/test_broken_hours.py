"""Hours of broken cloud: how they are counted; the scenarios' skies are near measured ones."""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.oracles.broken_hours import HOUR_S, MEASURED, BrokenHours, hours_table
from tests.oracles.sky_statistics import clear_sky_indices

from recon.score import load_scenario
from recon.score.scenario_sky import sky_of

ROOT = Path(__file__).parents[3]
ROW = re.compile(r"^\| ([^|]+) \| ([\d.]+) \|((?: [\d.]+ \([\d.]+\) \|)+)$", re.MULTILINE)
MOST_OFF = 0.15


def hour(*runs: tuple[float, int]) -> np.ndarray:
    """Return the index of one point and hour that keeps each value for so many seconds."""
    index = np.concatenate([np.full(n, v, dtype=np.float32) for v, n in runs])
    assert index.size == HOUR_S
    return index[:, np.newaxis]


def test_only_hours_of_broken_cloud_count() -> None:
    found = BrokenHours()
    found.add(hour((1.0, 3000), (0.3, 600)))
    found.add(hour((1.0, 1000), (0.3, 2600)))
    assert (found.watched, found.hours) == (2, 0)
    found.add(np.vstack([hour((1.0, 1800), (0.3, 1800)), hour((1.0, 3600))]))
    assert (found.watched, found.hours) == (4, 1)


def test_shadows_edges_and_windows_by_hand() -> None:
    """Five shadows of 300 s and as many gaps, by turns, and one shadow too short to count."""
    found = BrokenHours()
    found.add(hour((1.0, 300), *[(0.3, 300), (1.0, 300)] * 5, (1.0, 275), (0.3, 25)))
    figures = found.figures
    assert figures["edges an hour"] == 10.0
    assert figures["shadow, s, 50 %"] == figures["shadow, s, 90 %"] == 300.0
    assert figures["20-80 % edge, s"] == pytest.approx(0.6, abs=0.01)
    # All turns but the last fall on a window's end.
    assert figures["mixed windows of 60 s"] == pytest.approx(1.0 / 60.0)
    assert figures["persistence IoU, 5 min"] == pytest.approx(0.0, abs=0.01)
    assert figures["autocorrelation, 300 s"] < -0.5


def test_windows_of_little_shade_are_not_mixed() -> None:
    found = BrokenHours()
    found.add(hour((0.3, 1205), (1.0, 2395)))
    assert (found.hours, found.mixed) == (1, 0)


@pytest.mark.parametrize("name", ["cumulus-40", "two-layers"])
def test_a_short_run_is_near_what_was_measured(name: str) -> None:
    """Few hours scatter much: the full study, of a thousand, is held to 15 %."""
    scenario, found = load_scenario(ROOT / "scenarios" / f"{name}.toml"), BrokenHours()
    for seed in range(2_000, 2_010):
        found.add(clear_sky_indices(sky_of(scenario, seed), 4, 2.0))
    assert found.figures == pytest.approx(MEASURED, rel=0.45)


@pytest.mark.flight
def test_a_stress_scenario_is_far_from_it() -> None:
    scenario, found = (
        load_scenario(ROOT / "scenarios" / "stress" / "cumulus-40.toml"),
        BrokenHours(),
    )
    for seed in range(2_000, 2_010):
        found.add(clear_sky_indices(sky_of(scenario, seed), 4, 2.0))
    figures = found.figures
    assert figures["autocorrelation, 60 s"] < 0.7 * MEASURED["autocorrelation, 60 s"]
    assert figures["edges an hour"] > 1.3 * MEASURED["edges an hour"]


def test_the_page_shows_the_studys_table() -> None:
    """Every figure is there, with its ratio."""
    page = (ROOT / "docs" / "world.md").read_text(encoding="utf-8")
    same = hours_table(["one"], [dict(MEASURED)])
    names = [row[0] for row in ROW.findall(same)]
    assert names == list(MEASURED)
    rows = [row for row in ROW.findall(page) if row[0] in names]
    assert [row[0] for row in rows] == names
    for name, measured, cells in rows:
        for value, ratio in re.findall(r"([\d.]+) \(([\d.]+)\)", cells):
            assert float(ratio) == pytest.approx(float(value) / float(measured), abs=0.03)
            assert float(ratio) == pytest.approx(1.0, abs=MOST_OFF + 0.005), name
