"""The rule of separation against a slow checker that samples, on drawn fleets.

    python -m studies.fleets --scenes 10000

Each scene is a vehicle with an order to move and one to five others, flying missions, gotos or
sticks, hovering, returning, landing, told nothing, about to set out, or not heard any more. The
rule's answer is compared with the margin of `sampled_fleets` wherever that exceeds what lies
between two samples. Prints how many scenes were kept, broken, and too close to tell: for each kind
of the traffic that came nearest, and for each kind of order. Ends with 1 when the two disagree.
"""

import sys
from functools import partial

from recon.safety.rules import Rule
from recon.safety.rules.separation import separation
from studies.agreement import Agreement, over, run
from studies.drawn_fleets import ORDERS, TRAFFIC, draw
from studies.sampled_fleets import margin

NAMES = (*TRAFFIC, *(f"order: {name}" for name in ORDERS))


def compare(seeds: range, rule: Rule = separation, progress: bool = False) -> Agreement:
    """Return how the rule and the sampling agree on the scenes of these seeds."""
    return over(seeds, partial(_compare, rule), progress)


def _compare(rule: Rule, seed: int, found: Agreement) -> None:
    scene = draw(seed)
    margins = [margin(scene.own, other, scene.need) for other in scene.others]
    worst = min(margins, key=lambda each: (not each.is_broken, each.possible_m))
    names = (worst.kind, f"order: {scene.order}")
    if not worst.is_broken and not worst.is_kept:
        found.unsure.update(names)
        return
    margin_m = worst.certain_m if worst.is_broken else worst.possible_m
    refusal = rule(scene.command, scene.situation)
    found.compare(f"scene {seed}, order: {scene.order}", worst.kind, margin_m, refusal)
    (found.broken if worst.is_broken else found.kept)[names[1]] += 1


if __name__ == "__main__":
    sys.exit(run(__doc__, NAMES, partial(compare, progress=True)))
