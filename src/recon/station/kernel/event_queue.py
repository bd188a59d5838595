"""The one ordered queue of events that both drivers step the station by."""

from collections import deque
from collections.abc import Callable

from recon.model.event import Event


class EventQueue:
    """Hands events on one at a time: what handling one causes waits behind those already there.

    So a step's outputs are all carried out before the next event is looked at, and no step runs
    inside another.
    """

    def __init__(self, handle: Callable[[Event], None]) -> None:
        self._handle = handle
        self._waiting: deque[Event] = deque()
        self._is_draining = False

    def put(self, event: Event) -> None:
        """Take an event; unless one is being handled right now, handle it and all it causes."""
        self._waiting.append(event)
        if self._is_draining:
            return
        self._is_draining = True
        try:
            while self._waiting:
                self._handle(self._waiting.popleft())
        finally:
            self._is_draining = False
