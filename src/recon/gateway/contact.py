"""Whether states of the station come: a line where that changes."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime

from recon.model.vehicle import LIVE_UNDER_S


def time_of_day(at_s: float) -> str:
    """Return a monotonic time as a clock on the wall shows it."""
    return f"{datetime.fromtimestamp(time.time() - time.monotonic() + at_s):%H:%M:%S}"


@dataclass(slots=True)
class StationContact:
    """The contact with the station, which is there at first.

    It is lost with the age at which no vehicle is shown any more: that of telemetry.
    """

    clock: Callable[[float], str] = time_of_day
    """Shows a monotonic time as one of the day."""
    _lost_since_s: float | None = None

    @property
    def is_lost(self) -> bool:
        """Whether it was lost at the last look."""
        return self._lost_since_s is not None

    def change(self, newest_s: float, now_s: float) -> str | None:
        """Return a line when contact is lost or back, else None.

        `newest_s` and `now_s` are of one monotonic clock: when the newest state was created, and
        now.
        """
        is_lost = now_s - newest_s >= LIVE_UNDER_S
        since_s, was_lost = self._lost_since_s, self.is_lost
        self._lost_since_s = (since_s if was_lost else newest_s) if is_lost else None
        if is_lost and not was_lost:
            return (
                f"station unreachable since {self.clock(newest_s)}: "
                "no vehicle is shown until it is back"
            )
        if since_s is not None and not is_lost:
            at = self.clock(now_s)
            return f"station connected again at {at}, after {newest_s - since_s:.0f} s"
        return None
