"""The glossary holds every term once, and the terms the code relies on."""

import re
from pathlib import Path

GLOSSARY = Path(__file__).parents[2] / "docs/glossary.md"
REQUIRED = {
    *("audit", "control authority", "dry run", "fault isolation", "fleet return"),
    *("hazard area", "holder", "identity grace", "imaging drone", "intent", "job"),
    *("neutral setpoint", "operation", "order gateway", "owner", "recovery snapshot"),
    *("refusal", "scripted operator", "setpoint stream", "snapshot"),
    *("tracking", "unidentified", "vehicle snapshot", "watchdog", "claiming link"),
}


def terms() -> list[str]:
    rows = re.findall(r"^\| (.+?) \| .+ \|$", GLOSSARY.read_text(encoding="utf-8"), re.MULTILINE)
    assert rows[0] == "term"
    return rows[1:]


def test_every_term_stands_once() -> None:
    keys = [term.casefold() for term in terms()]
    assert len(set(keys)) == len(keys)


def test_the_terms_of_the_language_guide_are_explained() -> None:
    assert set(terms()) >= REQUIRED


def test_every_explanation_has_text_of_its_own() -> None:
    explained = re.findall(r"^\| .+? \| (.+) \|$", GLOSSARY.read_text(encoding="utf-8"), re.M)
    assert len(set(explained)) == len(explained)
    assert all(len(text) >= 5 for text in explained[1:])
