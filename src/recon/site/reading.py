"""Reading a site's files: bounded, inside the folder, and with complaints that name the place."""

import re
from pathlib import Path
from typing import TypeVar

import msgspec
from msgspec import inspect

from recon.site.errors import SiteError

T = TypeVar("T")
K = TypeVar("K", bound=inspect.Type)


def file_inside(site_file: Path, name: str, key: str) -> Path:
    """Return the path of a file that site.toml names under `key`.

    Raises `SiteError` for a file that is not there or that leads out of the folder.
    """
    folder = site_file.parent
    path = folder / name
    try:
        is_inside = path.resolve().is_relative_to(folder.resolve())
        is_file = path.is_file()
    except (OSError, RuntimeError):
        # A name too long for the file system, or symbolic links that go round in circles.
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


def read_bounded(path: Path, largest_bytes: int, expected: str, advice: str = "") -> bytes:
    """Return a file's bytes; raises `SiteError` when it cannot be read or is larger."""
    try:
        with path.open("rb") as file:
            data = file.read(largest_bytes + 1)
    except OSError as problem:
        raise SiteError(
            f"{path}: expected {expected}, got: {problem.strerror or problem}{advice}"
        ) from problem
    if len(data) > largest_bytes:
        raise SiteError(f"{path}: expected at most {largest_bytes} bytes, got more")
    return data


def convert(place: object, data: object, kind: type[T], key: str) -> T:
    """Return data as its type; the `SiteError` begins with the place, then the key in it."""
    try:
        return msgspec.convert(data, kind, strict=True)
    except msgspec.ValidationError as problem:
        what, _, where = str(problem).partition(" - at `$")
        inner = where.rstrip("`").lstrip(".")
        joint = "." if key and inner and not inner.startswith("[") else ""
        full_key = key + joint + inner
        # An unknown key's name is the file's own text: repr keeps control characters out.
        said = ascii(what)[1:-1].replace("`", "'")
        if what.startswith("Invalid enum value"):
            said += f", expected {' or '.join(_words(inspect.type_info(kind), where))}"
        raise SiteError(f"{place}: {full_key + ': ' if full_key else ''}{said}") from problem


def _words(kind: inspect.Type, where: str) -> list[str]:
    """Return the words allowed at a place like `.pad.datum` of a type."""
    for name in re.findall(r"\.(\w+)", where):
        (struct,) = _choices(kind, inspect.StructType)
        kind = next(field.type for field in struct.fields if field.encode_name == name)
    words = [word for literal in _choices(kind, inspect.LiteralType) for word in literal.values]
    return [repr(word) for word in words]


def _choices(kind: inspect.Type, wanted: type[K]) -> list[K]:
    """Return the types of one sort that a type allows: itself, or members of a union."""
    members = kind.types if isinstance(kind, inspect.UnionType) else (kind,)
    return [member for member in members if isinstance(member, wanted)]
