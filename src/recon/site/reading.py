"""Reading a site's files: bounded, inside the folder; errors name file and key.

A validation error's text comes from the schema: its ranges, choices and keys, or the description
beside a pattern. Of msgspec's own text only the place of the error is read.
"""

import math
import re
import sys
import tomllib
from collections.abc import Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar

import msgspec
from msgspec import inspect

from recon.model.errors import SiteError
from recon.model.names import did_you_mean

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


def read_toml(path: Path, largest_bytes: int, expected: str) -> dict[str, Any]:
    """Return the values of a TOML file; raises `SiteError` with the file, as `read_bounded`."""
    data = read_bounded(path, largest_bytes, expected)
    try:
        return tomllib.loads(data.decode("utf-8"))
    except ValueError as problem:
        # Not TOML, not UTF-8, or a number with more digits than Python reads.
        raise SiteError(f"{path}: expected a TOML file, got: {problem}") from problem
    except RecursionError as problem:
        raise SiteError(f"{path}: expected a TOML file, got one nested too deeply") from problem


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
HISTORY_FOLDER = "history"
"""Earlier versions of the layers, beside the site's files."""
FLOWN_FOLDER = "flown"
"""Rows and imaged cells of surveyed regions; without a site's folder, beside the audit."""
MAPS_FOLDER = "maps"
"""Base maps: large, only shown, and read by `basemap/`."""
MAX_DIGESTED_BYTES = 256 * 1024 * 1024
_PIECE_BYTES = 1024 * 1024


def site_digest(folder: Path) -> str:
    """Return SHA-256 over the names and contents of a site's files, sorted by name.

    The audit records it: which boundary, zones and profiles a flight used.

    Files over 256 MiB or beyond the first 200, and unreadable ones, count by name and size. What is
    in `history/`, `maps/` and `flown/` is excluded, as are hidden files.
    """
    total = sha256()
    for number, path in enumerate(sorted(p for p in folder.rglob("*") if _is_in_use(folder, p))):
        name = path.relative_to(folder).as_posix().encode()
        content = _content_hash(path) if number < MAX_DIGESTED_FILES else b"not read"
        total.update(len(name).to_bytes(8, "big") + name + content)
    return total.hexdigest()


def _is_in_use(folder: Path, path: Path) -> bool:
    top = path.relative_to(folder).parts[0]
    is_other = top in (HISTORY_FOLDER, MAPS_FOLDER, FLOWN_FOLDER) or top.startswith(".")
    return path.is_file() and not is_other


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


K = TypeVar("K", bound=inspect.Type)

MAX_SHOWN_LETTERS = 80
_STEP = re.compile(r"\.(\w+)|\[(\d+)\]")


def validation_error(problem: msgspec.ValidationError, data: object, kind: object, key: str) -> str:
    """Return "key: expected this, got that" for data of another type than `kind`, under `key`."""
    what, _, where = str(problem).rpartition(" - at `$")
    steps = [name or int(index) for name, index in _STEP.findall(where.rstrip("`"))]
    owners, kinds = [data], [inspect.type_info(kind)]
    try:
        for step in steps:
            owners.append(owners[-1][step])  # type: ignore[index]
            kinds.append(_inner(kinds[-1], step))
    except (LookupError, TypeError, StopIteration):
        # The place was part of an unknown key: report the error at the top.
        what, steps, owners, kinds = str(problem), [], owners[:1], kinds[:1]
    what = what or str(problem)
    if what.startswith("Object contains unknown field"):
        return _unknown_key(_path(key, steps), owners[-1], kinds[-1])
    if what.startswith("Object missing required field"):
        missing = _missing(owners[-1], kinds[-1])
        expected, path = in_words(_inner(kinds[-1], missing)), _path(key, [*steps, missing])
        if expected == "a table":
            return f"section [{path}] is missing"
        return f"{path} is missing: expected {expected}"
    hint = _swapped(owners, steps)
    place = _path(key, steps)
    lead = f"{place}: " if place else ""
    return f"{lead}expected {in_words(kinds[-1])}, got {shown_value(owners[-1])}{hint}"


