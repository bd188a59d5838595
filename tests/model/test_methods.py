"""Methods of installed packages: found by name, and left out with a sentence."""

from pathlib import Path

import pytest
from tests.outside_package import install

from recon.model.methods import MethodError, MethodRegistry

GROUP = "recon.made_methods"
OWN = {"usual": len}


def methods() -> MethodRegistry:
    return MethodRegistry(GROUP, OWN, callable)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def test_without_packages_there_are_our_own() -> None:
    assert dict(methods()) == OWN
    assert methods().problems == ()
    assert "other" not in methods()
    with pytest.raises(KeyError):
        methods()["other"]


def test_a_package_adds_its_method(folder: Path) -> None:
    install(folder, "made-good", {GROUP: {"root": "math:sqrt"}})
    found = methods()
    assert found.names == ("usual", "root")
    assert list(found) == ["usual", "root"]
    assert found["root"](9.0) == 3.0
    assert found.problems == ()


@pytest.mark.parametrize(
    ("name", "target", "why"),
    [
        ("broken", "made_broken:run", "expected a module to import, got ZeroDivisionError"),
        ("leaves", "made_leaves:run", "expected a module to import, got SystemExit"),
        ("absent", "no_such_module:run", "expected a module to import, got ModuleNotFoundError"),
        ("constant", "math:pi", "expected a method of its kind, got float"),
    ],
)
def test_one_that_cannot_be_used_is_named_and_disturbs_nobody(
    folder: Path, name: str, target: str, why: str
) -> None:
    (folder / "made_broken.py").write_text("1 / 0\n")
    (folder / "made_leaves.py").write_text("raise SystemExit(3)\n")
    install(folder, "made-bad", {GROUP: {name: target, "root": "math:sqrt"}})
    found = methods()
    assert list(found) == ["usual", "root"]
    assert len(found) == 2
    (problem,) = found.problems
    assert problem.startswith(f"{GROUP}: '{name}' of made-bad: {why}")
    # Asked for by name, it says why; its name is known without importing it.
    assert name in found
    with pytest.raises(MethodError, match=why):
        found[name]


def test_names_that_are_taken_or_strange_are_refused(folder: Path) -> None:
    install(folder, "made-taken", {GROUP: {"usual": "math:sqrt", "a b": "math:sqrt"}})
    install(folder, "made-one", {GROUP: {"twice": "math:sqrt"}})
    install(folder, "made-two", {GROUP: {"twice": "math:exp"}})
    found = methods()
    assert dict(found) == OWN
    assert "twice" not in found
    assert found.refusals == found.problems
    problems = " ".join(found.problems)
    assert "'usual' of made-taken: expected another name" in problems
    assert "'a b' of made-taken: expected a name of letters" in problems
    assert "made-one" in problems
    assert "made-two" in problems
    assert "neither is used" in problems


def test_names_are_known_without_importing(folder: Path) -> None:
    (folder / "made_slow.py").write_text("raise AssertionError('imported')\n")
    install(folder, "made-slow", {GROUP: {"slow": "made_slow:run"}})
    assert methods().names == ("usual", "slow")
    assert "slow" in methods()
