"""Replacing a small file at once: a crash leaves the old file or the new one, never half of it."""

import os
from pathlib import Path


def replace_file(path: Path, data: bytes, mode: int = 0o600, *, sync: bool = True) -> None:
    """Write `data` to a temporary file beside `path`, sync it and rename it; raises OSError.

    Without `sync` only a crash of the program leaves the old file or the new one, not of the
    computer: enough for what is quickly made again.
    """
    temporary = path.with_name(f".{path.name}.new")
    file = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, mode)
    try:
        left = data
        while left:
            left = left[os.write(file, left) :]
        if sync:
            os.fsync(file)
    finally:
        os.close(file)
    os.replace(temporary, path)
