"""The dearest tests of a run, with those that ought to have the marker `flight`.

Counted is processor time of the test's own process. It is shown and fails nothing: processors that
others share take twice as long for the same work. A fixture counts for the test that makes it
first, processes that a test starts do not count.
"""

import time
from collections.abc import Generator

import pytest

BUDGET_S = 5.0
"""A test above 2 s ought to be a `flight`; what lies between is left to slower machines."""

SHOWN, SHOWN_FROM_S = 10, 0.1
PROPERTY, FLIES = "processor_s", "flies"


class ProcessorTime:
    """Measures setup, call and teardown of each test; the controller of several workers shows."""

    def __init__(self) -> None:
        self._spent_s: dict[str, float] = {}
        self._unmarked: set[str] = set()

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
        item.user_properties.append((FLIES, item.get_closest_marker("flight") is not None))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "teardown":
            found = dict(report.user_properties)
            self._spent_s[report.nodeid] = spent_s = float(str(found[PROPERTY]))
            if spent_s > BUDGET_S and not found[FLIES]:
                self._unmarked.add(report.nodeid)

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        dearest = sorted(self._spent_s.items(), key=lambda test: -test[1])[:SHOWN]
        terminalreporter.section("dearest tests, s of processor")
        for name, spent_s in dearest:
            if spent_s > SHOWN_FROM_S:
                note = f" (over {BUDGET_S:g} s without `flight`)" if name in self._unmarked else ""
                terminalreporter.write_line(f"{spent_s:6.1f} {name}{note}")
        terminalreporter.write_line(f"{sum(self._spent_s.values()):6.0f} all tests")


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
