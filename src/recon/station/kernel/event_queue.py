"""The one ordered queue of events of both drivers."""

from collections import deque
from collections.abc import Callable

from recon.model.event import Event


class EventQueue:
    """Hands events to a handler one at a time, in order; events it causes are queued behind.

    So a step's outputs are all carried out before the next event is handled, and no step runs
    inside another.
    """

    def __init__(self, handle: Callable[[Event], None]) -> None:
        self._handle = handle
        self._waiting: deque[Event] = deque()
        self._is_draining = False

    def put(self, event: Event) -> None:
        """Queue an event; unless one is being handled now, handle it and all it causes."""
        self._waiting.append(event)
        if self._is_draining:
            return
        self._is_draining = True
        try:
            while self._waiting:
                self._handle(self._waiting.popleft())
        finally:
            self._is_draining = False
