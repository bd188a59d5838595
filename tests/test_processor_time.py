"""Processor time is shown for a run, in one process and in two."""

from pathlib import Path

import pytest

pytest_plugins = ["pytester"]

RUN = """
import time
from tests import processor_time

processor_time.BUDGET_S = 0.1

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
def test_a_test_over_it_without_the_marker_is_named_and_fails_nothing(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, workers: str
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[1]))
    pytester.makeconftest(RUN)
    pytester.makepyfile(TESTS)
    result = pytester.runpytest_subprocess("-n", workers, "--dist", "loadfile")
    result.assert_outcomes(passed=4)
    result.stdout.re_match_lines(
        [
            r"=+ dearest tests, s of processor =+",
            r" +0\.2 .*::test_flies$",
            r" +0\.[12] .*::test_shared \(over 0\.1 s without `flight`\)$",
        ]
    )
