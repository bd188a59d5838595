"""The generated sky against one-second irradiance measured on 13 broken-cloud days.

    python -m studies.sky_statistics
    python -m studies.sky_statistics --skies 12 --points 4 --hours 3 --first-seed 100

Prints the measured figures, the simulator's, and their ratio. The sky was fitted with seeds 100 to
139; by default the check takes others.
"""

import argparse

from tests.oracles.sky_statistics import MEASURED, Mixture, figures, table, watch

CHECK_SEED = 5_000
SKIES, POINTS, HOURS = 40, 8, 6.0


def main() -> int:
    """Print the table; return 1 when a figure is more than 25 % off."""
    parser = argparse.ArgumentParser(description="The generated sky against measured irradiance.")
    parser.add_argument("--skies", type=int, default=SKIES)
    parser.add_argument("--points", type=int, default=POINTS)
    parser.add_argument("--hours", type=float, default=HOURS)
    parser.add_argument("--first-seed", type=int, default=CHECK_SEED)
    options = parser.parse_args()
    skies = Mixture().skies(options.first_seed, options.skies)
    passages = watch(skies, options.points, options.hours)
    found = figures(passages)
    print(table(found))
    print(
        f"\n{options.skies} skies, {options.points} points of {options.hours:g} h each: in shade"
        f" {passages.shaded_s / passages.watched_s:.0%} of the time,"
        f" {len(passages.shadows_s)} shadows, {len(passages.edges_s)} edges"
    )
    worst = max(
        (abs(value / truth - 1.0), name)
        for name in MEASURED
        for value, truth in zip(found[name], MEASURED[name], strict=True)
    )
    print(f"farthest off: {worst[1]}, by {worst[0]:.0%}")
    return 1 if worst[0] > 0.25 else 0


if __name__ == "__main__":
    raise SystemExit(main())
