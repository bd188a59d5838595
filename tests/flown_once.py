"""A flight that many tests begin with is flown once in a process; each test gets a fork of it."""

import pickle
from collections.abc import Callable
from functools import lru_cache, wraps
from typing import Any, ParamSpec, TypeVar

from recon.sim.fork import fork

WORLDS_KEPT = 8

Given = ParamSpec("Given")
WorldT = TypeVar("WorldT")


def flown_once(fly: Callable[Given, WorldT]) -> Callable[Given, WorldT]:
    """Return a function that flies once for the same arguments, and returns a fork at every call.

    Arguments without a pickle, as a lambda, are flown with each time. Not for a function whose
    flight depends on anything but its arguments, as on a patched setting.
    """

    @lru_cache(maxsize=WORLDS_KEPT)
    def flown(arguments: bytes) -> WorldT:
        positional, named = pickle.loads(arguments)
        return fly(*positional, **named)

    @wraps(fly)
    def forked(*positional: Given.args, **named: Given.kwargs) -> WorldT:
        arguments = _pickled((positional, named))
        return fly(*positional, **named) if arguments is None else fork(flown(arguments))

    return forked


def _pickled(arguments: Any) -> bytes | None:
    try:
        return pickle.dumps(arguments)
    except (pickle.PicklingError, AttributeError, TypeError):
        return None
