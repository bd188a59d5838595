"""The project's old words stay out of the sources and the pages: `tests/docs/language.py`."""

from pathlib import Path

import pytest
from tests.docs.language import findings, sources

ROOT = Path(__file__).parents[2]
PLACES = (
    "src",
    "web/src",
    "docs",
    "android",
    *sorted(page.name for page in ROOT.glob("*.md")),
    "Makefile",
)


@pytest.mark.parametrize("place", PLACES)
def test_no_old_word_is_used(place: str) -> None:
    files = [ROOT / place] if place == "Makefile" else sources(ROOT / place)
    assert files
    assert [line for file in files for line in findings(file)] == []


def found_in(folder: Path, text: str) -> list[str]:
    page = folder / "page.md"
    page.write_text(text, encoding="utf-8")
    return [line.split("'")[1] for line in findings(page)]


def test_old_words_are_found_in_prose_and_in_identifiers(tmp_path: Path) -> None:
    text = "Nobody told the eye.\ndef ghost_of(crew): ...\nIt is not heard any more."
    found = {word.casefold() for word in found_in(tmp_path, text)}
    assert {"nobody", "told", "ghost", "crew", "heard", "any more"} <= found
    assert any("eye" in word for word in found)


def test_terms_and_code_are_not_taken_for_old_words(tmp_path: Path) -> None:
    text = "A setpoint stream leads to a hold; `if x is None` is code; the watchdog holds it.\n"
    assert found_in(tmp_path, text) == []
