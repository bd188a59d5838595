"""Recon: a ground control station for several DJI drones over fields."""

from functools import cache


@cache
def version() -> str:
    """Return the installed version."""
    # Imported here: it takes a tenth of a second, and most commands do not need it.
    from importlib import metadata

    return metadata.version("recon-gcs")
