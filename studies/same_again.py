"""Run the same scenes in two processes and compare them to the bit.

    python -m studies.same_again --seconds 60

Exits with 1 when any scene differs.
"""

import sys

from tests.oracles.same_again import main

if __name__ == "__main__":
    sys.exit(main())
