"""Which of one vehicle's faults are on, and what they do to what is said: all drawn from a seed."""

from collections.abc import Iterable
from random import Random

from recon.model.units import seconds_to_ns
from recon.sim.app.faults import Fault, FaultKind

BURST_S = 1.5
"""Telemetry in the field comes in bursts, with a second and more of nothing while video runs."""
ACK_DELAY_S = (0.5, 3.0)
"""Longer than the station waits before it sends an order again, now and then."""
CORRUPTED_SHARE = 0.1
"""Of packets; each has then one to three bytes changed."""
MOST_CHANGED_BYTES = 3


class FaultPlan:
    """The faults of one vehicle, since `start_ns`."""

    def __init__(self, faults: Iterable[Fault], seed: str, start_ns: int) -> None:
        self._by_kind: dict[FaultKind, list[Fault]] = {}
        for fault in faults:
            self._by_kind.setdefault(fault.kind, []).append(fault)
        self._start_ns = start_ns
        self._delays = Random(f"{seed}/delays")
        self._changes = Random(f"{seed}/changes")

    def active(self, kind: FaultKind, now_ns: int) -> Fault | None:
        """Return the fault of a kind that is on, the last told of several, else None."""
        faults = self._by_kind.get(kind) if self._by_kind else None
        if faults is None:
            return None
        elapsed_ns = now_ns - self._start_ns
        on = [fault for fault in faults if fault.is_active(elapsed_ns)]
        return on[-1] if on else None

    def has(self, kind: FaultKind, now_ns: int) -> bool:
        """Return whether a fault of a kind is on."""
        return self.active(kind, now_ns) is not None

    def sent_ns(self, now_ns: int) -> int:
        """Return when what is said now goes out: at once, or with its burst."""
        fault = self.active(FaultKind.BURSTS, now_ns)
        if fault is None:
            return now_ns
        burst_ns = seconds_to_ns(BURST_S)
        begin_ns = self._start_ns + seconds_to_ns(fault.start_s)
        whole = (now_ns - begin_ns) // burst_ns + 1
        ends_ns = fault.end_ns(self._start_ns)
        due_ns = begin_ns + whole * burst_ns
        return due_ns if ends_ns is None else min(due_ns, ends_ns)

    def answered_ns(self, now_ns: int) -> int:
        """Return when an acknowledgment of now goes out."""
        if not self.has(FaultKind.DELAYED_ACKS, now_ns):
            return self.sent_ns(now_ns)
        return self.sent_ns(now_ns) + seconds_to_ns(self._delays.uniform(*ACK_DELAY_S))

    def on_the_way(self, packet: bytes, now_ns: int) -> bytes:
        """Return a packet's bytes as they leave, in whole or damaged."""
        if not self.has(FaultKind.CORRUPTED_BYTES, now_ns):
            return packet
        if self._changes.random() >= CORRUPTED_SHARE:
            return packet
        changed = bytearray(packet)
        for _ in range(self._changes.randint(1, MOST_CHANGED_BYTES)):
            changed[self._changes.randrange(len(changed))] ^= self._changes.randint(1, 255)
        return bytes(changed)
