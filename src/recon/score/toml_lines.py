"""On which line of a TOML file each key stands: the parser of the standard library forgets it."""

import re
from collections import Counter
from collections.abc import Mapping
from types import MappingProxyType

HEADER = re.compile(r"\s*(\[\[?)\s*([\w.\"'\- ]+?)\s*\]\]?\s*(?:#.*)?$")
KEY = re.compile(r"\s*([\w.\"'\-]+)\s*=(.*)$")
QUOTED = re.compile(r'"(?:\\.|[^"\\])*"|\'[^\']*\'')


def key_lines(text: str) -> Mapping[str, int]:
    """Return the line, from 1, of each table and key: `clouds[1].cover`, `task.region_m`.

    For text that `tomllib` has read. Values that go over several lines count as their first one.
    """
    lines: dict[str, int] = {}
    counts: Counter[str] = Counter()
    table, depth = "", 0
    for number, line in enumerate(text.splitlines(), start=1):
        if depth == 0 and (header := HEADER.match(line)):
            table = _bare(header[2])
            if header[1] == "[[":
                counts[table] += 1
                lines.setdefault(table, number)
                table = f"{table}[{counts[table] - 1}]"
            lines[table] = number
        elif depth == 0 and (key := KEY.match(line)):
            path = _bare(key[1])
            lines[f"{table}.{path}" if table else path] = number
            depth = max(0, depth + _opened(key[2]))
        else:
            depth = max(0, depth + _opened(line))
    return MappingProxyType(lines)


def line_of(lines: Mapping[str, int], path: str) -> int | None:
    """Return the line of a key, or of the nearest one that holds it; None: of none of them."""
    while path:
        if path in lines:
            return lines[path]
        path = path[: max(path.rfind("."), path.rfind("["), 0)]
    return None


def _bare(key: str) -> str:
    return re.sub(r"[\"'\s]", "", key)


def _opened(value: str) -> int:
    """How many more brackets a line opens than it closes, texts and comments left out."""
    bare = QUOTED.sub("", value).split("#")[0]
    return sum(bare.count(each) for each in "[{") - sum(bare.count(each) for each in "]}")
