"""The driver on real sockets and the real clock: asyncio around the pure step."""

import asyncio
import gc
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from recon.fleet.step import CloseLink
from recon.link.server import LinkServer
from recon.model.errors import described
from recon.model.event import ClockRead, Event, StationFaulted, SticksDue, Tick
from recon.model.units import NS_PER_S
from recon.station.kernel.event_queue import EventQueue
from recon.station.kernel.fault_isolation import after_fault
from recon.station.kernel.step import TICK_PARTS, step
from recon.station.kernel.worker import Worker
from recon.station.state.jobs import Job
from recon.station.state.outputs import Output, SendCommand, WithdrawMotion
from recon.station.state.station import Station
from recon.station.steering.setpoint_streams import next_due_ns

TICK_NS = 50_000_000
"""Twenty times a second: takeovers, repeats and alarms are at most this late."""


CLOCK_NS = 1_000_000_000
"""Once a second it is looked whether somebody has set the computer's clock."""


def station_clock() -> Callable[[], int]:
    """Return a clock of nanoseconds that begins at UTC and never jumps within a run."""
    offset_ns = time.time_ns() - time.monotonic_ns()
    return lambda: offset_ns + time.monotonic_ns()


def spare_what_is_loaded() -> None:
    """Take everything loaded so far out of the garbage collector's rounds.

    Libraries are hundreds of thousands of objects that live as long as the process. Looking through
    them stopped the event loop for 40 ms every few seconds, an emergency order with it.
    """
    gc.collect()
    gc.freeze()


class AsyncioDriver:
    """Runs the station: every event goes through one queue, in order, on one thread."""

    def __init__(
        self,
        station: Station,
        now_ns: Callable[[], int],
        observe: Callable[[Station, Station, Event], None] | None = None,
    ) -> None:
        self.station = station
        self.observe = observe
        self.now_ns = now_ns
        self.started_at_ns = now_ns()
        self.links: LinkServer | None = None
        self.worker: Worker | None = None
        self._queue = EventQueue(self._step)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._tick_ns = self._clock_ns = 0

    def handle(self, event: Event) -> None:
        """Take an event; what a step's outputs cause is queued behind it."""
        self._queue.put(event)

    def handle_from_thread(self, event: Event) -> None:
        """Take an event from another thread."""
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self.handle, event)

    async def run(self) -> None:
        """Let time pass until cancelled."""
        self._loop = asyncio.get_running_loop()
        self._loop.set_exception_handler(self._unhandled)
        self._tick_ns = self._clock_ns = self.now_ns() + TICK_NS
        while True:
            due_ns = next_due_ns(self.station)
            wake_ns = self._tick_ns if due_ns is None else min(self._tick_ns, due_ns)
            await asyncio.sleep(max(0, wake_ns - self.now_ns()) / NS_PER_S)
            self._let_time_pass(due_ns, self.now_ns())

    def _let_time_pass(self, due_ns: int | None, now_ns: int) -> None:
        if due_ns is not None and now_ns >= due_ns:
            # Sticks go first: what a tick has to do would shift their beat.
            self.handle(SticksDue())
        if now_ns >= self._tick_ns:
            # What was slept through is not caught up with.
            self._tick_ns = max(self._tick_ns + TICK_NS, now_ns)
            if self.links is not None:
                self.links.tick()
            self.handle(Tick())
        if now_ns >= self._clock_ns:
            self._clock_ns = now_ns + CLOCK_NS
            self.handle(ClockRead(time.time_ns()))

    def _unhandled(self, _loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Take what nobody else has caught in the loop: an alarm, not a traceback."""
        fault = context.get("exception")
        what = str(context.get("message")) if fault is None else described(fault)
        self.handle(StationFaulted("in its event loop", what))

    def _step(self, event: Event) -> None:
        before, now_ns = self.station, self.now_ns()
        try:
            self.station, outputs = step(before, event, now_ns)
        except Exception as fault:
            self.station, outputs = after_fault(TICK_PARTS, before, event, fault, now_ns)
        with self._contained("writing the audit", event):
            if self.observe is not None:
                self.observe(before, self.station, event)
        for output in outputs:
            with self._contained(f"carrying out {type(output).__name__}", event):
                self._carry_out(output)

    @contextmanager
    def _contained(self, where: str, event: Event) -> Iterator[None]:
        """Make an alarm of a fault; but not of one that came of telling a fault."""
        try:
            yield
        except Exception as fault:
            if not isinstance(event, StationFaulted):
                self._queue.put(StationFaulted(where, described(fault)))

    def _carry_out(self, output: Output) -> None:
        match output:
            case SendCommand(approved):
                if self.links is not None:
                    self.links.send(approved)
            case WithdrawMotion(link_ids, reason):
                if self.links is not None:
                    self.links.withdraw_motion(link_ids, reason)
            case CloseLink(link_id, reason):
                if self.links is not None:
                    self.links.close_link(link_id, reason)
            case Job():
                if self.worker is not None:
                    self.worker.submit(output)
