"""The worker: one thread beside the event loop that runs heavy jobs.

One job of each kind waits at most: a newer one drops the older that has not begun, which the
station learns as `JobDropped`. Results come back as events, so the step never waits.
"""

import gc
import threading
from collections.abc import Callable
from importlib import import_module
from typing import Any, Protocol

import cv2

from recon.model.errors import ReconError
from recon.model.event import Event
from recon.record.mcap.digest import digest
from recon.site import Site
from recon.station.kernel.method_process import MethodProcess
from recon.station.state.steps import (
    InputT,
    Job,
    JobDone,
    JobDropped,
    JobFailed,
    JobKind,
    ResultT,
)

AnyJob = Job[Any, Any]

JOB_LIBRARIES = (
    *("scipy.fft", "scipy.ndimage", "scipy.optimize", "scipy.sparse.linalg"),
    *("scipy.spatial.transform", "rasterio", "pyproj"),
)
"""Libraries that jobs import where they use them, so that a station starts without them."""
LOAD_AFTER_S = 2.0
"""An idle worker then loads them: a job does not wait, and the start is over."""


class Worker(Protocol):
    """Anything that runs heavy jobs."""

    def submit(self, job: AnyJob) -> None:
        """Take a job; its end comes back as an event."""


class JobRunner:
    """Runs jobs for one site, one at a time."""

    def __init__(self, site: Site, *, isolates: bool = False) -> None:
        """`isolates`: methods of installed packages run in processes that end when they are late.
        A run in virtual time has no clock to be late by."""
        cv2.setNumThreads(1)
        self.digests_inputs = False
        """Whether the end of a job has a digest of its input: a record asks for it."""
        self._site = site
        self._prepared: dict[JobKind[Any, Any], Callable[[Any], Any]] = {}
        self._isolates = isolates
        self._processes: dict[JobKind[Any, Any], MethodProcess] = {}

    def replace(self, kind: JobKind[InputT, ResultT], run: Callable[[InputT], ResultT]) -> None:
        """Run jobs of a kind by another function: scores put the simulator's truth here."""
        self._prepared[kind] = run

    def run(self, job: Job[InputT, ResultT]) -> Event:
        """Run one job now; what it raises is the error of its event."""
        found = digest(job.input).hex() if self.digests_inputs else ""
        try:
            prepared = self._prepared.get(job.kind)
            if prepared is None:
                prepared = self._prepared[job.kind] = job.kind.prepare(self._site)
            method = job.kind.outside(job.input) if self._isolates else ""
            if method:
                process = self._processes.setdefault(job.kind, MethodProcess())
                result = process.run(prepared, job.input, method)
            else:
                result = prepared(job.input)
            return JobDone(job.id, job.kind, result, input_digest=found)
        except (ReconError, ValueError) as problem:
            return JobFailed(job.id, job.kind, str(problem), input_digest=found)
        except Exception as problem:
            # A fault in one frame's job must not end the thread that runs all the others.
            error = f"{type(problem).__name__}: {problem}"
            return JobFailed(job.id, job.kind, error, input_digest=found)

    def stop(self) -> None:
        """End the processes of methods."""
        for process in self._processes.values():
            process.stop()


class ThreadWorker:
    """Runs jobs on a thread of its own. `deliver` is called on that thread with each event."""

    def __init__(self, runner: JobRunner, deliver: Callable[[Event], None]) -> None:
        self._runner = runner
        self._deliver = deliver
        self._waiting: dict[JobKind[Any, Any], AnyJob] = {}
        self._changed = threading.Condition()
        self._is_stopping = False
        self._thread = threading.Thread(target=self._run, name="worker", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """Finish the job that is running and end the thread, and the runner's processes."""
        with self._changed:
            self._is_stopping = True
            self._changed.notify()
        if self._thread.is_alive():
            self._thread.join()
        self._runner.stop()

    def submit(self, job: AnyJob) -> None:
        """Queue a job; an older one of its kind that has not begun is dropped."""
        with self._changed:
            older = self._waiting.pop(job.kind, None)
            self._waiting[job.kind] = job
            self._changed.notify()
        if older is not None:
            self._deliver(JobDropped(older.id, older.kind))

    def _run(self) -> None:
        with self._changed:
            is_busy = self._changed.wait_for(self._has_work, LOAD_AFTER_S)
        if not is_busy:
            for name in JOB_LIBRARIES:
                import_module(name)
            gc.freeze()
        while (job := self._next()) is not None:
            self._deliver(self._runner.run(job))

    def _has_work(self) -> bool:
        return self._is_stopping or bool(self._waiting)

    def _next(self) -> AnyJob | None:
        with self._changed:
            self._changed.wait_for(self._has_work)
            if self._is_stopping:
                return None
            return self._waiting.pop(next(iter(self._waiting)))
