"""Where something comes from: an address of a server, a file: URL, or a path."""

from pathlib import Path
from urllib.parse import unquote, urlsplit

from recon.fetching.polite_client import FetchError
from recon.model.foreign_text import one_line


def local_path(address: str) -> Path | None:
    """Return the file that an address names on this computer; None for an address of a server.

    Raises `FetchError` for what is neither.
    """
    if "://" not in address and not address.startswith("file:"):
        return Path(address)
    try:
        parts = urlsplit(address)
    except ValueError:
        parts = urlsplit("")
    if parts.scheme == "file" and parts.netloc in ("", "localhost") and parts.path:
        return Path(unquote(parts.path))
    is_plain = address.isprintable() and not any(c.isspace() for c in address)
    if parts.scheme in ("http", "https") and parts.hostname and is_plain:
        return None
    raise FetchError(
        f"expected a path, or an address with https, http or file, got {one_line(address)!a}"
    )


def shown_source(address: str) -> str:
    """Return the name of the server or of the file: an address may hold a key."""
    path = local_path(address)
    return (urlsplit(address).hostname or "") if path is None else one_line(path.name)
