"""The sky's statistics: how they are counted, and that a short run is near what was measured."""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.oracles.shadow_passages import SHADE_INDEX, Passages, edge_s
from tests.oracles.sky_statistics import MEASURED, Mixture, figures, table, watch

PAGE = Path(__file__).parents[3] / "docs" / "world.md"
ROW = re.compile(r"^\| ([^|]+) \| ([^|]+) \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$", re.MULTILINE)


def series(*runs: tuple[float, int]) -> np.ndarray:
    """Return an index that keeps each value for so many seconds, one point (T, 1)."""
    return np.concatenate([np.full(n, v, dtype=np.float32) for v, n in runs])[:, np.newaxis]


def test_runs_are_counted_whole_and_from_half_a_minute() -> None:
    found = Passages()
    found.add(series((1.0, 500), (0.3, 40), (1.0, 29), (0.3, 30), (1.0, 900), (0.3, 700)))
    assert found.shadows_s == [40, 30]
    assert found.gaps_s == [900]
    assert found.shaded_s / found.watched_s == pytest.approx((40 + 30 + 700) / 2199)


def test_persistence_is_the_overlap_of_now_and_later() -> None:
    """Shade and sun by turns of 100 s: a minute on, 40 of 160 s are shaded both times."""
    found = Passages()
    found.add(series(*[(v, 100) for v in (0.3, 1.0)] * 200))
    assert found.persistence[0] == pytest.approx(40.0 / 160.0, abs=0.01)
    assert found.persistence[4] == pytest.approx(1.0)


@pytest.mark.parametrize("slow_s", [5, 20, 60])
@pytest.mark.parametrize("into_shade", [True, False])
def test_an_even_edge_takes_six_tenths_of_its_length(slow_s, into_shade) -> None:
    ramp = np.interp(np.arange(400.0), [200.0, 200.0 + slow_s], [1.0, 0.3]).astype(np.float32)
    index = ramp if into_shade else ramp[::-1]
    shade = index < SHADE_INDEX
    turn = int(np.flatnonzero(shade[1:] != shade[:-1])[0]) + 1
    assert edge_s(index, turn) == pytest.approx(0.6 * slow_s, abs=0.05)


def test_a_step_takes_less_than_a_second() -> None:
    index = series((1.0, 100), (0.3, 100))[:, 0]
    assert edge_s(index, 100) == pytest.approx(0.6, abs=0.01)


def test_a_short_run_is_near_what_was_measured() -> None:
    """Few skies scatter much: the full study, on more of them, is held to 25 %."""
    found = figures(watch(Mixture().skies(2_000, 6), 8, 3.0))
    for name, measured in MEASURED.items():
        assert found[name] == pytest.approx(measured, rel=0.6), name


def test_the_page_shows_the_studys_table() -> None:
    """Every figure is there, its ratio is right, and none is farther off than a quarter."""
    empty = ROW.findall(table({name: np.array(each) for name, each in MEASURED.items()}))
    names = {row[0] for row in empty}
    rows = [row for row in ROW.findall(PAGE.read_text(encoding="utf-8")) if row[0] in names]
    assert [row[:3] for row in rows] == [row[:3] for row in empty]
    for name, at, measured, simulated, ratio in rows:
        assert float(ratio) == pytest.approx(float(simulated) / float(measured), abs=0.02)
        assert abs(float(ratio) - 1.0) <= 0.25, f"{name} {at}"
