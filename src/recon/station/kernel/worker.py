"""The port for heavy work, and the thread that does it beside the event loop.

Work of one kind waits in one place: newer work drops the older that has not begun, and says so with
`DeadlineMissed`. Results come back as events, so that the core never waits.
"""

import threading
from collections.abc import Callable, Mapping
from typing import Protocol

from recon.model.errors import ReconError
from recon.model.event import DeadlineMissed, Event, WorkerResult
from recon.station.state.outputs import StartWork

Task = Callable[[object], object]
"""Does one kind of work: payload in, result out. What it raises is told as the result's error."""


class Worker(Protocol):
    """Whatever does heavy work."""

    def submit(self, work: StartWork) -> None:
        """Take work; its result, or its failure, comes back as an event."""


def do_work(tasks: Mapping[str, Task], work: StartWork) -> WorkerResult:
    """Do one piece of work now."""
    task = tasks.get(work.kind)
    if task is None:
        return WorkerResult(work.job_id, work.kind, None, f"nobody does {work.kind} here")
    try:
        return WorkerResult(work.job_id, work.kind, task(work.payload))
    except (ReconError, ValueError) as problem:
        return WorkerResult(work.job_id, work.kind, None, str(problem))
    except Exception as problem:
        # A fault in one frame's work must not end the thread that does all the others.
        text = f"{type(problem).__name__}: {problem}"
        return WorkerResult(work.job_id, work.kind, None, text)


class ThreadWorker:
    """Does work on one thread of its own. `deliver` is called there with each event."""

    def __init__(self, tasks: Mapping[str, Task], deliver: Callable[[Event], None]) -> None:
        self._tasks = dict(tasks)
        self._deliver = deliver
        self._waiting: dict[str, StartWork] = {}
        self._changed = threading.Condition()
        self._is_stopping = False
        self._thread = threading.Thread(target=self._run, name="worker", daemon=True)

    def start(self) -> None:
        """Begin to work."""
        self._thread.start()

    def stop(self) -> None:
        """Finish the work in hand and end."""
        with self._changed:
            self._is_stopping = True
            self._changed.notify()
        if self._thread.is_alive():
            self._thread.join()

    def submit(self, work: StartWork) -> None:
        """Queue work; the same kind's older work that has not begun is dropped."""
        with self._changed:
            older = self._waiting.pop(work.kind, None)
            self._waiting[work.kind] = work
            self._changed.notify()
        if older is not None:
            self._deliver(DeadlineMissed(older.job_id, older.kind, "newer work came"))

    def _run(self) -> None:
        while (work := self._next()) is not None:
            self._deliver(do_work(self._tasks, work))

    def _next(self) -> StartWork | None:
        with self._changed:
            while not self._waiting and not self._is_stopping:
                self._changed.wait()
            if self._is_stopping:
                return None
            return self._waiting.pop(next(iter(self._waiting)))
