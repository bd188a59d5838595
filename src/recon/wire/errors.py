"""The errors of the wire.

WireError(ReconError, ValueError)    expected, came
|- ShortError    the bytes end before the packet does
|- SyncError     the bytes do not start with the sync field
|- SizeError     a size that disagrees with the PID or with the payload's own lengths
|- HashError     a damaged packet
|- FieldError    a value that the wire cannot carry
"""

from recon.model.errors import ReconError


class WireError(ReconError, ValueError):
    """Bytes that are no packet, or a packet that cannot become bytes."""

    def __init__(self, message: str, expected: str = "", came: str = "") -> None:
        super().__init__(message)
        self.expected = expected
        self.came = came


class ShortError(WireError):
    """The bytes end before the packet does."""


class SyncError(WireError):
    """The bytes do not start with the sync field."""


class SizeError(WireError):
    """The size disagrees with the PID or with the payload's own lengths."""


class HashError(WireError):
    """The packet's hash is another one: it is damaged."""


class FieldError(WireError):
    """A value that the wire cannot carry."""
