"""What can be wrong with a site's folder: one error, one sentence."""

from recon.model.errors import ReconError


class SiteError(ReconError):
    """A site's folder cannot be used; the message names the file, the key, what was expected."""
