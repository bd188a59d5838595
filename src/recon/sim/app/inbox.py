"""What one link has received and its app has not read yet."""

from dataclasses import dataclass, field

READ_EVERY_NS = 100_000_000
SLOW_BYTES = 32
"""A slow reader reads so much each time: ten sticks a second are more than it keeps up with."""
MOST_UNREAD_BYTES = 4_096
"""Beyond, the socket is not read any more, and TCP makes the station wait."""
MOST_KEPT_BYTES = 1_048_576
"""Where nobody can make the station wait (no socket), what is beyond this is lost."""


@dataclass(slots=True)
class Inbox:
    """Bytes of a link in their order, read at once or a few at a time."""

    _unread: bytearray = field(default_factory=bytearray)
    next_read_ns: int | None = None

    @property
    def has_room(self) -> bool:
        """Whether more should be read from the socket."""
        return len(self._unread) < MOST_UNREAD_BYTES

    def keep(self, data: bytes, now_ns: int) -> None:
        """Take what came, to be read later."""
        self._unread += data[: MOST_KEPT_BYTES - len(self._unread)]
        if self.next_read_ns is None:
            self.next_read_ns = now_ns + READ_EVERY_NS

    def read(self, slowly: bool) -> bytes:
        """Return what is read now, all of it or a little."""
        size = SLOW_BYTES if slowly else len(self._unread)
        data = bytes(self._unread[:size])
        del self._unread[:size]
        at_ns = self.next_read_ns
        self.next_read_ns = at_ns + READ_EVERY_NS if self._unread and at_ns is not None else None
        return data
