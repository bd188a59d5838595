"""Figures of links from arrival times: truth by construction."""

from collections.abc import Iterable

import pytest
from tests.fleet.reports import S, Story, core

from recon.fleet.link_quality import Arrivals, LinkFigures, after_arrival, link_figures


def arrived(times_s: Iterable[float]) -> Arrivals | None:
    arrivals = None
    for at_s in times_s:
        arrivals = after_arrival(arrivals, round(at_s * S))
    return arrivals


def figures(times_s: list[float], after_s: float = 0.0) -> LinkFigures:
    found = link_figures(arrived(times_s), round((times_s[-1] + after_s) * S))
    assert found is not None
    return found


EVEN = [0.1 * k for k in range(200)]


def test_an_even_link_has_its_rate_no_jitter_and_four_bars() -> None:
    found = figures(EVEN)
    assert found.rate_hz == pytest.approx(10.0)
    assert found.jitter_s == pytest.approx(0.0, abs=1e-9)
    assert found.longest_gap_s == pytest.approx(0.1)
    assert found.bars == 4


def test_bursts_are_jitter() -> None:
    found = figures([1.5 * burst + 0.001 * k for burst in range(10) for k in range(15)])
    assert found.jitter_s > 0.05
    assert found.bars == 2


@pytest.mark.parametrize(("gap_s", "bars"), [(0.4, 4), (0.9, 3), (1.9, 2), (2.9, 1), (3.0, 0)])
def test_the_present_silence_is_a_gap(gap_s: float, bars: int) -> None:
    assert figures(EVEN, gap_s).bars == bars


def test_a_gap_is_forgotten_after_a_minute() -> None:
    broken = [*EVEN, *(25.0 + 0.1 * k for k in range(100))]
    assert figures(broken).bars == 0
    assert figures([*broken, *(35.0 + 0.1 * k for k in range(600))]).bars == 4


def test_one_packet_shows_nothing() -> None:
    assert link_figures(None, 0) is None
    assert link_figures(arrived([1.0]), S) is None
    assert link_figures(arrived([1.0, 1.0]), S) is None


def test_a_links_core_telemetry_is_counted() -> None:
    story = Story().opens(1).receives(1, core()).at(0.1).receives(1, core())
    assert story.fleet.links[1].arrivals == arrived([0.0, 0.1])
