"""Heavy work beside the loop: results as events, newer work before older, faults contained."""

import threading
from queue import Queue

from recon.model.errors import ReconError
from recon.model.event import DeadlineMissed, Event, WorkerResult
from recon.station.kernel.worker import ThreadWorker, do_work
from recon.station.state.outputs import StartWork

PATIENCE_S = 20.0


def fail_with(problem: Exception) -> object:
    def task(payload: object) -> object:
        raise problem

    return task


class TestOnePiece:
    def test_the_result_comes_back(self) -> None:
        result = do_work({"double": lambda n: 2 * n}, StartWork(7, "double", 21))
        assert (result.job_id, result.kind, result.result, result.error) == (7, "double", 42, None)

    def test_work_that_nobody_does_is_told(self) -> None:
        result = do_work({}, StartWork(1, "paint", None))
        assert result.error == "nobody does paint here"

    def test_a_stated_problem_is_passed_on_as_it_is(self) -> None:
        for problem in (ReconError("the lens is foggy"), ValueError("the lens is foggy")):
            result = do_work({"lay": fail_with(problem)}, StartWork(1, "lay", None))
            assert result.error == "the lens is foggy"

    def test_a_fault_names_its_kind(self) -> None:
        result = do_work({"lay": fail_with(KeyError("x"))}, StartWork(1, "lay", None))
        assert result.error == "KeyError: 'x'"
        assert result.result is None


class TestThread:
    def test_newer_work_drops_older_that_has_not_begun(self) -> None:
        events: Queue[Event] = Queue()
        begun, may_end = threading.Event(), threading.Event()

        def slow(payload: object) -> object:
            begun.set()
            assert may_end.wait(PATIENCE_S)
            return payload

        worker = ThreadWorker({"slow": slow, "quick": lambda p: p}, events.put)
        worker.start()
        worker.submit(StartWork(1, "slow", "a"))
        assert begun.wait(PATIENCE_S)
        worker.submit(StartWork(2, "slow", "b"))
        worker.submit(StartWork(3, "quick", "q"))
        worker.submit(StartWork(4, "slow", "c"))
        dropped = events.get(timeout=PATIENCE_S)
        assert dropped == DeadlineMissed(2, "slow", "newer work came")
        may_end.set()
        done = [events.get(timeout=PATIENCE_S) for _ in range(3)]
        assert all(isinstance(event, WorkerResult) for event in done)
        assert {(e.job_id, e.result) for e in done if isinstance(e, WorkerResult)} == {
            (1, "a"),
            (3, "q"),
            (4, "c"),
        }
        worker.stop()

    def test_a_fault_does_not_end_the_thread(self) -> None:
        events: Queue[Event] = Queue()
        worker = ThreadWorker(
            {"bad": fail_with(RuntimeError("no")), "good": lambda p: p}, events.put
        )
        worker.start()
        for job_id, kind in enumerate(("bad", "good", "bad", "good")):
            worker.submit(StartWork(job_id, kind, job_id))
            event = events.get(timeout=PATIENCE_S)
            assert isinstance(event, WorkerResult)
            assert (event.error is None) == (kind == "good")
        worker.stop()

    def test_stopping_one_that_never_began_is_nothing(self) -> None:
        worker = ThreadWorker({}, lambda event: None)
        worker.stop()
