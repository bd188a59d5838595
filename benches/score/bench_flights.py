"""Processor time of `recon score` beside another checkout's, whose flights must be the same.

    python -m benches.score.bench_flights --against PATH/src [--scenario FILE] [--seeds N]

The two fly in turn. The scores that they keep, with every figure in full precision, must be equal
to the bit.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

PROJECT = Path(__file__).parents[2]


@dataclass(frozen=True, slots=True)
class Flown:
    """The runs of one command."""

    processor_s: float
    scores: tuple[bytes, ...]
    """As they are kept, by seed."""


def flown(source: Path, scenario: Path, seeds: int) -> Flown:
    """Fly all seeds of a scenario by a checkout's source, in one process."""
    words = ["score", str(scenario), "--seeds", str(seeds), "--jobs", "1", "--fresh"]
    with TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [sys.executable, "-m", "recon", *words],
            env={**os.environ, "PYTHONPATH": str(source), "XDG_STATE_HOME": folder},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            check=True,
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        kept = sorted(Path(folder).rglob("seed-*.msgpack"), key=lambda path: path.name)
        scores = tuple(path.read_bytes() for path in kept)
    took_s = (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)
    return Flown(took_s, scores)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--against", type=Path, required=True, help="src of another checkout.")
    parser.add_argument("--scenario", type=Path, default=PROJECT / "scenarios" / "clear-sky.toml")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=1)
    options = parser.parse_args()
    ratios = []
    for _ in range(options.rounds):
        other = flown(options.against, options.scenario, options.seeds)
        own = flown(PROJECT / "src", options.scenario, options.seeds)
        if own.scores != other.scores or len(own.scores) != options.seeds:
            print("FAILED: the flights are not the same")
            return 1
        ratios.append(other.processor_s / own.processor_s)
        print(f"{own.processor_s:.1f} s of processor, the other {other.processor_s:.1f} s")
    print(f"same flights, {statistics.median(ratios):.2f} times as fast")
    return 0


if __name__ == "__main__":
    sys.exit(main())