def in_words(kind: inspect.Type) -> str:
    """Return what a type allows: `a number of -90 to 90`, `'ground' or 'wgs84'`."""
    if isinstance(kind, inspect.Metadata):
        description = (kind.extra_json_schema or {}).get("description")
        return str(description) if description else in_words(kind.type)
    if isinstance(kind, inspect.UnionType):
        choices = [one for one in kind.types if not isinstance(one, inspect.NoneType)]
        return " or ".join(in_words(one) for one in choices)
    if isinstance(kind, inspect.LiteralType):
        return " or ".join(repr(value) for value in kind.values)
    if isinstance(kind, inspect.FloatType):
        return "a number" + _range(kind)
    if isinstance(kind, inspect.IntType):
        return "a whole number" + _range(kind)
    if isinstance(kind, inspect.TupleType):
        return f"a list of {len(kind.item_types)}, each {in_words(kind.item_types[0])}"
    if isinstance(kind, inspect.ListType):
        return "a list"
    return "a text" if isinstance(kind, inspect.StrType) else "a table"


def shown_value(value: object) -> str:
    """Return a value of a file in printable characters, shortened."""
    if isinstance(value, Mapping):
        return "an object"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if value is None or isinstance(value, bool):
        return "nothing" if value is None else str(value).lower()
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        return "a number with very many digits"
    text = ascii(value) if isinstance(value, str) else ascii(str(value))[1:-1]
    return text if len(text) <= MAX_SHOWN_LETTERS else text[: MAX_SHOWN_LETTERS - 3] + "..."


def _unknown_key(place: str, owner: object, kind: inspect.Type) -> str:
    known = [field.encode_name for field in _struct(kind).fields]
    unknown = next(str(name) for name in _keys(owner) if name not in known)
    lead = f"{place}: " if place else ""
    got = f"{shown_value(unknown)}{did_you_mean(unknown, known)}"
    return f"{lead}expected only the keys {', '.join(known)}, got {got}"


def _missing(owner: object, kind: inspect.Type) -> str:
    there = set(_keys(owner))
    fields = _struct(kind).fields
    return next(f.encode_name for f in fields if f.required and f.encode_name not in there)


def _keys(owner: object) -> Sequence[object]:
    return list(owner) if isinstance(owner, Mapping) else []


def _swapped(owners: Sequence[object], steps: Sequence[str | int]) -> str:
    """Return a hint when an invalid latitude and its longitude would be valid swapped."""
    if not steps or steps[-1] != "latitude_deg" or not isinstance(owners[-2], Mapping):
        return ""
    latitude, longitude = owners[-1], owners[-2].get("longitude_deg")
    if not (_is_degrees(latitude, 180.0) and _is_degrees(longitude, 90.0)):
        return ""
    return "; latitude and longitude look swapped"


def _is_degrees(value: object, most: float) -> bool:
    return isinstance(value, int | float) and abs(value) <= most


def _inner(kind: inspect.Type, step: str | int) -> inspect.Type:
    """Return the type of what a type holds at a key or an index."""
    if isinstance(step, str):
        fields = _struct(kind).fields
        return next(field.type for field in fields if field.encode_name == step)
    for lists in _choices(kind, inspect.ListType):
        return lists.item_type
    (several,) = _choices(kind, inspect.TupleType)
    return several.item_types[step]


def _struct(kind: inspect.Type) -> inspect.StructType:
    return _choices(kind, inspect.StructType)[0]


def _choices(kind: inspect.Type, wanted: type[K]) -> list[K]:
    """Return the types of one sort that a type allows: itself, or members of a union."""
    if isinstance(kind, inspect.Metadata):
        return _choices(kind.type, wanted)
    members = kind.types if isinstance(kind, inspect.UnionType) else (kind,)
    return [member for member in members if isinstance(member, wanted)]


def _range(kind: inspect.FloatType | inspect.IntType) -> str:
    if kind.le is None:
        return ""
    if kind.gt is not None:
        return f" above {kind.gt:g}, {kind.le:g} at most"
    return f" of {kind.ge:g} to {kind.le:g}"


def _path(key: str, steps: Sequence[str | int]) -> str:
    """Return `pad.latitude_deg` or `coordinates[0][1]` under a key."""
    path = key
    for step in steps:
        if isinstance(step, int):
            path += f"[{step}]"
        else:
            path += f".{step}" if path else step
    return path
