"""Whether states of the station come: a line where that changes."""

from collections.abc import Callable
from dataclasses import dataclass

from recon.model.vehicle import LIVE_UNDER_S


@dataclass(slots=True)
class StationContact:
    """The contact with the station, which is there at first.

    It is lost with the age at which no vehicle is shown any more: that of telemetry.
    """

    _lost_since_s: float | None = None

    def change(self, newest_s: float, now_s: float, clock: Callable[[float], str]) -> str | None:
        """Return a line when contact is lost or back, else None.

        `newest_s` and `now_s` are of one monotonic clock: when the newest state was created, and
        now. `clock` shows such a time as one of the day.
        """
        is_lost = now_s - newest_s >= LIVE_UNDER_S
        since_s, was_lost = self._lost_since_s, self._lost_since_s is not None
        self._lost_since_s = (since_s if was_lost else newest_s) if is_lost else None
        if is_lost and not was_lost:
            return (
                f"station unreachable since {clock(newest_s)}: no vehicle is shown until it is back"
            )
        if since_s is not None and not is_lost:
            return f"station connected again at {clock(now_s)}, after {newest_s - since_s:.0f} s"
        return None
