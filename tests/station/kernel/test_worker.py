"""Heavy jobs beside the loop: results as events, newer jobs before older, faults isolated."""

import threading
from collections.abc import Callable
from queue import Queue
from typing import Any

import pytest

from recon.model.errors import ReconError
from recon.model.event import Event
from recon.site import Site
from recon.station.kernel.step import step
from recon.station.kernel.worker import JobRunner, ThreadWorker
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobDone, JobDropped, JobFailed, JobKind, Stepped

PATIENCE_S = 120.0
DIRTY = "the lens is dirty"
SITE = Site(name="bare")


def kind(name: str, run: Callable[[Any], Any]) -> JobKind[Any, Any]:
    """A kind whose ends are noted in the station's audit problem."""

    def noted(station: Station, *what: object) -> Stepped:
        return Station(audit_problem=repr(what)), ()

    return JobKind(name, lambda _site: run, noted, noted, noted)


def failing(problem: Exception) -> Callable[[Any], Any]:
    def run(_input: object) -> object:
        raise problem

    return run


class TestOneJob:
    def test_the_result_comes_back(self) -> None:
        double = kind("double", lambda n: 2 * n)
        done = JobRunner(SITE).run(Job(7, double, 21))
        assert isinstance(done, JobDone)
        assert (done.job_id, done.kind, done.result) == (7, double, 42)

    @pytest.mark.parametrize(
        "problem", [ReconError("the lens is dirty"), ValueError("the lens is dirty")]
    )
    def test_an_expected_error_keeps_its_text(self, problem: Exception) -> None:
        failed = JobRunner(SITE).run(Job(1, kind("lay", failing(problem)), None))
        assert isinstance(failed, JobFailed)
        assert failed.error == DIRTY

    def test_a_fault_names_its_type(self) -> None:
        failed = JobRunner(SITE).run(Job(1, kind("lay", failing(KeyError("x"))), None))
        assert isinstance(failed, JobFailed)
        assert failed.error == "KeyError: 'x'"

    def test_a_kind_is_prepared_for_the_site_once(self) -> None:
        sites: list[Site] = []

        def prepare(site: Site) -> Callable[[int], int]:
            sites.append(site)
            return lambda n: n

        end = kind("x", int).done
        counted: JobKind[int, int] = JobKind("count", prepare, end, end, end)
        runner = JobRunner(SITE)
        for number in range(3):
            runner.run(Job(number, counted, number))
        assert sites == [SITE]

    def test_a_kind_that_cannot_be_prepared_fails_its_jobs(self) -> None:
        def prepare(_site: Site) -> Callable[[object], object]:
            raise ReconError("no imaging drone")

        end = kind("x", int).done
        failed = JobRunner(SITE).run(Job(1, JobKind("lay", prepare, end, end, end), None))
        assert isinstance(failed, JobFailed)
        assert failed.error == "no imaging drone"

    def test_a_replaced_kind_runs_the_other_function(self) -> None:
        double, runner = kind("double", lambda n: 2 * n), JobRunner(SITE)
        runner.replace(double, lambda n: 3 * n)
        done = runner.run(Job(1, double, 5))
        assert isinstance(done, JobDone)
        assert done.result == 15


def test_the_step_gives_each_end_of_a_job_to_its_kind() -> None:
    mine = kind("mine", int)
    for event, noted in (
        (JobDone(4, mine, "result"), (4, "result", 9)),
        (JobFailed(5, mine, "error"), (5, "error", 9)),
        (JobDropped(6, mine), (6, 9)),
    ):
        station, outputs = step(Station(), event, 9)
        assert (station.audit_problem, outputs) == (repr(noted), ())


class TestThread:
    def test_a_newer_job_drops_an_older_one_that_has_not_begun(self) -> None:
        events: Queue[Event] = Queue()
        begun, may_end = threading.Event(), threading.Event()

        def wait(given: object) -> object:
            begun.set()
            assert may_end.wait(PATIENCE_S)
            return given

        slow, quick = kind("slow", wait), kind("quick", lambda given: given)
        worker = ThreadWorker(JobRunner(SITE), events.put)
        worker.start()
        worker.submit(Job(1, slow, "a"))
        assert begun.wait(PATIENCE_S)
        worker.submit(Job(2, slow, "b"))
        worker.submit(Job(3, quick, "q"))
        worker.submit(Job(4, slow, "c"))
        assert events.get(timeout=PATIENCE_S) == JobDropped(2, slow)
        may_end.set()
        done = [events.get(timeout=PATIENCE_S) for _ in range(3)]
        assert all(isinstance(event, JobDone) for event in done)
        assert {(e.job_id, e.result) for e in done if isinstance(e, JobDone)} == {
            (1, "a"),
            (3, "q"),
            (4, "c"),
        }
        worker.stop()

    def test_a_fault_does_not_end_the_thread(self) -> None:
        events: Queue[Event] = Queue()
        good, bad = kind("good", lambda given: given), kind("bad", failing(RuntimeError("no")))
        worker = ThreadWorker(JobRunner(SITE), events.put)
        worker.start()
        for job_id, each in enumerate((bad, good, bad, good)):
            worker.submit(Job(job_id, each, job_id))
            event = events.get(timeout=PATIENCE_S)
            assert type(event) is (JobDone if each is good else JobFailed)
        worker.stop()

    def test_a_worker_that_was_never_started_can_be_stopped(self) -> None:
        ThreadWorker(JobRunner(SITE), lambda event: None).stop()
