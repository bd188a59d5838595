"""How long a look aside takes to decide a flat scene, all in sun or all in shade.

    python -m studies.look_aside --seeds 3

The whole station in virtual time with rendered frames: one survey drone, and an imaging drone that
may look aside by itself. For each sky and seed: from the beginning of the look aside until 90 % of
the ground in view is known, and the share of the known ground that is reported rightly then.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from recon.model.airspace import Region
from recon.model.units import NS_PER_S
from recon.score import Scenario, load_scenario
from recon.score.run import StationRun
from recon.score.scenario import Methods

FOLDER = Path(__file__).parents[1] / "scenarios"
SKIES = {"clear-sky": True, "overcast": False}
"""Scenarios with a flat scene; whether it is in sun."""
WATCHED_S = 150
KNOWN_ENOUGH = 0.9
SIDE_M = 140.0


def flat_scene(name: str, detection: str) -> Scenario:
    """Return the scenario with a small field, so that only the sky matters."""
    scenario = load_scenario(FOLDER / f"{name}.toml")
    corners = np.array([(0.0, 0.0), (SIDE_M, 0.0), (SIDE_M, SIDE_M), (0.0, SIDE_M)])
    survey = replace(scenario.survey, region=Region(corners), look_aside_allowed=True)
    methods = Methods(detection, scenario.methods.forecast)
    return replace(scenario, survey=survey, methods=methods)


def decided(scenario: Scenario, seed: int, *, in_sun: bool) -> tuple[float | None, float | None]:
    """Return the seconds until it is decided, None if it is not, and the share reported rightly."""
    run = StationRun(scenario, seed)
    for _ in range(WATCHED_S):
        run.advance_a_second()
        station = run.driver.station
        shade, seen, newest = station.shade.shade, station.shade.seen, station.look_asides.newest
        if shade is None or seen is None or newest is None:
            continue
        if (shade.valid & seen).sum() >= KNOWN_ENOUGH * seen.sum():
            after_s = (shade.captured_at_ns - newest.begun_at_ns) / NS_PER_S
            return after_s, float((shade.is_sunlit == in_sun)[shade.valid].mean())
    return None, None


def main() -> None:
    """Print a line for each sky and seed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--detection", default="sunlit_reference")
    asked = parser.parse_args()
    for name, in_sun in SKIES.items():
        scenario = flat_scene(name, asked.detection)
        for seed in range(asked.first_seed, asked.first_seed + asked.seeds):
            after_s, right = decided(scenario, seed, in_sun=in_sun)
            words = "not decided" if after_s is None else f"decided after {after_s:.1f} s"
            share = "" if right is None else f", {100.0 * right:.1f} % of it rightly"
            print(f"{name}, seed {seed}: {words}{share}", flush=True)


if __name__ == "__main__":
    main()
