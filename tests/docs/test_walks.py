"""The two walks through the code name files that exist, and are short."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/lives/walks.md").read_text(encoding="utf-8")
STEP = re.compile(r"^(\d+)\. `([^`]+)`: \S", re.MULTILINE)


@pytest.mark.parametrize(("title", "most"), [("An order", 22), ("Telemetry", 32)])
def test_a_walk_enters_few_files_that_exist(title: str, most: int) -> None:
    (walk,) = (part for part in PAGE.split("\n## ") if part.startswith(title))
    steps = STEP.findall(walk)
    assert [int(number) for number, _ in steps] == list(range(1, len(steps) + 1))
    assert [path for _, path in steps if not (ROOT / path).is_file()] == []
    assert len({path for _, path in steps}) == len(steps) == walk.count("`: ")
    assert len(steps) <= most
