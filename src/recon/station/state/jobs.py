"""Heavy work for the worker: what a kind of job is, one job, and the events that end it.

A room that needs heavy work declares one `JobKind` beside the code that starts its jobs. Nothing
else has to know the kind: the worker runs it, and the step hands its end to the kind's own
functions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Generic, TypeVar

from recon.model.event import JobEnded
from recon.site import Site

if TYPE_CHECKING:
    from recon.station.state.station import Station
    from recon.station.state.stepped import Stepped

InputT = TypeVar("InputT")
ResultT = TypeVar("ResultT")


@dataclass(frozen=True, slots=True, eq=False)
class JobKind(Generic[InputT, ResultT]):
    """One kind of heavy work.

    `prepare` returns for a site the function that does the work, on the worker's thread. The other
    three are steps of the station: the result arrived, the work raised an error (its text), or the
    worker dropped the job for a newer one of the same kind.
    """

    name: str
    prepare: Callable[[Site], Callable[[InputT], ResultT]] = field(repr=False)
    done: Callable[[Station, int, ResultT, int], Stepped] = field(repr=False)
    failed: Callable[[Station, int, str, int], Stepped] = field(repr=False)
    dropped: Callable[[Station, int, int], Stepped] = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False)
class Job(Generic[InputT, ResultT]):
    """One piece of heavy work to start. `id` is unique among the jobs of its kind."""

    id: int
    kind: JobKind[InputT, ResultT]
    input: InputT


@dataclass(frozen=True, slots=True, eq=False)
class JobDone(JobEnded, Generic[InputT, ResultT]):
    """A job's result."""

    kind: JobKind[InputT, ResultT]
    result: ResultT


@dataclass(frozen=True, slots=True, eq=False)
class JobFailed(JobEnded, Generic[InputT, ResultT]):
    """A job raised an error."""

    kind: JobKind[InputT, ResultT]
    error: str


@dataclass(frozen=True, slots=True)
class JobDropped(JobEnded, Generic[InputT, ResultT]):
    """The worker dropped a job that had not begun, for a newer one of the same kind."""

    kind: JobKind[InputT, ResultT]
