"""The skies of scenarios of broken cloud against measured hours of broken cloud.

    python -m studies.broken_skies
    python -m studies.broken_skies scenarios/stress/cumulus-40.toml --skies 10

Prints each figure as measured and as simulated, with the ratio. The skies were fitted with seeds
below 8000; by default the check takes others.
"""

import argparse
from pathlib import Path

from tests.oracles.broken_hours import BrokenHours, farthest_off, hours_table
from tests.oracles.sky_statistics import clear_sky_indices

from recon.score import load_scenario
from recon.score.scenario_sky import sky_of

CHECK_SEED = 8_000
SKIES, POINTS, HOURS = 120, 8, 4.0
MOST_OFF = 0.15
BROKEN = ("cumulus-20", "cumulus-40", "cumulus-60", "two-layers")


def main() -> int:
    """Print the table; return 1 when a figure is more than 15 % off."""
    parser = argparse.ArgumentParser(description="Scenarios' skies against measured hours.")
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--skies", type=int, default=SKIES)
    parser.add_argument("--points", type=int, default=POINTS)
    parser.add_argument("--hours", type=float, default=HOURS)
    parser.add_argument("--first-seed", type=int, default=CHECK_SEED)
    options = parser.parse_args()
    files = options.files or [Path("scenarios") / f"{name}.toml" for name in BROKEN]
    found = []
    for path in files:
        scenario, seen = load_scenario(path), BrokenHours()
        for seed in range(options.first_seed, options.first_seed + options.skies):
            seen.add(clear_sky_indices(sky_of(scenario, seed), options.points, options.hours))
        found.append(seen)
    print(hours_table([path.stem for path in files], [each.figures for each in found]))
    print()
    for path, each in zip(files, found, strict=True):
        off, name = farthest_off(each.figures)
        print(f"{path.stem}: {each.hours} of {each.watched} hours; farthest off: {name}, {off:.0%}")
    return int(any(farthest_off(each.figures)[0] > MOST_OFF for each in found))


if __name__ == "__main__":
    raise SystemExit(main())
