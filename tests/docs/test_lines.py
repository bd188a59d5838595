"""Pages are wrapped at 100 characters, and the cells of their tables are short."""

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MAX_LINE = 100
MAX_CELL = 200
"""A row is one line; what does not fit in a cell belongs below the table, or in two rows."""
GENERATED = {"docs/flight-table.md"}
CELLS = re.compile(r"(?<!\\)\|")
UNBROKEN = re.compile(r"^\s*(?:[-*] )?(?:\S+|\[[^\]]*\]\(\S+)$")
"""A line of one word or one link: it cannot be wrapped."""


def tracked_pages() -> list[str]:
    listed = subprocess.run(
        ["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return sorted({*listed.stdout.splitlines()} - GENERATED)


def prose(text: str) -> Iterator[tuple[int, str]]:
    """Lines with their numbers, without blocks of code."""
    is_code = False
    for number, line in enumerate(text.splitlines(), start=1):
        if line.lstrip().startswith("```"):
            is_code = not is_code
        elif not is_code:
            yield number, line


def faults(text: str) -> list[str]:
    """One sentence for each line or cell that is too long."""
    found = []
    for number, line in prose(text):
        if line.lstrip().startswith("|"):
            longest = max(len(cell.strip()) for cell in CELLS.split(line))
            if longest >= MAX_CELL:
                found.append(f"{number}: a cell of {longest} characters")
        elif len(line) > MAX_LINE and not UNBROKEN.match(line):
            found.append(f"{number}: {len(line)} characters")
    return found


@pytest.mark.parametrize("page", tracked_pages())
def test_lines_and_cells_are_short(page: str) -> None:
    assert faults((ROOT / page).read_text(encoding="utf-8")) == []


def test_long_lines_and_cells_are_found() -> None:
    long = "word " * 21
    text = f"{long}\n| a | {long * 2}|\n```\n{long}\n```\n- {'x' * 120}\n"
    assert faults(text) == ["1: 105 characters", "2: a cell of 209 characters"]
