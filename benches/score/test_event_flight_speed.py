"""How much faster than real time three drones fly a survey by events, sky and ideal eye included.

uv run python -m pytest benches/score -s
"""

from dataclasses import replace
from pathlib import Path
from statistics import median
from time import process_time

import cv2
import pytest

from recon.score import Methods, Scenario, load_scenario
from recon.score.closed_loop import EventRun
from recon.score.simulation import sky_of

SCENARIO = Path(__file__).parents[2] / "scenarios" / "cumulus-40.toml"
CELL_M = 8.0
"""Shadows' edges are tens of metres wide: fine enough to study guidance."""
ROUNDS, SEEDS = 3, 4
"""Each round has seeds of its own, so that no sky is there already."""
LEAST = 1_500.0
"""Asserted on any machine, busy with other things too; 2000 is what must be had on a free one."""


def test_three_drones_fly_far_faster_than_time(capsys: pytest.CaptureFixture[str]) -> None:
    scenario = load_scenario(SCENARIO)
    scenario = replace(
        scenario, methods=Methods("ideal", "none"), imager=replace(scenario.imager, cell_m=CELL_M)
    )
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    flown(scenario, 99)
    rounds = [
        [flown(scenario, SEEDS * number + seed) for seed in range(SEEDS)]
        for number in range(ROUNDS)
    ]
    cv2.setNumThreads(threads)
    ratios = []
    for runs in rounds:
        flight_s, setup_cpu_s, cpu_s = (sum(part) for part in zip(*runs, strict=True))
        ratios.append(flight_s / (setup_cpu_s + cpu_s))
        with capsys.disabled():
            print(
                f"\nevent-level flight: {flight_s:.0f} s by three drones: setting up"
                f" {setup_cpu_s:.2f} s, flying {cpu_s:.2f} s of one core:"
                f" {ratios[-1]:.0f} times real time, {flight_s / cpu_s:.0f} without setting up",
                end="",
                flush=True,
            )
    with capsys.disabled():
        print(f"\nmedian {median(ratios):.0f} times real time, all included")
    assert median(ratios) > LEAST


def flown(scenario: Scenario, seed: int) -> tuple[float, float, float]:
    """Return how long the survey took, and one core's seconds for setting it up and flying it.

    Setting up is planning it, and drawing the first tiles of the sky.
    """
    begin_s = process_time()
    sky_of(scenario, seed).transmittance(0.0, 0.0, 0.0)
    run = EventRun(scenario, seed)
    ready_s = process_time()
    found = run.score()
    return found.survey_s, ready_s - begin_s, process_time() - ready_s
