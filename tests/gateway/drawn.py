"""Drawn inputs for the gateway's property tests."""

from collections.abc import Callable
from typing import Any

from hypothesis import given, settings
from tests.examples import examples


def given_examples(*strategies: Any, thorough: int = 400) -> Callable[[Any], Any]:
    """Run a test with drawn values."""

    def decorate(test: Any) -> Any:
        return settings(max_examples=examples(thorough), deadline=None)(given(*strategies)(test))

    return decorate
