"""How much is drawn and flown: some in `make test`, more in `make flights` and `make study`."""

import os

import pytest

IS_THOROUGH = os.environ.get("RECON_THOROUGH") == "1"
LEAST = 10


def examples(thorough: int) -> int:
    """Return how many examples a property test draws; `thorough` is the number in `make study`."""
    return thorough if IS_THOROUGH else min(thorough, max(LEAST, thorough // 4))


def family(first: object, *others: object) -> list[object]:
    """Return parameters of a test: `make test` flies the first, `make flights` the others."""
    return [first, *(pytest.param(other, marks=pytest.mark.flight) for other in others)]
