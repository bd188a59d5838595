"""What all links share: memory for half-received packets, and an alarm for each limit reached.

Theory of operation. Half-received packets of all links have one budget. Beyond it the oldest
unidentified link that holds more than its share is closed; without one the largest half-received
packet is dropped, and its link stays, because it may carry orders. Each limit is one alarm,
however often it is reached: that of the places ends when one is free, that of the memory when
nothing was dropped for `limit_alarm_s`.
"""

from collections.abc import Callable
from typing import NamedTuple

from recon.link.settings import MIB
from recon.model.event import LinkLimitReached
from recon.model.units import seconds_to_ns

PLACES, MEMORY = "places", "memory"
"""The limits, in `LinkLimitReached`."""


class OverBudget(NamedTuple):
    """The link whose half-received packet must go, why, and the alarm's sentence."""

    link_id: int
    reason: str
    problem: str


class BufferBudget:
    """Counts the memory of half-received packets by link."""

    def __init__(self, limit_bytes: int, max_links: int) -> None:
        self._limit_bytes = limit_bytes
        self._fair_bytes = limit_bytes // max_links
        self._held_bytes: dict[int, int] = {}
        self._total_bytes = 0

    def note(self, link_id: int, held_bytes: int) -> None:
        """Account for what a link holds now."""
        self._total_bytes += held_bytes - self._held_bytes.pop(link_id, 0)
        if held_bytes:
            self._held_bytes[link_id] = held_bytes

    def to_free(self, is_identified: Callable[[int], bool]) -> OverBudget | None:
        """Return what must go first; None within the budget."""
        if self._total_bytes <= self._limit_bytes:
            return None
        unidentified = [
            link_id
            for link_id, held_bytes in self._held_bytes.items()
            if held_bytes > self._fair_bytes and not is_identified(link_id)
        ]
        # Link numbers ascend: the smallest is the oldest.
        link_id = min(unidentified, default=None)
        if link_id is None:
            link_id = max(self._held_bytes, key=lambda held: self._held_bytes[held])
        reason = (
            "half-received packets take too much memory "
            f"({self._held_bytes[link_id] // MIB} MiB here, "
            f"limit {self._limit_bytes // MIB} MiB for all links)"
        )
        what = f"unidentified link {link_id} closed"
        if is_identified(link_id):
            what = f"half-received packet of link {link_id} dropped"
        problem = f"{what}: {reason}: check which app sends incomplete images"
        return OverBudget(link_id, reason, problem)


class LimitAlarms:
    """Which limits are reached: one event when it begins, one when it is over."""

    def __init__(self, lingers_s: float) -> None:
        self._lingers_ns = seconds_to_ns(lingers_s)
        self._reached_at_ns: dict[str, int] = {}

    def reached(self, limit: str, problem: str, now_ns: int) -> LinkLimitReached | None:
        """Note that a limit is reached; return the event unless it already was."""
        is_new = limit not in self._reached_at_ns
        self._reached_at_ns[limit] = now_ns
        return LinkLimitReached(limit, problem) if is_new else None

    def over(self, now_ns: int, *, has_places: bool) -> list[LinkLimitReached]:
        """Return the ends of the limits that are no longer reached."""
        memory_ns = self._reached_at_ns.get(MEMORY, now_ns)
        is_over = {PLACES: has_places, MEMORY: now_ns - memory_ns > self._lingers_ns}
        ended = [limit for limit in self._reached_at_ns if is_over[limit]]
        for limit in ended:
            del self._reached_at_ns[limit]
        return [LinkLimitReached(limit, None) for limit in ended]
