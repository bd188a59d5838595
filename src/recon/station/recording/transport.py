"""Position of a replay: a clock that plays at any speed, pauses, and jumps.

Theory of operation. Two states:

    paused --play, not at the end--> playing
    playing --pause, or the end is reached--> paused

In both a seek sets the position; playing continues from there. The position is a function of the
computer's monotonic time, which is an argument.
"""

from dataclasses import dataclass, replace

from recon.model.units import seconds_to_ns

SLOWEST, FASTEST = 0.1, 50.0


@dataclass(frozen=True, slots=True)
class Transport:
    """A position in a record, as of a moment of the computer's clock."""

    begins_ns: int
    ends_ns: int
    at_ns: int
    """The position as of `since_s`."""
    since_s: float = 0.0
    speed: float = 1.0
    is_playing: bool = False

    def position_ns(self, now_s: float) -> int:
        """Return the position, in station time of the record."""
        if not self.is_playing:
            return self.at_ns
        return min(self.ends_ns, self.at_ns + seconds_to_ns((now_s - self.since_s) * self.speed))

    def as_of(self, now_s: float) -> "Transport":
        """Return the same, counted from this moment on; at the end it is paused."""
        at_ns = self.position_ns(now_s)
        is_playing = self.is_playing and at_ns < self.ends_ns
        return replace(self, at_ns=at_ns, since_s=now_s, is_playing=is_playing)

    def played(self, now_s: float) -> "Transport":
        """Return it playing; from the end it plays from the beginning again."""
        now = self.as_of(now_s)
        at_ns = now.begins_ns if now.at_ns >= now.ends_ns else now.at_ns
        return replace(now, at_ns=at_ns, is_playing=now.begins_ns < now.ends_ns)

    def paused(self, now_s: float) -> "Transport":
        """Return it paused where it is."""
        return replace(self.as_of(now_s), is_playing=False)

    def at_speed(self, speed: float, now_s: float) -> "Transport":
        """Return it with another speed; raises `ValueError` outside 0.1 to 50."""
        if not SLOWEST <= speed <= FASTEST:
            raise ValueError(f"speed must be {SLOWEST} to {FASTEST:g}; got {speed:g}")
        return replace(self.as_of(now_s), speed=speed)

    def sought(self, at_ns: int, now_s: float) -> "Transport":
        """Return it at another position, the nearest one within the record."""
        at_ns = min(max(at_ns, self.begins_ns), self.ends_ns)
        return replace(self, at_ns=at_ns, since_s=now_s)
