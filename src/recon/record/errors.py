"""Errors of this room."""

from recon.model.errors import ReconError


class RecordError(ReconError):
    """A file could not be read or written; the message names the file and the reason."""
