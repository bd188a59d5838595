"""SAFETY.md lists every rule of the gate, and no rule that is not there."""

import re
from pathlib import Path

from recon.safety.rules import RULES
from recon.safety.watchdogs import WATCHDOGS

ROOT = Path(__file__).parents[2]


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


def test_every_file_the_page_names_exists() -> None:
    page = (ROOT / "SAFETY.md").read_text(encoding="utf-8")
    for name in re.findall(r"`(\w+/\w+\.py)`", page):
        assert (ROOT / "src/recon" / name).is_file() or (ROOT / name).is_file(), name
