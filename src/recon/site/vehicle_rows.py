"""A site's vehicles as rows of a table: read for an editor, and staged as the site.toml to save.

Comments of site.toml, and keys that the table does not have, stay as they are.
"""

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import msgspec

from recon.model.errors import SiteError
from recon.site import toml_lines
from recon.site.drawing import StagedSite, stage_files
from recon.site.load import LARGEST_FILE_BYTES, SITE_FILE
from recon.site.reading import read_bounded, read_toml, validation_error
from recon.site.schema import VehicleTable

TABLE = "vehicles"
_ROW_PLACE = re.compile(
    r"site\.toml: vehicles \(entry (?P<number>\d{1,4})\)(?:\.(?P<key>\w+))?: (?P<rest>.+)",
    re.DOTALL,
)
"""How an error of a vehicle begins: `recon.site.load`."""
COLUMNS = {
    "serial": "serial",
    "name": "name",
    "number": "number",
    "camera": "camera",
    "waypoint_altitude": "altitude reference",
}
"""The table's keys of site.toml, in words."""


@dataclass(frozen=True, slots=True)
class VehicleRow:
    """A vehicle of [[vehicles]]; None: the key is absent."""

    serial: str
    name: str | None = None
    number: int | None = None
    camera: str | None = None
    waypoint_altitude: str | None = None


class VehicleRowError(SiteError):
    """What is wrong with the row at `index` in the order in which they were given."""

    def __init__(self, index: int, problem: str) -> None:
        """Take the sentence without the file that it is about."""
        super().__init__(problem)
        self.index = index


def read_vehicle_rows(folder: Path) -> tuple[VehicleRow, ...]:
    """Return the vehicles of site.toml in its order. Raises `SiteError`."""
    values = read_toml(folder / SITE_FILE, LARGEST_FILE_BYTES, "a site file")
    return tuple(
        VehicleRow(**{key: table.get(key) for key in COLUMNS})
        for table in values.get("vehicles", [])
    )


def stage_vehicles(folder: Path, rows: Sequence[VehicleRow]) -> StagedSite:
    """Return the site with these vehicles and its site.toml; vehicles that are excluded go.

    Keys that the table does not have stay with their serial. Raises `SiteError` as a start does,
    `VehicleRowError` where it is about one row.
    """
    _refuse_invalid(rows)
    text = read_bounded(folder / SITE_FILE, LARGEST_FILE_BYTES, "a site file").decode()
    before = tomllib.loads(text)
    wanted = _wanted(before, rows)
    changed = _with_rows(text, {row.serial: row for row in rows})
    if not toml_lines.is_read_as(changed, wanted):
        raise SiteError(
            f"{folder / SITE_FILE}: expected each vehicle as a [[vehicles]] section with one key a "
            "line, got another form; edit the vehicles there by hand while the station is stopped"
        )
    files = {} if changed == text else {SITE_FILE: changed.encode()}
    try:
        return stage_files(folder, files)
    except SiteError as problem:
        serials = [table["serial"] for table in wanted.get("vehicles", [])]
        raise _of_row(problem, rows, serials) from problem


def _refuse_invalid(rows: Sequence[VehicleRow]) -> None:
    """Raise `VehicleRowError` for values that no vehicle has, before they are written to a file."""
    for index, row in enumerate(rows):
        values = _values(row)
        try:
            msgspec.convert(values, VehicleTable, strict=True)
        except msgspec.ValidationError as problem:
            key, _, rest = validation_error(problem, values, VehicleTable, "").partition(": ")
            raise VehicleRowError(index, _sentence(key, rest)) from problem
        if row.serial in {other.serial for other in rows[:index]}:
            raise VehicleRowError(index, f"Serial {row.serial} is in the table twice")


def _sentence(key: str | None, rest: str) -> str:
    column = COLUMNS.get(key or "", key)
    return rest[:1].upper() + rest[1:] if column is None else f"{column.capitalize()}: {rest}"


def _wanted(before: Mapping[str, Any], rows: Sequence[VehicleRow]) -> dict[str, Any]:
    """Return the values of site.toml with the rows: known ones in its order, then new ones."""
    known = {table.get("serial"): table for table in before.get("vehicles", [])}
    asked = {row.serial: row for row in rows}
    order = [s for s in known if s in asked] + [s for s in asked if s not in known]
    tables = [
        {
            **{key: value for key, value in known.get(serial, {}).items() if key not in COLUMNS},
            **{key: value for key, value in asdict(asked[serial]).items() if value is not None},
        }
        for serial in order
    ]
    return {**before, "vehicles": tables} if tables else _without(before, "vehicles")


def _without(values: Mapping[str, Any], key: str) -> dict[str, Any]:
    return {one: value for one, value in values.items() if one != key}


def _with_rows(text: str, rows: Mapping[str, VehicleRow]) -> str:
    """Return the text with the rows' keys set, new vehicles at its end."""
    lines: list[str] = []
    left = dict(rows)
    for block in toml_lines.blocks(text, TABLE):
        is_vehicle = toml_lines.is_section(block, TABLE)
        serial = toml_lines.values_of(block, TABLE).get("serial") if is_vehicle else None
        if serial is None:
            lines += block
        elif serial in left:
            lines += toml_lines.with_keys(block, TABLE, COLUMNS, _values(left.pop(serial)))
        else:
            lines += block[toml_lines.last_own_line(block) + 1 :]
    changed = "".join(lines)
    if left and changed and not changed.endswith("\n"):
        changed += "\n"
    for row in left.values():
        keys = (toml_lines.key_line(key, value) for key, value in _values(row).items())
        changed += f"\n[[{TABLE}]]\n" + "".join(keys)
    return changed


def _values(row: VehicleRow) -> dict[str, Any]:
    return {key: value for key, value in asdict(row).items() if value is not None}


def _of_row(problem: SiteError, rows: Sequence[VehicleRow], serials: Sequence[str]) -> SiteError:
    """Return the error with the row that its text names by entry, if it does."""
    found = _ROW_PLACE.match(str(problem))
    if found is None or not 0 < int(found["number"]) <= len(serials):
        return problem
    serial = serials[int(found["number"]) - 1]
    index = next(n for n, row in enumerate(rows) if row.serial == serial)
    return VehicleRowError(index, _sentence(found["key"], found["rest"]))
