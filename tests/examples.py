"""The number of examples of property and drawn tests: few in `make test`, all in `make study`."""

import os

IS_THOROUGH = os.environ.get("RECON_THOROUGH") == "1"
LEAST = 10


def examples(thorough: int) -> int:
    """Return how many examples a property test draws; `thorough` is the number in `make study`."""
    return thorough if IS_THOROUGH else min(thorough, max(LEAST, thorough // 4))
