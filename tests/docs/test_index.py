"""docs/README.md leads to every page, every decision has a status, every result its command."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
INDEX = (DOCS / "README.md").read_text(encoding="utf-8")
OTHER_INDEX = {"safety": ROOT / "SAFETY.md"}
"""Folders whose pages another page lists."""
LINKED = re.compile(r"\]\(([^)#\s]+\.md)\)")
RESULTS = sorted((DOCS / "results").glob("*.md"))


def test_the_index_leads_to_every_page_once_or_more() -> None:
    linked = {(DOCS / target).resolve() for target in LINKED.findall(INDEX)}
    pages = {page for page in DOCS.glob("**/*.md") if page.parent.name not in OTHER_INDEX}
    assert pages - linked == {DOCS / "README.md"}


def test_every_decision_has_its_title_number_and_status() -> None:
    rows = re.findall(r"^\| \[(\d+) .+\]\((decisions/(\d+)-.+\.md)\) \| (.+) \|$", INDEX, re.M)
    decisions = sorted(f"decisions/{page.name}" for page in (DOCS / "decisions").glob("*.md"))
    assert [page for _, page, _, _ in rows] == decisions
    for number, page, file_number, status in rows:
        assert int(number) == int(file_number), page
        assert re.fullmatch(r"in force|replaced by \[\d+\]\(.+\)", status), page


@pytest.mark.parametrize("page", RESULTS, ids=lambda page: page.name)
def test_every_table_of_results_stands_below_its_command(page: Path) -> None:
    for section in re.split(r"^#+ ", page.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]:
        tables = re.search(r"^\|", section, re.MULTILINE)
        commands = re.search(r"^```\n(?:recon|python -m) ", section, re.MULTILINE)
        if tables is not None:
            assert commands is not None, section.splitlines()[0]
            assert commands.start() < tables.start(), section.splitlines()[0]
