"""What a step of the station returns: outputs for the drivers, jobs among them, and its handlers.

A room that needs heavy work declares one `JobKind` beside the code that starts its jobs. Nothing
else has to know the kind: the worker runs it, and the step hands its end to the kind's own
functions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from recon.fleet.step import CloseLink
from recon.model.command import Command, Refusal
from recon.model.event import Event, JobEnded
from recon.safety import ApprovedCommand
from recon.site import Site
from recon.station.state.station import Station

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
    acts: bool = False
    """Whether the work does more than return a result, as writing a file does: a replay takes its
    end as recorded and does not do it again. Its result is None."""
    outside: Callable[[InputT], str] = field(default=lambda _input: "", repr=False)
    """Which method of an installed package the work runs, by name; empty for none."""


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


@dataclass(frozen=True, slots=True)
class SendCommand:
    """Queue an approved command on its links."""

    approved: ApprovedCommand


@dataclass(frozen=True, slots=True)
class WithdrawMotion:
    """Remove unsent motion commands from these links' queues: another holder has control."""

    link_ids: tuple[int, ...]
    reason: str


Output = SendCommand | CloseLink | WithdrawMotion | Job[Any, Any]
"""A `Job` is started by the worker and comes back as an event."""


@dataclass(frozen=True, slots=True, eq=False)
class StepTaken:
    """One step as a driver took it, for the record."""

    event: Event
    now_ns: int
    before: Station
    after: Station
    outputs: tuple[Output, ...]


EventT = TypeVar("EventT")

Stepped = tuple[Station, tuple[Output, ...]]
"""The station after a step, and what the drivers are to do."""

Judge = Callable[[Station, Command], ApprovedCommand | Refusal]
"""The gate's verdict on one command in a station's state."""

Handler = Callable[[Station, Any, int], Stepped]
"""A step for events of one type: station, event, station time in ns."""

Handled = tuple[type[Any], Handler]
"""A type of event and its handler: a row of the step's table."""


def on(kind: type[EventT], handle: Callable[[Station, EventT, int], Stepped]) -> Handled:
    """Return a row of the step's table, with the handler checked against the event's type."""
    return kind, handle


def changing(kind: type[EventT], change: Callable[[Station, EventT, int], Station]) -> Handled:
    """Return a row of the step's table for a handler that has no outputs."""
    return kind, lambda station, event, now_ns: (change(station, event, now_ns), ())
