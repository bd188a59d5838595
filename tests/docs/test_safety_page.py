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
    rows = re.findall(r"\| `safety/watchdogs/(\w+)\.py` \|$", page, re.MULTILINE)
    assert set(rows) == {watchdog.__name__ for watchdog in WATCHDOGS}
    for name in rows:
        assert (ROOT / f"src/recon/safety/watchdogs/{name}.py").is_file()


def test_every_file_the_page_names_exists() -> None:
    page = (ROOT / "SAFETY.md").read_text(encoding="utf-8")
    for name in re.findall(r"`(\w+/\w+\.py)`", page):
        assert (ROOT / "src/recon" / name).is_file() or (ROOT / name).is_file(), name
