"""SAFETY.md lists every rule of the gate, and no rule that is not there."""

import re
from pathlib import Path

from recon.model.failsafe_matrix import Activity
from recon.safety.failsafe import ROWS, cell_words
from recon.safety.rules import RULES
from recon.safety.watchdogs import WATCHDOGS

ROOT = Path(__file__).parents[2]
WORDS_A_MINUTE = 250
"""Usual for prose; the table's cells count as prose, its file names do not."""


def test_every_rule_has_its_row_and_every_row_its_rule() -> None:
    page = (ROOT / "SAFETY.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| [a-zA-Z ]+ \| .* \| `(\w+)\.py` \|$", page, re.MULTILINE)
    assert sorted(rows) == sorted(rule.__name__ for rule in RULES)


def test_every_watchdog_has_its_row_and_every_row_its_watchdog() -> None:
    page = (ROOT / "SAFETY.md").read_text(encoding="utf-8")
    pattern = r"^\| ([a-z ]+)(?:, [a-z ]+)? \| .* \| `safety/watchdogs/(\w+)\.py` \|$"
    rows = re.findall(pattern, page, re.MULTILINE)
    assert {(name.replace(" ", "_"), file) for name, file in rows} == {
        (watchdog.__name__, watchdog.__module__.rsplit(".", 1)[-1]) for watchdog in WATCHDOGS
    }


def test_the_first_page_is_the_default_failsafe_matrix() -> None:
    page = (ROOT / "SAFETY.md").read_text(encoding="utf-8")
    first = page[: page.index("\n## Where the rules are")]
    rows = re.findall(r"^\| (.+) \| `safety/failsafe/(\w+)\.py` \|$", first, re.MULTILINE)
    assert [(*cells.split(" | "), file) for cells, file in rows] == [
        (
            row.condition.words,
            row.begins,
            *(cell_words(row, row.default[activity]) for activity in Activity),
            row.condition.value,
        )
        for row in ROWS.values()
    ]


def test_the_first_page_is_read_in_two_minutes() -> None:
    page = (ROOT / "SAFETY.md").read_text(encoding="utf-8")
    first = page[: page.index("\n## Where the rules are")]
    words = re.findall(r"[\w.]*\w", re.sub(r"`safety/failsafe/\w+\.py`|\]\(.*?\)", "", first))
    assert len(words) <= 2 * WORDS_A_MINUTE


def test_every_row_of_the_matrix_has_its_file_and_its_tests() -> None:
    for condition in ROWS:
        name = condition.value
        assert (ROOT / f"src/recon/safety/failsafe/{name}.py").is_file()
        assert (ROOT / f"tests/station/failsafe/test_{name}.py").is_file()
