"""Short rounds of the benches: they must run to their end; what they measure then says nothing.

python -m tests.benches.short_rounds station.bench_load --apps 2
python -m pytest benches -p tests.benches.short_rounds
"""

import sys
import warnings
from collections.abc import Generator
from importlib import import_module
from types import ModuleType

import pytest

SHORT: dict[str, object] = {
    "ADDED_LIMIT_MS": 1e6,
    "FLOWN_S": 30.0,
    "HALTED_REPEATS": 1,
    "LAST_NS": 20_000_000_000,
    "LOOKS": 3,
    "LOOP": 10_000,
    "PACKETS": 100,
    "RECORDED_S": 3.0,
    "ROUNDS": 1,
    "SETTLED_S": 1.0,
    "SHARE_LIMIT": 1e6,
    "SETTLING_S": 1.0,
    "SINK_SECONDS": 1.0,
    "STATES": 2,
}
"""Values of constants, wherever a bench has one of this name."""


def shorten(bench: ModuleType, patch: pytest.MonkeyPatch) -> None:
    """Give a bench's constants their short values."""
    for name in SHORT.keys() & vars(bench).keys():
        patch.setattr(bench, name, SHORT[name])
    if isinstance(seeds := vars(bench).get("SEEDS"), range):
        patch.setattr(bench, "SEEDS", seeds[:1])


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, object, object]:
    """Run a bench's test shortly; no failure are limits not kept and means of too few values."""
    with pytest.MonkeyPatch.context() as patch, warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        shorten(pyfuncitem.module, patch)
        try:
            return (yield)
        except AssertionError:
            return True


if __name__ == "__main__":
    chosen = import_module(f"benches.{sys.argv.pop(1)}")
    shorten(chosen, pytest.MonkeyPatch())
    chosen.main()
