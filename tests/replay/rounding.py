"""What a flight that was recorded on another processor may differ in: the last bits of numbers."""

from math import isclose
from typing import Any

from recon.station.recording.recorded_values import FlightStart, this_machine
from recon.station.recording.replay import Checked, Difference


def was_here(start: FlightStart | None) -> bool:
    """Whether a flight was recorded on a processor like this: then it is the same to the bit."""
    return start is not None and start.machine == this_machine()


def changes(found: Checked) -> list[Difference]:
    """The differences that count: not those of rounding, in a flight from elsewhere."""
    is_here = was_here(found.start)
    return [d for d in found.differences if is_here or not is_same(d.recorded, d.now)]


def is_same(recorded: Any, now: Any) -> bool:
    """Whether values differ at most in the last bits of their numbers: processors compute sines by
    instructions of their own."""
    match recorded, now:
        case float(), float():
            return recorded == now or isclose(recorded, now, rel_tol=1e-13)
        case list(), list():
            return len(recorded) == len(now) and all(map(is_same, recorded, now))
        case dict(), dict():
            return recorded.keys() == now.keys() and all(is_same(recorded[k], now[k]) for k in now)
        case _:
            return bool(recorded == now)
