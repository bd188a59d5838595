"""The rule of separation against a slow checker that samples, on drawn fleets.

    python -m studies.fleets --scenes 10000

Each scene is a vehicle with an order to move and one to five others: flying missions, gotos or
sticks, hovering, returning, landing, without a command, about to take off, or with telemetry lost.
Prints how many scenes were kept, broken, and too close to decide, by kind of the nearest traffic
and by kind of order; exits with 1 when rule and checker disagree.
"""

import sys
from functools import partial

from tests.oracles.agreement import run
from tests.oracles.drawn_fleets import NAMES, compare

if __name__ == "__main__":
    sys.exit(run(__doc__, NAMES, partial(compare, progress=True)))
