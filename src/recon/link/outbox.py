"""What waits to be sent to one app: three places, each holding the newest order of its kind.

Emergency orders overtake everything and take unsent motion with them; a newer motion order (mission
or stick) replaces an unsent older one; a newer camera order likewise. So the queue is bounded, and
what leaves it unsent is always told.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

from recon.model.command import CAMERA_BODIES, Command, Phase
from recon.model.event import CommandDropped
from recon.safety import ApprovedCommand


class Lane(IntEnum):
    """The places, the most urgent first."""

    EMERGENCY = 0
    MOTION = 1
    CAMERA = 2


def lane_of(command: Command) -> Lane:
    """Return the place a command waits in."""
    if command.is_emergency:
        return Lane.EMERGENCY
    return Lane.CAMERA if isinstance(command.body, CAMERA_BODIES) else Lane.MOTION


@dataclass(slots=True)
class Outbox:
    """The unsent orders of one link."""

    link_id: int
    _places: dict[Lane, ApprovedCommand]

    @classmethod
    def empty(cls, link_id: int) -> "Outbox":
        """Return an outbox with nothing in it."""
        return cls(link_id, {})

    def __len__(self) -> int:
        return len(self._places)

    def put(self, approved: ApprovedCommand) -> list[CommandDropped]:
        """Queue an order; return the unsent ones it displaces."""
        lane = lane_of(approved.command)
        displaced = {lane, Lane.MOTION} if lane is Lane.EMERGENCY else {lane}
        dropped = [
            self._dropped(old, Phase.SUPERSEDED, f"by order {approved.command.id}, before sending")
            for key in sorted(displaced)
            if (old := self._places.pop(key, None)) is not None
            and old.command.id != approved.command.id
        ]
        self._places[lane] = approved
        return dropped

    def expire(self, now_ns: int) -> list[CommandDropped]:
        """Remove and return the orders whose time is over."""
        late = [k for k, a in self._places.items() if now_ns >= a.command.expires_at_ns]
        return [
            self._dropped(self._places.pop(lane), Phase.EXPIRED, "not sent in time")
            for lane in late
        ]

    def waiting(self, lane: Lane) -> ApprovedCommand | None:
        """Return the order in a place, which stays there."""
        return self._places.get(lane)

    def take(self, may_go: Callable[[Lane, ApprovedCommand], bool]) -> ApprovedCommand | None:
        """Remove and return the most urgent order that may go now."""
        if not self._places:
            return None
        for lane in Lane:
            waiting = self._places.get(lane)
            if waiting is not None and may_go(lane, waiting):
                return self._places.pop(lane)
        return None

    def withdraw(self, lane: Lane, reason: str) -> list[CommandDropped]:
        """Remove and return what waits in one place: nothing takes its place."""
        old = self._places.pop(lane, None)
        return [] if old is None else [self._dropped(old, Phase.SUPERSEDED, reason)]

    def empty_out(self, reason: str) -> list[CommandDropped]:
        """Remove everything; nothing is ever sent again by itself after a reconnect."""
        dropped = [self._dropped(a, Phase.FAILED, reason) for a in self._places.values()]
        self._places.clear()
        return dropped

    def _dropped(self, approved: ApprovedCommand, phase: Phase, reason: str) -> CommandDropped:
        return CommandDropped(self.link_id, approved.command.id, phase, reason)
