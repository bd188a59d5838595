"""How much faster than real time three drones fly a survey by events, sky and ideal eye included.

uv run python -m pytest benches/score -s
"""

from dataclasses import replace
from pathlib import Path
from time import process_time

import pytest

from recon.score import Methods, load_scenario, run

SCENARIO = Path(__file__).parents[2] / "scenarios" / "cumulus-40.toml"
CELL_M = 8.0
"""Shadows' edges are tens of metres wide: fine enough to study guidance."""
SEEDS = range(4)
LEAST = 1_000.0
"""Asserted on any machine, busy with other things too; what is aimed at is 2000."""


def test_three_drones_fly_far_faster_than_time(capsys: pytest.CaptureFixture[str]) -> None:
    scenario = load_scenario(SCENARIO)
    scenario = replace(
        scenario, methods=Methods("ideal", "none"), eye=replace(scenario.eye, cell_m=CELL_M)
    )
    run(scenario, 99)
    start = process_time()
    runs = [run(scenario, seed) for seed in SEEDS]
    took_s = process_time() - start
    flown_s = sum(found.survey_s for found in runs)
    ratio = flown_s / took_s
    with capsys.disabled():
        told = f"{flown_s:.0f} s by three drones in {took_s:.2f} s of one core"
        print(f"\nevent-level flight: {told}, {ratio:.0f} times real time", flush=True)
    assert ratio > LEAST
