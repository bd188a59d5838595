"""How a rule and a slow checker that samples agree over drawn scenes; the studies' common end."""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from recon.model.command import Refusal

SHOWN = 20
"""Disagreements that are printed; the first tells most."""


@dataclass(slots=True)
class Agreement:
    """What came of comparing, counted by the names of what was compared."""

    kept: Counter[str] = field(default_factory=Counter)
    broken: Counter[str] = field(default_factory=Counter)
    unsure: Counter[str] = field(default_factory=Counter)
    disagreements: list[str] = field(default_factory=list)

    def compare(self, scene: str, name: str, margin_m: float, refusal: Refusal | None) -> None:
        """Count a sure margin, and a disagreement when the rule disagrees."""
        is_kept = bool(margin_m > 0.0)
        (self.kept if is_kept else self.broken)[name] += 1
        if (refusal is None) is not is_kept:
            verdict = "approves" if refusal is None else f"refuses ({refusal.reason})"
            self.disagreements.append(f"{scene}: {name} {verdict}; the margin is {margin_m:.1f} m")


def over(seeds: range, compare: Callable[[int, Agreement], None], progress: bool) -> Agreement:
    """Return how all scenes of these seeds came out."""
    found = Agreement()
    for number, seed in enumerate(seeds, 1):
        compare(seed, found)
        if progress and number % 1000 == 0:
            print(f"  {number} scenes", file=sys.stderr, flush=True)
    return found


def run(about: str | None, names: Sequence[str], compare: Callable[[range], Agreement]) -> int:
    """Compare as many scenes as the command line asks for, print, return what to exit by."""
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenes", type=int, default=10_000)
    asked = parser.parse_args()
    began_s = time.perf_counter()
    found = compare(range(asked.scenes))
    print(f"{asked.scenes} scenes in {time.perf_counter() - began_s:.0f} s")
    print(f"{'':<16}{'kept':>8}{'broken':>8}{'too close to decide':>20}")
    for name in names:
        print(f"{name:<16}{found.kept[name]:>8}{found.broken[name]:>8}{found.unsure[name]:>20}")
    print(f"disagreements: {len(found.disagreements)}")
    for line in found.disagreements[:SHOWN]:
        print(f"  {line}")
    return 1 if found.disagreements else 0
