"""Printed results: one line per vehicle, tables, or JSON."""

import asyncio
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from recon.cli.exit_codes import DONE, REFUSED
from recon.client import Order, Refusal, Station, VehicleAnswer, WaitTimeoutError


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of an order for one vehicle. `is_left_alone`: on the ground, where a stop needs
    nothing sent."""

    serial: str | None
    link_id: int | None
    vehicle: str
    is_accepted: bool
    is_done: bool
    is_left_alone: bool = False
    command_id: int | None = None
    phase: str | None = None
    rule: str | None = None
    note: str = ""

    @property
    def sentence(self) -> str:
        """The outcome in one line."""
        if self.is_left_alone:
            return f"{self.vehicle}: on the ground, nothing sent"
        if not self.is_accepted:
            return f"{self.vehicle}: refused ({self.rule}): {self.note}"
        words = (self.phase or "accepted").replace("_", " ")
        return f"{self.vehicle}: {words}" + (f" ({self.note})" if self.note else "")


async def await_outcomes(
    station: Station,
    answers: Sequence[VehicleAnswer],
    wait_s: float,
    *,
    leaves_grounded_alone: bool = False,
) -> list[Outcome]:
    """Wait for all orders at once, each for up to `wait_s`; return their outcomes."""
    waits = (_outcome(station, a, wait_s, leaves_grounded_alone) for a in answers)
    return list(await asyncio.gather(*waits))


def print_outcomes(outcomes: Sequence[Outcome], as_json: bool) -> int:
    """Print outcomes; return the exit code."""
    if as_json:
        print_json([asdict(outcome) for outcome in outcomes])
    else:
        for outcome in outcomes:
            print_line(outcome.sentence)
        if not outcomes:
            print_line("no vehicles to command")
    return DONE if all(o.is_done or o.is_left_alone for o in outcomes) else REFUSED


def refused(refusal: Refusal) -> str:
    """Return a refusal in one line."""
    return f"refused ({refusal.rule}): {refusal.reason}"


def print_line(text: str) -> None:
    """Print a line; control characters in it are escaped."""
    print(printable(text), flush=True)


def print_warning(text: str) -> None:
    """Print a warning on stderr: results on stdout may be JSON."""
    print(printable(f"warning: {text}"), file=sys.stderr, flush=True)


def print_json(value: Any) -> None:
    """Print a value as one line of JSON."""
    print(json.dumps(value), flush=True)


def printable(text: str) -> str:
    """Return text with everything escaped that a terminal would interpret."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def print_table(
    title: str,
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    has_heads: bool = False,
) -> None:
    """Print a table as wide as the terminal; into a file or pipe, one line per row.

    `has_heads`: there too, the first line names the columns.
    """
    # Imported here: it takes longer to load than a stop may wait.
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(markup=False, highlight=False)
    if not console.is_terminal:
        for row in (columns, *rows) if has_heads else rows:
            print_line("  ".join(cell or "-" for cell in row))
        return
    table = Table(title=title, title_justify="left")
    for column in columns:
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(*(Text(printable(cell)) for cell in row))
    console.print(table)


async def _outcome(
    station: Station, answer: VehicleAnswer, wait_s: float, leaves_grounded_alone: bool
) -> Outcome:
    order = answer.answer
    vehicle = (answer.serial, answer.link_id, answer.vehicle_name)
    if isinstance(order, Refusal):
        is_skipped = leaves_grounded_alone and _is_on_ground(station, answer.serial)
        return Outcome(*vehicle, False, False, is_skipped, rule=order.rule, note=order.reason)
    if wait_s == 0.0:
        return Outcome(*vehicle, True, True, command_id=order.command_id)
    return await _awaited(order, vehicle, wait_s)


async def _awaited(
    order: Order, vehicle: tuple[str | None, int | None, str], wait_s: float
) -> Outcome:
    try:
        life = await order.wait_for_effect(wait_s)
    except WaitTimeoutError as problem:
        return Outcome(*vehicle, True, False, command_id=order.command_id, note=str(problem))
    return Outcome(
        *vehicle,
        True,
        life.has_taken_effect,
        False,
        order.command_id,
        life.phase.value,
        note=life.note,
    )


def _is_on_ground(station: Station, serial: str | None) -> bool:
    """Whether current telemetry reports a vehicle on the ground."""
    return any(
        v.serial == serial and v.is_flying.value is False and v.is_live for v in station.vehicles()
    )
