"""The numbers of a site's vehicles, numbers.toml: fixed by serial, across restarts.

A number is what an operator reads on the map and presses on the keyboard, so it must never move to
another aircraft. The station writes the file when it meets a new serial. A number in site.toml
comes first.
"""

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any

from msgspec import Meta, Struct

from recon.model.errors import SiteError
from recon.site.reading import convert, read_toml
from recon.site.schema import Serial

NUMBERS_FILE = "numbers.toml"
LARGEST_FILE_BYTES = 512 * 1024
MAX_ENTRIES = 1_000
"""Apps choose their serials: without a limit they could fill the file."""
LARGEST_NUMBER = 9_999
HEADER = """\
# The numbers of the vehicles, by serial. The station adds new vehicles and rewrites this file
# without your comments. Edit it only while the station is stopped.
"""


class NumberTable(Struct, frozen=True, forbid_unknown_fields=True):
    """One of [[vehicles]]."""

    serial: Serial
    number: Annotated[int, Meta(ge=1, le=LARGEST_NUMBER)]


class NumbersTable(Struct, frozen=True, forbid_unknown_fields=True):
    """The whole file."""

    vehicles: list[dict[str, Any]] = []


def read_numbers(path: Path) -> dict[str, int]:
    """Return the numbers by serial; none without a file. Raises `SiteError` with file and key."""
    if not path.exists():
        return {}
    values = read_toml(path, LARGEST_FILE_BYTES, "a list of vehicle numbers")
    numbers: dict[str, int] = {}
    for entry, table in enumerate(convert(path, values, NumbersTable, "").vehicles, start=1):
        key = f"vehicles (entry {entry})"
        row = convert(path, table, NumberTable, key)
        if row.serial in numbers or row.number in numbers.values():
            raise SiteError(
                f"{path}: {key}: expected each serial and each number once, "
                f"got {row.serial} = {row.number} again"
            )
        numbers[row.serial] = row.number
    if len(numbers) > MAX_ENTRIES:
        raise SiteError(f"{path}: expected at most {MAX_ENTRIES} vehicles, got {len(numbers)}")
    return numbers


def numbers_text(numbers: Mapping[str, int]) -> str:
    """Return the file's text; `read_numbers` of it gives the first `MAX_ENTRIES` again."""
    kept = list(numbers.items())[:MAX_ENTRIES]
    # A serial is printable ASCII: there JSON's strings are TOML's.
    rows = (f"\n[[vehicles]]\nserial = {json.dumps(s)}\nnumber = {n}\n" for s, n in kept)
    return HEADER + "".join(rows)


def with_new(numbers: Mapping[str, int], vehicles: Iterable[tuple[str, str]]) -> Mapping[str, int]:
    """Return the numbers with those of new vehicles, given as serial and name.

    A vehicle whose name ends in a number has that number where it is free, so that the two agree;
    others have the lowest free one. Without a new vehicle it is the same mapping.
    """
    new = {serial: name for serial, name in vehicles if serial not in numbers}
    if not new:
        return numbers
    given = dict(numbers)
    taken = set(numbers.values())
    named = {serial: _number_in(name) for serial, name in new.items()}
    for serial, number in named.items():
        if number is not None and number not in taken:
            given[serial] = number
            taken.add(number)
    free = 1
    for serial in new:
        if serial in given:
            continue
        while free in taken:
            free += 1
        given[serial] = free
        taken.add(free)
    return given


def _number_in(name: str) -> int | None:
    """Return the number that a name of words ends in, as in `Drone 3`; a serial is no such name."""
    found = re.fullmatch(r"\D*[^\w]0*([1-9]\d{0,3})", name)
    return None if found is None else int(found[1])
