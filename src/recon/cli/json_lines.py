"""Progress and results as lines of JSON, for the program that has started a command and asks."""

import json
import os
import time
from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

from recon.station.host.json_lines import LINE_MARK, LINES_WANTED

Item = TypeVar("Item")

EVERY_S = 0.25


def wants_lines() -> bool:
    """Return whether another program asks for lines."""
    return bool(os.environ.get(LINES_WANTED))


def report_facts(**facts: Any) -> None:
    """Print facts as a line, where they are asked for."""
    if wants_lines():
        print(f"{LINE_MARK}{json.dumps(facts)}", flush=True)


def reported_over(items: Iterable[Item], title: str, count: int) -> Iterator[Item]:
    """Yield the items; report how many of `count` are done."""
    next_s = 0.0
    for number, item in enumerate(items):
        if time.monotonic() >= next_s:
            report_facts(doing=title, share=min(1.0, number / max(count, 1)))
            next_s = time.monotonic() + EVERY_S
        yield item
