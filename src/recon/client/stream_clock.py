"""When a message was made, in this computer's time, though it may have waited on its way.

A program that is busy leaves messages in the socket's buffers; what it reads then is old, though it
has just arrived. The station's clock and ours count from different beginnings. The fastest message
of the last minute or two gives the difference; what took longer than that one was delayed.
"""

from dataclasses import dataclass

from recon.model.units import NS_PER_S

WINDOW_NS = 60 * NS_PER_S
"""Clocks drift apart by some 50 millionths: 6 ms in two windows, which an age can bear."""


@dataclass(slots=True)
class StreamClock:
    """Turns station time into ours. Delays of the fastest message itself are not seen."""

    _run_started_ns: int | None = None
    _window_began_ns: int = 0
    _least_ns: int = 0
    _least_before_ns: int = 0

    def made_at_ns(self, time_ns: int, run_started_ns: int, arrived_at_ns: int) -> int:
        """Return when a message of station time `time_ns` was made; never later than it arrived."""
        offset_ns = arrived_at_ns - time_ns
        if run_started_ns != self._run_started_ns:
            self._run_started_ns = run_started_ns
            self._window_began_ns = arrived_at_ns
            self._least_ns = self._least_before_ns = offset_ns
        elif arrived_at_ns - self._window_began_ns > WINDOW_NS:
            self._window_began_ns = arrived_at_ns
            self._least_before_ns, self._least_ns = self._least_ns, offset_ns
        self._least_ns = min(self._least_ns, offset_ns)
        return time_ns + min(self._least_ns, self._least_before_ns)
