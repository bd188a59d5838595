"""What can go wrong when something is written for keeps."""

from recon.model.errors import ReconError


class RecordError(ReconError):
    """A record could not be written; the message says where and why."""
