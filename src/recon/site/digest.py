"""A site's folder as one hash: which boundary, zones and profiles a flight was flown by."""

from hashlib import sha256
from pathlib import Path

MOST_FILES = 200
LARGEST_FILE_BYTES = 256 * 1024 * 1024
_PIECE_BYTES = 1024 * 1024


def site_digest(folder: Path) -> str:
    """Return SHA-256 over the names and contents of a site's files, in the order of their names.

    Files beyond 256 MiB or the first 200, and what cannot be read, count by their name and size.
    """
    total = sha256()
    for number, path in enumerate(sorted(p for p in folder.rglob("*") if p.is_file())):
        name = path.relative_to(folder).as_posix().encode()
        content = _content_hash(path) if number < MOST_FILES else b"not read"
        total.update(len(name).to_bytes(8, "big") + name + content)
    return total.hexdigest()


def _content_hash(path: Path) -> bytes:
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE_BYTES:
            return f"{size} bytes".encode()
        content = sha256()
        with path.open("rb") as file:
            while piece := file.read(_PIECE_BYTES):
                content.update(piece)
        return content.digest()
    except OSError:
        return b"unreadable"
