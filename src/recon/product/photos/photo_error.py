"""The error of all that reads photos."""

from recon.model.errors import ReconError


class PhotoError(ReconError):
    """A photo that cannot be tagged; the text names the file and the reason."""
