"""Nothing copyleft is linked or built in; what is imported and copyleft is named on a page."""

from pathlib import Path

import pytest
from tools.licences import crates, is_permissive, named_table, npm_packages

PAGE = Path(__file__).parents[2] / "docs/licences.md"


def test_all_inside_the_wheel_is_permissive() -> None:
    inside = [*crates(), *npm_packages()]
    assert {"pyo3", "solid-js", "maplibre-gl"} <= {part.name for part in inside}
    assert [
        f"{part.name}: {part.licence}" for part in inside if not is_permissive(part.licence)
    ] == []


def test_copyleft_packages_are_named() -> None:
    assert named_table() in PAGE.read_text(encoding="utf-8"), "python -m tools.licences prints it"


@pytest.mark.parametrize(
    ("licence", "is_free"),
    [
        ("MIT", True),
        ("GPL-3.0-only OR MIT", True),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", True),
        ("Apache-2.0 WITH LLVM-exception", True),
        ("MIT AND LGPL-2.1-or-later", False),
        ("MPL-2.0", False),
        ("unknown", False),
    ],
)
def test_an_expression_is_permissive_by_a_choice_of_each_part(licence: str, is_free: bool) -> None:
    assert is_permissive(licence) is is_free
