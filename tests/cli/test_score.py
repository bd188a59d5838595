"""`recon score` on the command line: repeatable tables, errors in one line."""

from pathlib import Path

import pytest
from tests.score.scenes import SMALL, written
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.score.scenario_schema import METHOD_NAMES

SHORT = SMALL.replace("limit_min = 10.0", "limit_min = 1.0")
FEW = ["--seeds", "2", "--first-seed", "7"]


def known(stage: str) -> str:
    return " or ".join(METHOD_NAMES[stage])


def test_tables_go_to_stdout_and_progress_to_stderr(tmp_path: Path) -> None:
    path = str(written(tmp_path, SHORT))
    first, second = (CliRunner().invoke(app, ["score", path, *FEW]) for _ in range(2))
    assert first.exit_code == 0
    assert first.stdout_bytes == second.stdout_bytes
    assert "ideal, forecast global_shift, planner lawnmower_again; 2 seeds" in first.stdout
    assert "| time to 95 % in sun, min |" in first.stdout
    assert "| shade IoU | 0.94 |" in first.stdout  # ideal pixels, laid by telemetry
    assert "| unknown, % | 0.0 |" in first.stdout
    assert "| Brier, beyond horizon |" in first.stdout
    assert "| violations: outside the fence | 0.0 |" in first.stdout
    assert [line.split(":")[0] for line in first.stderr.splitlines()] == ["seed 7", "seed 8"]
    assert "times faster than real time" in first.stderr


def test_options_choose_methods(tmp_path: Path) -> None:
    options = ["--planner", "lawnmower_once", "--forecast", "none", "--seeds", "1"]
    done = CliRunner().invoke(app, ["score", str(written(tmp_path, SHORT)), *options])
    assert done.exit_code == 0
    assert "forecast none, planner lawnmower_once; 1 seeds" in done.stdout
    assert "Brier" not in done.stdout


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--seeds", "0"], "expected --seeds of 1 to 10000"),
        (["--first-seed", "-1"], "--first-seed of 0 or more"),
        (["--planner", "magic"], "--planner: expected lawnmower_once or lawnmower_again, got"),
        (["--detection", "magic"], f"--detection: expected {known('detection')}, got"),
        (["--forecast", "magic"], f"--forecast: expected {known('forecast')}, got"),
    ],
)
def test_invalid_options_are_one_line(tmp_path: Path, options: list[str], words: str) -> None:
    done = CliRunner().invoke(app, ["score", str(written(tmp_path)), *options])
    assert (done.exit_code, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1
    assert done.stderr.startswith("recon score: ")
    assert words in done.stderr


def test_an_invalid_scenario_names_its_line(tmp_path: Path) -> None:
    path = written(tmp_path, SMALL.replace("cover = 0.4", "cover = 4"))
    done = CliRunner().invoke(app, ["score", str(path)])
    assert done.exit_code == 2
    assert done.stderr.startswith(f"recon score: {path}:24: clouds[0].cover: expected 0 to 1, got")
