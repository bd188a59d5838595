"""What can be wrong with a site's folder: one error, one sentence."""


class SiteError(ValueError):
    """A site's folder cannot be used; the message names the file, the key, what was expected."""
