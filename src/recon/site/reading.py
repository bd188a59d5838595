"""Reading a site's files: bounded, inside the folder; errors name file and key."""

import math
import sys
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import TypeVar

import msgspec

from recon.model.errors import SiteError
from recon.site.validation_errors import shown_value, validation_error

T = TypeVar("T")


def file_inside(site_file: Path, name: str, key: str) -> Path:
    """Return the path of a file that site.toml names under `key`.

    Raises `SiteError` for a file that is not there or is outside the folder.
    """
    folder = site_file.parent
    path = folder / name
    try:
        is_inside = path.resolve().is_relative_to(folder.resolve())
        is_file = path.is_file()
    except (OSError, RuntimeError):
        # A name too long for the file system, or a loop of symbolic links.
        is_inside, is_file = True, False
    if not is_inside:
        problem = "which leads out of it; put the file into the folder"
    elif not is_file:
        problem = "and there is no such file"
    else:
        return path
    raise SiteError(
        f"{site_file}: {key}: expected the name of a file in the site's folder, got "
        f"{name!a}, {problem}"
    )


def read_bounded(path: Path, largest_bytes: int, expected: str) -> bytes:
    """Return a file's bytes; raises `SiteError` when it cannot be read or is larger."""
    try:
        with path.open("rb") as file:
            data = file.read(largest_bytes + 1)
    except OSError as problem:
        raise SiteError(
            f"{path}: expected {expected}, got: {problem.strerror or problem}"
        ) from problem
    if len(data) > largest_bytes:
        raise SiteError(f"{path}: expected at most {largest_bytes} bytes, got more")
    return data


def convert(place: object, data: object, kind: type[T], key: str) -> T:
    """Return data as its type; the `SiteError` begins with the place, then the key in it."""
    try:
        return msgspec.convert(data, kind, strict=True)
    except msgspec.ValidationError as problem:
        raise SiteError(f"{place}: {validation_error(problem, data, kind, key)}") from problem


def refuse_non_finite(place: object, value: object, key: str) -> None:
    """Raise `SiteError` for NaN, infinity or a number beyond any float."""
    if isinstance(value, float) and not math.isfinite(value):
        raise SiteError(f"{place}: {key}: expected a finite number, got {value}")
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        raise SiteError(f"{place}: {key}: expected a finite number, got {shown_value(value)}")
    if isinstance(value, Mapping):
        for name, item in value.items():
            # A key is the file's own text: ascii keeps control characters out.
            inner = ascii(str(name))[1:-1]
            refuse_non_finite(place, item, f"{key}.{inner}" if key else inner)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            refuse_non_finite(place, item, f"{key}[{index}]")


MAX_DIGESTED_FILES = 200
MAX_DIGESTED_BYTES = 256 * 1024 * 1024
_PIECE_BYTES = 1024 * 1024


def site_digest(folder: Path) -> str:
    """Return SHA-256 over the names and contents of a site's files, sorted by name.

    The audit records it: which boundary, zones and profiles a flight used.

    Files over 256 MiB or beyond the first 200, and unreadable ones, count by name and size.
    """
    total = sha256()
    for number, path in enumerate(sorted(p for p in folder.rglob("*") if p.is_file())):
        name = path.relative_to(folder).as_posix().encode()
        content = _content_hash(path) if number < MAX_DIGESTED_FILES else b"not read"
        total.update(len(name).to_bytes(8, "big") + name + content)
    return total.hexdigest()


def _content_hash(path: Path) -> bytes:
    try:
        size = path.stat().st_size
        if size > MAX_DIGESTED_BYTES:
            return f"{size} bytes".encode()
        content = sha256()
        with path.open("rb") as file:
            while piece := file.read(_PIECE_BYTES):
                content.update(piece)
        return content.digest()
    except OSError:
        return b"unreadable"
