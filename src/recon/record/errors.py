"""What can go wrong when something is written for keeps."""


class RecordError(Exception):
    """A record could not be written; the message says where and why."""
