"""The failsafe matrix of a site: the default, with the cells that [failsafe] states."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from recon.model.errors import SiteError
from recon.model.failsafe_matrix import (
    Activity,
    FailsafeCell,
    FailsafeCondition,
    FailsafeMatrix,
    Reaction,
)
from recon.safety.failsafe import DEFAULT_MATRIX, ROWS, FailsafeRow, cell_words
from recon.site.reading import convert, shown_value
from recon.site.schema import FailsafeRowTable, FailsafeTable, ReactionTable

_WHAT_IT_DOES = {
    Activity.MISSION: "in a mission",
    Activity.STEERED: "steered",
    Activity.HOLDING: "holding already",
    Activity.RETURNING: "on the route home already",
}


def failsafe_from_tables(path: Path, data: dict[str, Any]) -> FailsafeMatrix:
    """Return the matrix; raises `SiteError` for a cell that is unknown or makes no sense."""
    table = convert(path, data, FailsafeTable, "failsafe")
    rows = {
        condition: _row(path, ROWS[condition], getattr(table, condition.value))
        for condition in FailsafeCondition
    }
    return FailsafeMatrix(rows)


def failsafe_report(matrix: FailsafeMatrix) -> str:
    """Return a line on how many cells differ from the default."""
    changed = len(list(matrix.differences(DEFAULT_MATRIX)))
    if changed == 0:
        return "failsafe matrix: default"
    cells = "1 cell differs" if changed == 1 else f"{changed} cells differ"
    return f"failsafe matrix: {cells} from the default"


def failsafe_warnings(matrix: FailsafeMatrix) -> Iterator[str]:
    """Yield a warning for each cell that does less than the default."""
    for condition, activity, cell, default in matrix.differences(DEFAULT_MATRIX):
        if cell.is_weaker_than(default):
            row = ROWS[condition]
            yield (
                f"failsafe.{condition.value}.{activity.value}: {cell_words(row, cell)}; "
                f"the default does more: {cell_words(row, default)}"
            )


def _row(path: Path, row: FailsafeRow, data: dict[str, Any]) -> dict[Activity, FailsafeCell]:
    key = f"failsafe.{row.condition.value}"
    table = convert(path, data, FailsafeRowTable, key)
    return {
        activity: _cell(path, f"{key}.{activity.value}", row, activity, cell)
        if (cell := getattr(table, activity.value)) is not None
        else row.default[activity]
        for activity in Activity
    }


def _cell(path: Path, key: str, row: FailsafeRow, activity: Activity, data: object) -> FailsafeCell:
    if not isinstance(data, str | dict):
        raise SiteError(
            f'{path}: {key}: expected a reaction like "hold" or {{ do = "hold", after_s = 5 }}, '
            f"got {shown_value(data)}"
        )
    table = convert(path, {"do": data} if isinstance(data, str) else data, ReactionTable, key)
    reaction = Reaction(table.do)
    _refuse_not_offered(path, key, row, activity, reaction)
    if table.after_s is not None:
        _refuse_delay(path, key, row, activity, reaction)
    if not reaction.is_order or activity in row.fixed:
        return row.default[activity] if activity in row.fixed else FailsafeCell(reaction)
    default = row.default[activity]
    usual_s = default.after_s if default.reaction is reaction else row.after_s
    return FailsafeCell(reaction, usual_s if table.after_s is None else table.after_s)


def _refuse_not_offered(
    path: Path, key: str, row: FailsafeRow, activity: Activity, reaction: Reaction
) -> None:
    offered = row.offered(activity)
    if reaction in offered:
        return
    if activity in row.fixed:
        why = row.fixed[activity]
    elif reaction not in row.reactions:
        why = row.why_no_other
    else:
        why = f"it is {_WHAT_IT_DOES[activity]}"
    names = " or ".join(ascii(one.value) for one in Reaction if one in offered)
    raise SiteError(f"{path}: {key}: expected {names}, got {reaction.value!r}: {why}")


def _refuse_delay(
    path: Path, key: str, row: FailsafeRow, activity: Activity, reaction: Reaction
) -> None:
    if not row.is_timed:
        why = "the watchdog chooses the moment"
    elif activity in row.fixed:
        why = row.fixed[activity]
    elif not reaction.is_order:
        why = f"{reaction.value!r} has no delay"
    else:
        return
    raise SiteError(f"{path}: {key}.after_s: expected no delay, got one: {why}")
