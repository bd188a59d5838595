"""Methods of installed packages run in a process of their own, each job within a time limit.

A thread cannot be ended, a process can: a method that never returns, or that ends its process,
costs the job that it was given. The next process starts meanwhile; jobs that come before it is
ready fail at once, so that no other job waits for it.
"""

import multiprocessing
import pickle
import signal
from collections.abc import Callable
from importlib import import_module
from io import BytesIO
from multiprocessing.connection import Connection
from types import MappingProxyType
from typing import Any

from recon.model.errors import ReconError, describe_fault
from recon.model.methods import MethodError
from recon.processes.parent import end_with_parent

LIMIT_S = 2.0
"""Longest time of one job: other jobs wait for it, and a survey is stepped once a second."""
STARTS_WITHIN_S = 30.0
"""Longest time until the first process is ready: it imports what the station has imported."""
READY = b"ready"


class MethodProcess:
    """One process beside the station; it is started with the first job."""

    def __init__(self, limit_s: float = LIMIT_S) -> None:
        self.limit_s = limit_s
        self._process: Any = None
        self._connection: Connection | None = None
        self._is_ready = False
        self._waits_s = STARTS_WITHIN_S
        self._newest_end = ""

    def run(self, work: Callable[[Any], Any], given: Any, method: str) -> Any:
        """Return `work(given)` of the process; `work` is a module's function.

        Raises `MethodError` for a method that raises, is late or ends its process.
        """
        connection = self._ready_connection(method)
        try:
            connection.send_bytes(packed((work, given)))
            if not connection.poll(self.limit_s):
                raise self._ended(
                    f"the method {method} took longer than {self.limit_s:g} s, and was ended"
                )
            is_done, result = pickle.loads(connection.recv_bytes())
        except (EOFError, OSError) as problem:
            raise self._ended(f"the method {method} has ended its process: {problem!r}") from None
        if not is_done:
            raise MethodError(f"the method {method} failed: {result}")
        return result

    def _ended(self, why: str) -> MethodError:
        self.stop()
        self._newest_end = f"{why}; its process is starting again"
        return MethodError(why)

    def stop(self) -> None:
        """End the process; the next job starts another one."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
        if self._connection is not None:
            self._connection.close()
        self._process = self._connection = None
        self._is_ready = False

    def _ready_connection(self, method: str) -> Connection:
        if self._connection is None:
            self._start()
        assert self._connection is not None  # or it was not started
        if not self._is_ready:
            if not self._connection.poll(self._waits_s):
                raise MethodError(self._newest_end or f"the process of {method} does not start")
            self._connection.recv_bytes()
            # Only the first start is waited for: later ones follow a method's failure.
            self._is_ready, self._waits_s = True, 0.0
        return self._connection

    def _start(self) -> None:
        # Forked processes would inherit threads of the linear algebra in any state.
        context = multiprocessing.get_context("spawn")
        self._connection, other = context.Pipe()
        self._process = context.Process(target=_serve, args=(other,), daemon=True)
        self._process.start()
        other.close()


class _JobPickler(pickle.Pickler):
    """Pickles read-only mappings too, of which frozen state is made."""

    def reducer_override(self, value: Any) -> Any:
        if isinstance(value, MappingProxyType):
            return _read_only, (dict(value),)
        return NotImplemented


def _read_only(values: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    """Return a read-only mapping: its own type cannot be named in a pickle."""
    return MappingProxyType(values)


def packed(value: Any) -> bytes:
    """Return a value for the other process."""
    data = BytesIO()
    _JobPickler(data, pickle.HIGHEST_PROTOCOL).dump(value)
    return data.getvalue()


def _serve(connection: Connection) -> None:
    """Answer jobs until the station ends: the process's own function."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the station stops it
    end_with_parent()
    # What jobs import: the first one is not to count as late for it.
    import_module("recon.station.imaging.shade")
    import_module("recon.station.operations.survey.planning")
    connection.send_bytes(READY)
    while True:
        try:
            work, given = pickle.loads(connection.recv_bytes())
        except (EOFError, OSError):
            return
        connection.send_bytes(_answer(work, given))


def _answer(work: Callable[[Any], Any], given: Any) -> bytes:
    try:
        return packed((True, work(given)))
    except (ReconError, ValueError) as problem:
        return packed((False, str(problem)))
    except Exception as problem:  # a method of another package may raise anything
        return packed((False, describe_fault(problem)))
