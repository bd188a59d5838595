"""The gate's fence rules against a slow checker that samples, on drawn scenes.

    python -m studies.fences --scenes 10000

Prints for each rule how many scenes were kept, broken, and too close to decide; exits with 1 when
rule and checker disagree.
"""

import sys
from functools import partial

from tests.oracles.agreement import run
from tests.oracles.drawn_fences import RULES, compare

if __name__ == "__main__":
    sys.exit(run(__doc__, tuple(RULES), partial(compare, progress=True)))
