"""Keys of site.toml changed line by line: comments, and keys that are not meant, stay as they are.

A section is a block of lines: its header, its keys, and its inner tables. What comes out is read
again and compared with what was wanted (`is_read_as`), so that a file written in another form is
refused, not damaged. tomlkit gives a comment above a section to the section before: removing a
vehicle would then take its neighbour's comment, and leave its own above the neighbour.
"""

import json
import re
import tomllib
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

_SECTION = re.compile(r"^\s*\[")


def blocks(text: str, name: str) -> Iterator[list[str]]:
    """Yield the lines in order; each section [name] or [[name]] is a block of its own."""
    block: list[str] = []
    for line in text.splitlines(keepends=True):
        is_inner = bool(block) and is_section(block, name) and _inner(name).match(line) is not None
        if _SECTION.match(line) and not is_inner:
            yield block
            block = []
        block.append(line)
    yield block


def is_section(block: Sequence[str], name: str) -> bool:
    """Whether a block is a section [name] or [[name]]."""
    header = rf"^\s*(\[\s*{name}\s*\]|\[\[\s*{name}\s*\]\])\s*(#.*)?$"
    return bool(block) and re.match(header, block[0]) is not None


def values_of(block: Sequence[str], name: str) -> dict[str, Any]:
    """Return what a section has; nothing where it cannot be read alone."""
    try:
        table = tomllib.loads("".join(block))[name]
    except (tomllib.TOMLDecodeError, KeyError):
        return {}
    found = table[0] if isinstance(table, list) else table
    return found if isinstance(found, dict) else {}


def last_own_line(block: Sequence[str]) -> int:
    """Return the last line of a section: comments below it are about what follows."""
    own = (n for n, line in enumerate(block) if line.strip() and not line.lstrip().startswith("#"))
    return max(own)


def with_keys(
    block: Sequence[str], name: str, columns: Collection[str], values: Mapping[str, Any]
) -> list[str]:
    """Return a section in which, of `columns`, exactly `values` are set; new ones come last.

    An inner table that is one of `columns` becomes a key.
    """
    known = values_of(block, name)
    lines: list[str] = []
    inner = ""
    for line in block:
        found = _inner(name).match(line)
        inner = found["key"] if found else inner
        key = inner or (line.split("=", 1)[0].strip() if "=" in line else "")
        if key not in columns or known.get(key) == values.get(key):
            lines.append(line)
        elif key in values and not inner:
            lines.append(key_line(key, values[key]))
    written = {key for key in known if key in values and known[key] == values[key]}
    written |= {key for key in known if key in values and not _is_inner(block, name, key)}
    missing = [key_line(key, value) for key, value in values.items() if key not in written]
    if not missing:
        return lines
    end = next((n for n, line in enumerate(lines) if n and _SECTION.match(line)), len(lines))
    at = last_own_line(lines[:end]) + 1
    if not lines[at - 1].endswith("\n"):
        lines[at - 1] += "\n"
    return [*lines[:at], *missing, *lines[at:]]


def key_line(key: str, value: object) -> str:
    """Return `key = value` as a line of TOML."""
    return f"{key} = {_shown(value)}\n"


def is_read_as(text: str, wanted: Mapping[str, Any]) -> bool:
    """Whether a text is TOML of these values."""
    try:
        return tomllib.loads(text) == wanted
    except tomllib.TOMLDecodeError:
        return False


def _shown(value: object) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_shown(one)}" for key, one in value.items()) + " }"
    # TOML's basic strings take JSON's escapes but no surrogates: `ensure_ascii` would make them.
    return json.dumps(value, ensure_ascii=False)


def _inner(name: str) -> re.Pattern[str]:
    return re.compile(rf"^\s*\[\s*{name}\s*\.\s*(?P<key>\w+)")


def _is_inner(block: Sequence[str], name: str, key: str) -> bool:
    found = (_inner(name).match(line) for line in block)
    return any(one is not None and one["key"] == key for one in found)
