"""Kept runs are found until something changes that they follow from."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import recon
from recon.score.kept_runs import ROOMS_WITHOUT_RUNS, code_digest

PACKAGE = Path(recon.__file__).parent


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Some of the code, in a place where it may be changed."""
    folder = tmp_path / "recon"
    for room in ("guidance", *ROOMS_WITHOUT_RUNS):
        shutil.copytree(PACKAGE / room, folder / room, ignore=shutil.ignore_patterns("*.pyc"))
    monkeypatch.setattr(recon, "__file__", str(folder / "__init__.py"))
    return folder


def _digest() -> str:
    return code_digest.__wrapped__()


@pytest.mark.parametrize("room", ["guidance", *ROOMS_WITHOUT_RUNS])
def test_a_change_counts_only_where_runs_are_flown(copy: Path, room: str) -> None:
    before = _digest()
    with next((copy / room).glob("*.py")).open("a") as file:
        file.write("# changed\n")
    assert (_digest() == before) == (room in ROOMS_WITHOUT_RUNS)


def test_a_module_under_another_name_is_another_code(copy: Path) -> None:
    before = _digest()
    (copy / "guidance" / "__init__.py").rename(copy / "guidance" / "begin.py")
    assert _digest() != before


def test_no_run_imports_the_rooms_that_do_not_count() -> None:
    """A survey's run, with all that it imports on its way."""
    program = """
import sys
from dataclasses import replace
from pathlib import Path
from recon.score import load_scenario
from recon.score.many_runs import run
scenario = load_scenario(Path(sys.argv[1]))
run(replace(scenario, limit_s=20.0), 1)
print(*sorted({name.split(".")[1] for name in sys.modules if name.startswith("recon.")}))
"""
    path = Path(__file__).parents[2] / "scenarios" / "clear-sky.toml"
    command = [sys.executable, "-c", program, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    loaded = done.stdout.split()
    assert "guidance" in loaded
    assert not set(loaded) & set(ROOMS_WITHOUT_RUNS)
