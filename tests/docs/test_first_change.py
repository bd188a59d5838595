"""docs/your-first-change.md: its steps, taken in a copy of the tree, add a rule that passes."""

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/your-first-change.md").read_text(encoding="utf-8")
STEP = re.compile(
    r"^(?P<verb>Create|In) `(?P<file>[^`]+)`"
    r"(?:,\s(?P<side>above|below)\sthe\sline(?:\sthat\sbegins\swith)?\s`(?P<anchor>[^`]+)`, add)?"
    r":\n\n```\w*\n(?P<block>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
FOLDERS = ("src/recon", "tests/safety", "docs/safety")
FILES = ("SAFETY.md", "pyproject.toml", "tests/*.py", "tests/docs/test_safety_page.py")
RULES = "tests/safety/rules"
CHECKED = (
    f"{RULES}/test_takeoff_wind.py",
    f"{RULES}/test_exact_refusals.py",
    "tests/docs/test_safety_page.py::test_every_rule_has_its_row_and_every_row_its_rule",
)
LISTS = CHECKED[1:]
"""What must name a new rule, so that it fails while the rule is in no list."""


@dataclass(frozen=True)
class Step:
    file: str
    block: str
    side: str | None
    anchor: str | None


def steps() -> list[Step]:
    return [
        Step(step["file"], step["block"], step["side"], step["anchor"])
        for step in STEP.finditer(PAGE)
    ]


def take(step: Step, root: Path) -> None:
    file = root / step.file
    if step.anchor is None:
        assert not file.exists()
        file.write_text(step.block, encoding="utf-8")
        return
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    (at,) = (n for n, line in enumerate(lines) if line.startswith(step.anchor))
    lines.insert(at + (step.side == "below"), step.block)
    file.write_text("".join(lines), encoding="utf-8")


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    for folder in FOLDERS:
        shutil.copytree(ROOT / folder, tmp_path / folder)
    for file in (file for pattern in FILES for file in ROOT.glob(pattern)):
        target = tmp_path / file.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(file, target)
    return tmp_path


def is_formatted(root: Path) -> bool:
    files = {step.file for step in steps() if step.file.endswith(".py")}
    ruff = [sys.executable, "-m", "ruff"]
    done = (
        subprocess.run([*ruff, *options, *sorted(files)], cwd=root, check=False).returncode
        for options in (["format", "--check", "--quiet"], ["check", "--quiet"])
    )
    return not any(done)


def failures(root: Path, *tests: str) -> tuple[int, str]:
    """Run tests of the copy; return how many failed, and what was printed."""
    options = ["-p", "no:cacheprovider", "--noconftest"]
    run = subprocess.run(
        [sys.executable, "-m", "pytest", *options, *tests],
        cwd=root,
        env={
            **os.environ,
            "PYTHONPATH": f"{root}/src:{root}",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # for a quick start
        },
        capture_output=True,
        text=True,
        check=False,
    )
    found = re.search(r"(\d+) failed", run.stdout)
    assert run.returncode == (1 if found else 0), run.stdout + run.stderr
    return int(found[1]) if found else 0, run.stdout


def test_the_page_has_seven_steps_in_five_files() -> None:
    assert len({step.file for step in steps()}) == 5
    assert len(steps()) == 7 == len(re.findall(r"^(?:Create|In) `", PAGE, re.MULTILINE))


def test_without_its_rows_the_rule_is_refused_and_with_them_it_passes(copy: Path) -> None:
    rule, *lists = steps()
    for step in (rule, *lists[:2]):
        take(step, copy)
    failed, printed = failures(copy, *LISTS)
    assert failed == 2, printed
    for step in lists[2:]:
        take(step, copy)
    assert is_formatted(copy)
    failed, printed = failures(copy, *CHECKED)
    assert failed == 0, printed
