"""The limit of processor time, on a run of two tests in two processes."""

from pathlib import Path

import pytest
from tests import processor_time

pytest_plugins = ["pytester"]

RUN = """
import time
from tests import processor_time

processor_time.BUDGET_S = 0.1
processor_time.slowness = lambda: SLOWNESS

def pytest_configure(config):
    config.addinivalue_line("markers", "flight: long")
    config.pluginmanager.register(processor_time.ProcessorTime(), "processor_time")
"""

TESTS = """
import time
import pytest

def works(seconds):
    end_s = time.process_time() + seconds
    while time.process_time() < end_s:
        pass

@pytest.fixture(scope="module")
def prefix():
    works(0.15)

def test_shared(prefix):
    pass

def test_shares(prefix):
    pass

def test_sleeps():
    time.sleep(0.2)

@pytest.mark.flight
def test_flies():
    works(0.2)
"""


@pytest.mark.parametrize("workers", ["0", "2"])
def test_a_test_over_it_fails_without_the_marker(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, workers: str
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1]))
    pytester.makeconftest(RUN.replace("SLOWNESS", "1.0"))
    pytester.makepyfile(TESTS)
    result = pytester.runpytest_subprocess("-n", workers, "--dist", "loadfile")
    result.assert_outcomes(passed=4, errors=1)
    result.stdout.re_match_lines(
        [
            r"Took 0\.[12] s of processor; at most 0 s without the marker `flight`\..*",
            r"=+ dearest tests, s of processor =+",
            r" +0\.2 .*::test_flies",
            r" +0\.[12] .*::test_shared",
        ]
    )


def test_on_a_slower_processor_more_is_allowed(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1]))
    pytester.makeconftest(RUN.replace("SLOWNESS", "50.0"))
    pytester.makepyfile(TESTS)
    pytester.runpytest_subprocess().assert_outcomes(passed=4)
    assert processor_time.slowness() >= 1.0
