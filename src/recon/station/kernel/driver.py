"""The driver on real sockets and the real clock: asyncio around the pure step."""

import asyncio
import gc
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from recon.fleet.step import CloseLink
from recon.link.server import LinkServer
from recon.model.command import Refusal
from recon.model.errors import describe_fault
from recon.model.event import ClockGap, ClockRead, Event, SetpointsDue, StationFaulted, Tick
from recon.model.units import NS_PER_S
from recon.safety import ApprovedCommand
from recon.station.control import dispatch
from recon.station.kernel.event_queue import EventQueue
from recon.station.kernel.fault_isolation import after_fault
from recon.station.kernel.step import TICK_PARTS, step
from recon.station.kernel.worker import Worker
from recon.station.state.station import Station
from recon.station.state.steps import Job, Output, SendCommand, StepTaken, WithdrawMotion
from recon.station.steering.setpoint_streams import next_due_ns

TICK_NS = 50_000_000
"""Twenty times a second: takeovers, repeats and alarms are at most this late."""

CLOCK_NS = 1_000_000_000
"""How often the computer's clock is read: a user or NTP may set it."""


GAP_NS = 1_000_000_000
"""Twenty ticks missed: what is in the sockets is old, and vehicles have flown on."""


def station_clock() -> Callable[[], int]:
    """Return a clock in nanoseconds that starts at UTC and is never set within a run.

    It counts while the computer sleeps, so that orders expire and telemetry ages: Linux has a clock
    of its own for that, elsewhere the monotonic clock does.
    """
    counted_ns = _sleep_counting_ns()
    offset_ns = time.time_ns() - counted_ns()
    return lambda: offset_ns + counted_ns()


def _sleep_counting_ns() -> Callable[[], int]:
    """Windows has one monotonic clock without a name."""
    for name in ("CLOCK_BOOTTIME", "CLOCK_MONOTONIC"):
        if hasattr(time, name):
            return partial(time.clock_gettime_ns, getattr(time, name))
    return time.monotonic_ns


def freeze_loaded_objects() -> None:
    """Exclude everything loaded so far from garbage collection.

    Libraries are hundreds of thousands of objects that live as long as the process. Scanning them
    stopped the event loop for 40 ms every few seconds, and delayed emergency orders by as much.
    """
    gc.collect()
    gc.freeze()


class AsyncioDriver:
    """Runs the station: every event goes through one queue, in order, on one thread."""

    def __init__(
        self,
        station: Station,
        now_ns: Callable[[], int],
        observe: Callable[[StepTaken], None] | None = None,
    ) -> None:
        self.station = station
        self.observe = observe
        """Called with every step, before its outputs are carried out."""
        self.record: Callable[[StepTaken], None] | None = None
        """Called with every step, after its outputs are carried out."""
        self.now_ns = now_ns
        self.started_at_ns = now_ns()
        self.links: LinkServer | None = None
        self.worker: Worker | None = None
        self._queue = EventQueue(self._step)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._tick_ns = self._clock_ns = 0
        self._stepped_at_ns: int | None = None
        """Time of the last stepped event, from the first tick on."""

    def handle(self, event: Event) -> None:
        """Queue an event and step by it; events caused by its outputs are queued behind it."""
        self._queue.put(event)

    def objection(self, approved: ApprovedCommand) -> Refusal | None:
        """Return why an approved order may not be sent at this moment, else None."""
        return dispatch.objection(self.station, approved, self.now_ns())

    def handle_from_thread(self, event: Event) -> None:
        """Queue an event from another thread."""
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self.handle, event)

    async def run(self) -> None:
        """Run the timers until cancelled."""
        self._loop = asyncio.get_running_loop()
        self._loop.set_exception_handler(self._unhandled)
        self._tick_ns = self._clock_ns = self.now_ns() + TICK_NS
        while True:
            due_ns = next_due_ns(self.station)
            wake_ns = self._tick_ns if due_ns is None else min(self._tick_ns, due_ns)
            await asyncio.sleep(max(0, wake_ns - self.now_ns()) / NS_PER_S)
            self._run_timers(due_ns, self.now_ns())

    def _run_timers(self, due_ns: int | None, now_ns: int) -> None:
        if due_ns is not None and now_ns >= due_ns:
            # Setpoints go first: a tick's work would delay them.
            self.handle(SetpointsDue())
        if now_ns >= self._tick_ns:
            # Missed ticks are not made up for.
            self._tick_ns = max(self._tick_ns + TICK_NS, now_ns)
            if self.links is not None:
                self.links.tick()
            self.handle(Tick())
        if now_ns >= self._clock_ns:
            self._clock_ns = now_ns + CLOCK_NS
            self.handle(ClockRead(time.time_ns()))

    def _unhandled(self, _loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Turn an uncaught error of the event loop into an alarm."""
        fault = context.get("exception")
        what = str(context.get("message")) if fault is None else describe_fault(fault)
        self.handle(StationFaulted("in its event loop", what))

    def _step(self, event: Event) -> None:
        now_ns, last_ns = self.now_ns(), self._stepped_at_ns
        if last_ns is not None or isinstance(event, Tick):
            self._stepped_at_ns = now_ns
        if last_ns is not None and now_ns - last_ns > GAP_NS:
            # First, because the event may be a packet that waited meanwhile.
            self._step_at(ClockGap((now_ns - last_ns) / NS_PER_S), now_ns)
        self._step_at(event, now_ns)

    def _step_at(self, event: Event, now_ns: int) -> None:
        before = self.station
        try:
            self.station, outputs = step(before, event, now_ns)
        except Exception as fault:
            self.station, outputs = after_fault(TICK_PARTS, before, event, fault, now_ns)
        taken = StepTaken(event, now_ns, before, self.station, outputs)
        with self._isolated("writing the audit", event):
            if self.observe is not None:
                self.observe(taken)
        for output in outputs:
            with self._isolated(f"carrying out {type(output).__name__}", event):
                self._carry_out(output)
        if self.record is not None:
            with self._isolated("recording the flight", event):
                self.record(taken)

    @contextmanager
    def _isolated(self, where: str, event: Event) -> Iterator[None]:
        """Turn a fault into an alarm, except one that came from reporting a fault."""
        try:
            yield
        except Exception as fault:
            if not isinstance(event, StationFaulted):
                self._queue.put(StationFaulted(where, describe_fault(fault)))

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
