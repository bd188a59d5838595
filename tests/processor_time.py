"""The dearest tests of a run, and a limit for those without the marker `flight`.

Counted is processor time of the test's own process, against the pace of its processor at that
moment: a busy or slow machine cannot fail a test. A fixture counts for the test that makes it
first, processes that a test starts do not count.
"""

import time
from collections.abc import Generator

import pytest

BUDGET_S = 5.0
"""A test above 2 s ought to be a `flight`; what lies between is left to slower machines."""

PACE_LOOPS, PACE_S = 1_000_000, 0.03
"""A loop that takes so long on the machine that the budget is meant for, when it is idle."""

SHOWN, SHOWN_FROM_S = 10, 0.1
PROPERTY = "processor_s"


class ProcessorTime:
    """Measures setup, call and teardown of each test; the controller of several workers shows."""

    def __init__(self) -> None:
        self._spent_s: dict[str, float] = {}

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> Generator[None, None, None]:
        item.user_properties.append((PROPERTY, 0.0))
        return (yield from _counted(item))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Generator[None, None, None]:
        return (yield from _counted(item))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_teardown(self, item: pytest.Item) -> Generator[None, None, None]:
        yield from _counted(item)
        spent_s = dict(item.user_properties)[PROPERTY]
        is_dear = spent_s > BUDGET_S and not item.get_closest_marker("flight")
        if is_dear and spent_s > BUDGET_S * slowness():
            pytest.fail(
                f"Took {spent_s:.1f} s of processor; at most {BUDGET_S:.0f} s without the marker "
                "`flight`. Make it shorter, share what is flown before it, or mark it.",
                pytrace=False,
            )

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "teardown":
            self._spent_s[report.nodeid] = float(str(dict(report.user_properties)[PROPERTY]))

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        dearest = sorted(self._spent_s.items(), key=lambda test: -test[1])[:SHOWN]
        terminalreporter.section("dearest tests, s of processor")
        for name, spent_s in dearest:
            if spent_s > SHOWN_FROM_S:
                terminalreporter.write_line(f"{spent_s:6.1f} {name}")
        terminalreporter.write_line(f"{sum(self._spent_s.values()):6.0f} all tests")


def slowness() -> float:
    """Return how much slower than meant a processor is now, at least 1: others may share it."""
    started_s, total = time.process_time(), 0
    for number in range(PACE_LOOPS):
        total += number & 7
    assert total > 0
    return max(1.0, (time.process_time() - started_s) / PACE_S)


def _counted(item: pytest.Item) -> Generator[None, None, None]:
    started_s = time.process_time()
    try:
        return (yield)
    finally:
        spent_s = dict(item.user_properties)[PROPERTY] + time.process_time() - started_s
        item.user_properties[:] = [
            *(prop for prop in item.user_properties if prop[0] != PROPERTY),
            (PROPERTY, spent_s),
        ]
