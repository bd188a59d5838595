"""Unsent orders of one app: three lanes, each holding the newest order of its kind.

Emergency orders overtake everything and drop unsent motion; a newer motion order (mission or stick)
replaces an unsent older one; a newer camera order likewise. So the queue is bounded, and every
order dropped unsent is reported.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

from recon.model.command import CAMERA_BODIES, Command, Phase
from recon.model.event import CommandDropped
from recon.safety import ApprovedCommand


class Lane(IntEnum):
    """The lanes, the most urgent first."""

    EMERGENCY = 0
    MOTION = 1
    CAMERA = 2


def lane_of(command: Command) -> Lane:
    """Return the lane of a command."""
    if command.is_emergency:
        return Lane.EMERGENCY
    return Lane.CAMERA if isinstance(command.body, CAMERA_BODIES) else Lane.MOTION


@dataclass(slots=True)
class Outbox:
    """The unsent orders of one link."""

    link_id: int
    _lanes: dict[Lane, ApprovedCommand]

    @classmethod
    def empty(cls, link_id: int) -> "Outbox":
        """Return an empty outbox."""
        return cls(link_id, {})

    def __len__(self) -> int:
        return len(self._lanes)

    def put(self, approved: ApprovedCommand) -> list[CommandDropped]:
        """Queue an order; return the unsent ones it displaces."""
        lane = lane_of(approved.command)
        displaced = {lane, Lane.MOTION} if lane is Lane.EMERGENCY else {lane}
        dropped = [
            self._dropped(
                old, Phase.SUPERSEDED, f"Replaced by order {approved.command.id} before sending"
            )
            for key in sorted(displaced)
            if (old := self._lanes.pop(key, None)) is not None
            and old.command.id != approved.command.id
        ]
        self._lanes[lane] = approved
        return dropped

    def expire(self, now_ns: int) -> list[CommandDropped]:
        """Remove and return the expired orders."""
        late = [k for k, a in self._lanes.items() if now_ns >= a.command.expires_at_ns]
        return [
            self._dropped(self._lanes.pop(lane), Phase.EXPIRED, "not sent in time") for lane in late
        ]

    def waiting(self, lane: Lane) -> ApprovedCommand | None:
        """Return the order in a lane without removing it."""
        return self._lanes.get(lane)

    def take(self, may_go: Callable[[Lane, ApprovedCommand], bool]) -> ApprovedCommand | None:
        """Remove and return the most urgent order that may be sent now."""
        if not self._lanes:
            return None
        for lane in Lane:
            waiting = self._lanes.get(lane)
            if waiting is not None and may_go(lane, waiting):
                return self._lanes.pop(lane)
        return None

    def withdraw_motion(self, reason: str) -> list[CommandDropped]:
        """Remove and return every order that may move the vehicle, a takeoff by hover too."""
        moving = [lane for lane, approved in self._lanes.items() if approved.command.moves]
        return [self._dropped(self._lanes.pop(each), Phase.SUPERSEDED, reason) for each in moving]

    def empty_out(self, reason: str) -> list[CommandDropped]:
        """Remove everything: nothing is sent again automatically after a reconnect."""
        dropped = [self._dropped(a, Phase.FAILED, reason) for a in self._lanes.values()]
        self._lanes.clear()
        return dropped

    def _dropped(self, approved: ApprovedCommand, phase: Phase, reason: str) -> CommandDropped:
        return CommandDropped(self.link_id, approved.command.id, phase, reason)
