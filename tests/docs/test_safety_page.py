"""SAFETY.md has the matrix, every rule and ten invariants in two pages; docs/safety/ the rest."""

import re
from pathlib import Path

from recon.model.failsafe_matrix import Activity
from recon.safety.failsafe import ROWS, cell_words
from recon.safety.rules import RULES
from recon.safety.watchdogs import WATCHDOGS

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "SAFETY.md").read_text(encoding="utf-8")
WATCHING = (ROOT / "docs/safety/watching.md").read_text(encoding="utf-8")
MAX_WORDS = 2_000
WORDS_A_MINUTE = 250
"""Usual for prose; the table's cells count as prose, its file names do not."""


def test_the_page_has_two_thousand_words_at_most() -> None:
    assert len(PAGE.split()) <= MAX_WORDS


def test_the_page_leads_to_every_page_on_safety() -> None:
    pages = {f"docs/safety/{page.name}" for page in (ROOT / "docs/safety").glob("*.md")}
    assert pages == set(re.findall(r"\| \[[a-z ]+\]\((docs/safety/\w+\.md)\) \|", PAGE))


def test_ten_invariants_name_their_code_and_their_tests() -> None:
    pattern = r"(\d+)\. [^`]+? Enforced by `([^`]+)`, shown by `(tests/[^`]+)`\."
    rows = re.findall(pattern, " ".join(PAGE.split()))
    assert [int(number) for number, *_ in rows] == list(range(1, 11))
    for _, code, test in rows:
        assert (ROOT / "src/recon" / code).exists()
        assert (ROOT / test).exists()


def test_every_rule_has_its_row_and_every_row_its_rule() -> None:
    rows = re.findall(r"^\| [a-zA-Z ]+ \| .* \| `(\w+)\.py` \|$", PAGE, re.MULTILINE)
    assert sorted(rows) == sorted(rule.__name__ for rule in RULES)


def test_every_watchdog_has_its_row_and_every_row_its_watchdog() -> None:
    pattern = r"^\| ([a-z ]+)(?:, [a-z ]+)? \| .* \| `safety/watchdogs/(\w+)\.py` \|$"
    rows = re.findall(pattern, WATCHING, re.MULTILINE)
    assert {(name.replace(" ", "_"), file) for name, file in rows} == {
        (watchdog.__name__, watchdog.__module__.rsplit(".", 1)[-1]) for watchdog in WATCHDOGS
    }


def test_the_first_page_is_the_default_failsafe_matrix() -> None:
    first = PAGE[: PAGE.index("\n## The gate")]
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
    first = PAGE[: PAGE.index("\n## The gate")]
    words = re.findall(r"[\w.]*\w", re.sub(r"`safety/failsafe/\w+\.py`|\]\(.*?\)", "", first))
    assert len(words) <= 2 * WORDS_A_MINUTE


def test_every_row_of_the_matrix_has_its_file_and_its_tests() -> None:
    for condition in ROWS:
        name = condition.value
        assert (ROOT / f"src/recon/safety/failsafe/{name}.py").is_file()
        assert (ROOT / f"tests/station/failsafe/test_{name}.py").is_file()
