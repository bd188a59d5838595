"""What became of orders, told to a person or to a program."""

import asyncio
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from recon.cli.at_station import DONE, REFUSED
from recon.client import Order, Refusal, Station, TookTooLongError, VehicleAnswer


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of an order for one vehicle. `is_left_alone`: a stop that stands on the ground
    does not need."""

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
        """The outcome for a person."""
        if self.is_left_alone:
            return f"{self.vehicle}: left alone: it is on the ground"
        if not self.is_accepted:
            return f"{self.vehicle}: refused by the rule {self.rule}: {self.note}"
        words = (self.phase or "accepted").replace("_", " ")
        return f"{self.vehicle}: {words}" + (f" ({self.note})" if self.note else "")


async def outcomes(
    station: Station,
    answers: Sequence[VehicleAnswer],
    wait_s: float,
    *,
    leaves_grounded_alone: bool = False,
) -> list[Outcome]:
    """Wait for every order's end at once; return what became of each."""
    waits = (_outcome(station, a, wait_s, leaves_grounded_alone) for a in answers)
    return list(await asyncio.gather(*waits))


def tell(told: Sequence[Outcome], as_json: bool) -> int:
    """Print outcomes; return the exit code."""
    if as_json:
        print(json.dumps([asdict(outcome) for outcome in told]))
    else:
        for outcome in told:
            say(outcome.sentence)
        if not told:
            say("there is no vehicle to order")
    return DONE if all(o.is_done or o.is_left_alone for o in told) else REFUSED


def say(sentence: str) -> None:
    """Print a sentence; whatever is in it, the terminal stays as it is."""
    print(clean(sentence), flush=True)


def say_json(value: Any) -> None:
    """Print a value for programs."""
    print(json.dumps(value), flush=True)


def clean(text: str) -> str:
    """Return text without what a terminal would obey."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def table(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table as wide as the terminal; into a file, each row in one line."""
    console = Console(markup=False, highlight=False)
    if not console.is_terminal:
        for row in rows:
            say("  ".join(cell or "-" for cell in row))
        return
    made = Table(title=title, title_justify="left")
    for column in columns:
        made.add_column(column, overflow="fold")
    for row in rows:
        made.add_row(*(Text(clean(cell)) for cell in row))
    console.print(made)


async def _outcome(
    station: Station, answer: VehicleAnswer, wait_s: float, leaves_grounded_alone: bool
) -> Outcome:
    order = answer.answer
    whom = (answer.serial, answer.link_id, answer.vehicle_name)
    if isinstance(order, Refusal):
        stands = leaves_grounded_alone and _stands(station, answer.serial)
        return Outcome(*whom, False, False, stands, rule=order.rule, note=order.reason)
    if wait_s == 0.0:
        return Outcome(*whom, True, True, command_id=order.command_id)
    return await _awaited(order, whom, wait_s)


async def _awaited(
    order: Order, whom: tuple[str | None, int | None, str], wait_s: float
) -> Outcome:
    try:
        life = await order.effect(wait_s)
    except TookTooLongError as problem:
        return Outcome(*whom, True, False, command_id=order.command_id, note=str(problem))
    return Outcome(
        *whom, True, life.is_seen, False, order.command_id, life.phase.value, note=life.note
    )


def _stands(station: Station, serial: str | None) -> bool:
    """Whether a vehicle says now that it is on the ground."""
    return any(
        v.serial == serial and v.is_flying.value is False and v.is_live for v in station.vehicles()
    )
