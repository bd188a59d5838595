"""Ten metaphors stay out of the sources and the pages: `tests/docs/language.py`."""

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
def test_no_metaphor_is_used(place: str) -> None:
    files = [ROOT / place] if place == "Makefile" else sources(ROOT / place)
    assert files
    assert [line for file in files for line in findings(file)] == []


def found_in(folder: Path, text: str) -> list[str]:
    page = folder / "page.md"
    page.write_text(text, encoding="utf-8")
    return [line.split("'")[1] for line in findings(page)]


def test_metaphors_are_found_in_prose_and_in_identifiers(tmp_path: Path) -> None:
    text = "The eye barked.\ndef ghost_of(crew): ...\n`told.py`, told_modes, was_told"
    found = {word.casefold() for word in found_in(tmp_path, text)}
    assert found == {"the eye", "barked", "ghost", "crew", "told.py", "told_modes", "was_told"}


def test_terms_code_and_ordinary_english_are_free(tmp_path: Path) -> None:
    text = (
        "A setpoint stream leads to a hold; `if x is None` is code; the watchdog holds it.\n"
        "Nobody who was told and heard the advice says so any more; people said it.\n"
        "A crewed aircraft is returning home.\n"
    )
    assert found_in(tmp_path, text) == []
