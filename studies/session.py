"""The session over bad links for 100,000 simulated seconds.

    python -m studies.session --seconds 100000

Prints progress while it runs: simulated time, orders, marked commands carried out, faults, and each
broken rule as it is found. Exits with 1 when a rule was broken.
"""

import argparse
import sys
import time

from tests.oracles.session_study import SessionStudy, Tally

REPORT_EVERY_S = 1_000.0
SHOWN = 20


class Progress:
    """Prints one line per report, and each broken rule once."""

    def __init__(self) -> None:
        self._began_s = time.perf_counter()
        self._shown: set[str] = set()

    def __call__(self, tally: Tally) -> None:
        """Print how far the study is."""
        took_s = time.perf_counter() - self._began_s
        print(
            f"{tally.seconds:>8.0f} s ({tally.seconds / took_s:.0f} x real time):"
            f" {sum(tally.orders.values())} orders, {tally.executed} marks carried out,"
            f" {tally.emergencies} emergency packets, {sum(tally.faults.values())} faults,"
            f" {len(tally.broken)} broken",
            flush=True,
        )
        for text in tally.broken:
            if text not in self._shown and len(self._shown) < SHOWN:
                self._shown.add(text)
                print(f"  broken: {text}", flush=True)


def main() -> int:
    """Run the study and print its tally."""
    parser = argparse.ArgumentParser(description="The session over bad links.")
    parser.add_argument("--seconds", type=float, default=100_000.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--vehicles", type=int, default=1)
    options = parser.parse_args()
    progress = Progress()
    study = SessionStudy(options.seed, options.vehicles)
    tally = study.run(options.seconds, progress, REPORT_EVERY_S)
    for name, counts in (("orders", tally.orders), ("ends", tally.ends), ("faults", tally.faults)):
        print(f"{name}:")
        for key, count in sorted(counts.items()):
            print(f"  {key:<34} {count:>7}")
    print(f"sticks that moved a vehicle: {tally.moving_sticks}")
    progress(tally)
    return 1 if tally.broken else 0


if __name__ == "__main__":
    sys.exit(main())
