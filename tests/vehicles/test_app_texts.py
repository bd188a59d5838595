"""The extension `recon 1`: its vectors, its page, and whatever bytes come instead."""

import json
import re
from dataclasses import fields
from enum import Enum
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from studies.app_texts import HostileRun

from recon import wire
from recon.model.app_report import AppFacts, OutcomeReport, PhotosReport, ReportedPhoto
from recon.model.report import IgnoredReport, MessageReport, Report
from recon.vehicles.app_texts import FACTS, OUTCOME, PHOTO, PHOTOS, read_app_text
from recon.vehicles.reports import to_report

ROOT = Path(__file__).parents[2]
KINDS = {"facts": AppFacts, "photos": PhotosReport, "outcome": OutcomeReport}


def vectors(name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((ROOT / f"vectors/app_texts/{name}.json").read_text("utf-8"))
    return found


VALID, REFUSED, OTHER = vectors("valid"), vectors("refused"), vectors("other")


def report(text: str) -> Report:
    return to_report(wire.MessageString(type=0, text=text.encode()))


def shown(value: Any) -> Any:
    """A report as JSON has it, without what is unknown."""
    if isinstance(value, tuple):
        return [shown(each) for each in value]
    if isinstance(value, Enum):
        return value.value
    if not hasattr(value, "__slots__"):
        return value
    values = {each.name: getattr(value, each.name) for each in fields(value)}
    return {name: shown(each) for name, each in values.items() if each is not None}


@pytest.mark.parametrize("name", VALID)
def test_a_valid_text_means_what_its_vector_says(name: str) -> None:
    found, expected = report(VALID[name]["text"]), dict(VALID[name]["means"])
    assert type(found) is KINDS[expected.pop("kind")]
    assert shown(found) == expected


@pytest.mark.parametrize("name", REFUSED)
def test_a_refused_text_is_ignored_with_what_was_expected(name: str) -> None:
    expected = f"app text refused: expected {REFUSED[name]['expected']}"
    assert report(REFUSED[name]["text"]) == IgnoredReport(expected)


@pytest.mark.parametrize("name", OTHER)
def test_other_texts_are_ignored_or_ordinary_messages(name: str) -> None:
    kinds = {"ignored": IgnoredReport, "message": MessageReport}
    assert type(report(OTHER[name]["text"])) is kinds[OTHER[name]["is"]]


def test_the_page_lists_the_keys_that_are_read() -> None:
    page = (ROOT / "docs/icd.md").read_text("utf-8").partition("## Facts, photos and outcomes")[2]
    for heading, readers in (
        ("Facts", FACTS),
        ("Photos", PHOTOS),
        ("A photo", PHOTO),
        ("Outcomes", OUTCOME),
    ):
        section = re.split(r"^#+ .*\n", page.partition(f"### {heading}\n")[2], flags=re.M)[0]
        assert re.findall(r"^ *\| `(\w+)` \|", section, re.M) == list(readers), heading


def test_every_key_is_a_field() -> None:
    for kind, readers in (
        (AppFacts, FACTS),
        (PhotosReport, PHOTOS),
        (ReportedPhoto, PHOTO),
        (OutcomeReport, OUTCOME),
    ):
        assert {each.name for each in fields(kind)} == set(readers)


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from([*FACTS, *PHOTO, *PHOTOS, *OUTCOME]), inner, max_size=6)
    ),
    max_leaves=12,
)


@settings(max_examples=200)
@given(st.sampled_from([*KINDS]), JSON_VALUES.filter(lambda value: isinstance(value, dict)))
def test_any_object_is_read_or_refused(kind: str, found: dict[str, Any]) -> None:
    text = "recon 1 " + json.dumps({**found, "kind": kind})
    assert isinstance(report(text), IgnoredReport | KINDS[kind])


@settings(max_examples=200)
@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(raw: bytes) -> None:
    assert read_app_text(b"recon 1 " + raw) is not None


def test_texts_are_sanitised() -> None:
    found = report('recon 1 {"kind":"facts","model":"\\u001b[2J\\ud800x"}')
    assert isinstance(found, AppFacts)
    assert found.model is not None
    assert found.model.isprintable()


def test_hostile_texts_raise_nothing_in_the_whole_step() -> None:
    """A million of them: `python -m studies.app_texts`."""
    run = HostileRun(seed=1)
    run.take(1_500)
    assert {"AppFacts", "PhotosReport", "OutcomeReport", "IgnoredReport"} <= set(run.counts)
