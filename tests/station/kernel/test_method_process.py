"""Methods of installed packages in their own process: raising, late and ended ones cost one job."""

import os
import time
from collections.abc import Callable, Iterator
from types import MappingProxyType
from typing import Any

import pytest

from recon.model.methods import MethodError
from recon.site import Site
from recon.station.kernel.method_process import MethodProcess
from recon.station.kernel.worker import JobRunner
from recon.station.state.steps import Job, JobDone, JobKind

PATIENCE_S = 60.0


def doubled(numbers: MappingProxyType[str, int]) -> MappingProxyType[str, int]:
    return MappingProxyType({name: 2 * number for name, number in numbers.items()})


def raises(_given: object) -> None:
    raise KeyError("no such cell")


def never_returns(_given: object) -> None:
    while True:
        time.sleep(60.0)


def ends_its_process(_given: object) -> None:
    os._exit(7)


def process_id(_given: object) -> int:
    return os.getpid()


@pytest.fixture(scope="module")
def process() -> Iterator[MethodProcess]:
    made = MethodProcess(limit_s=PATIENCE_S)
    yield made
    made.stop()


def run_when_ready(process: MethodProcess, work: Callable[[Any], Any], given: Any) -> Any:
    """Run a job; those that come while the process starts fail at once."""
    until_s = time.monotonic() + PATIENCE_S
    while True:
        try:
            return process.run(work, given, "made")
        except MethodError as problem:
            if "is starting again" not in str(problem) or time.monotonic() > until_s:
                raise
            time.sleep(0.02)


def test_a_method_that_raises_is_late_or_ends_costs_one_job(process: MethodProcess) -> None:
    given = MappingProxyType({"a": 21})
    assert process.run(doubled, given, "made") == {"a": 42}
    with pytest.raises(MethodError, match="the method made failed: KeyError"):
        process.run(raises, None, "made")
    first_id = process.run(process_id, None, "made")
    assert first_id != os.getpid()

    process.limit_s = 0.2
    with pytest.raises(MethodError, match=r"the method made took longer than 0.2 s"):
        process.run(never_returns, None, "made")
    process.limit_s = PATIENCE_S
    # The next job does not wait for the next process.
    with pytest.raises(MethodError, match=r"longer than 0.2 s, and was ended; its process is st"):
        process.run(doubled, given, "made")
    assert run_when_ready(process, doubled, given) == {"a": 42}

    with pytest.raises(MethodError, match="the method made has ended its process"):
        process.run(ends_its_process, None, "made")
    assert run_when_ready(process, process_id, None) not in (first_id, os.getpid())


@pytest.mark.parametrize(("isolates", "method"), [(True, ""), (False, "made")])
def test_our_own_methods_and_runs_in_virtual_time_stay_in_the_stations_process(
    isolates: bool, method: str
) -> None:
    def noted(station: Any, *_what: object) -> Any:
        return station, ()

    kind = JobKind("made", lambda _site: process_id, noted, noted, noted, outside=lambda _: method)
    done = JobRunner(Site(name="bare"), isolates=isolates).run(Job(1, kind, None))
    assert isinstance(done, JobDone)
    assert done.result == os.getpid()


def test_the_runner_hands_a_packages_method_to_a_process(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def run(_self: MethodProcess, _work: object, given: object, method: str) -> str:
        asked.append((given, method))
        return "result"

    monkeypatch.setattr(MethodProcess, "run", run)
    kind: JobKind[Any, Any] = JobKind(
        "made", lambda _site: process_id, *[lambda station, *_: (station, ())] * 3,
        outside=lambda given: f"method {given}",
    )  # fmt: skip
    done = JobRunner(Site(name="bare"), isolates=True).run(Job(1, kind, 5))
    assert isinstance(done, JobDone)
    assert (done.result, asked) == ("result", [(5, "method 5")])
