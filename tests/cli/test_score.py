"""`recon score` on the command line: repeatable tables, errors in one line."""

import signal
from collections.abc import Iterator
from pathlib import Path
from time import sleep

import pytest
from tests.cli.processes import started
from tests.score.scenes import BRIEF, SMALL, written
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.score.scenario_schema import METHOD_NAMES

FEW = ["--seeds", "2", "--first-seed", "7"]


def known(stage: str) -> str:
    return " or ".join(METHOD_NAMES[stage])


@pytest.fixture(scope="module", autouse=True)
def _kept_here(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """What one test has flown is not flown again by another."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.mark.flight
def test_tables_go_to_stdout_and_a_stopped_command_goes_on_where_it_was(tmp_path: Path) -> None:
    path = str(written(tmp_path, BRIEF))
    one = CliRunner().invoke(app, ["score", path, "--seeds", "1", "--first-seed", "7"])
    assert one.exit_code == 0, one.stderr
    assert [line.split(":")[0] for line in one.stderr.splitlines()] == ["seed 7"]
    both = CliRunner().invoke(app, ["score", path, *FEW, "--jobs", "1"])
    assert "1 of 2 runs were flown before" in both.stderr
    assert "seed 7" not in both.stderr
    assert "seed 8" in both.stderr
    assert "ideal, forecast advection, planner lawnmower_again; 2 seeds" in both.stdout
    assert "| time to 95 % in sun, min |" in both.stdout
    assert "| shade IoU | 0.9" in both.stdout  # ideal pixels, projected by telemetry
    assert "| unknown, % | 0.0 |" in both.stdout
    assert "| Brier, not seen |" in both.stdout
    assert "| time to shade, within the horizon |" in both.stdout
    assert "| violations: outside the fence | 0.0 |" in both.stdout
    # Flown anew, in two processes: the same to the byte.
    fresh = CliRunner().invoke(app, ["score", path, *FEW, "--fresh", "--jobs", "2"])
    assert fresh.stdout_bytes == both.stdout_bytes
    assert "before" not in fresh.stderr
    assert "2 of 2 runs, about 0 min left" in fresh.stderr
    again = CliRunner().invoke(app, ["score", path, "--seeds", "1", "--first-seed", "7"])
    assert again.stdout_bytes == one.stdout_bytes
    # Of another method nothing was flown before.
    options = ["--seeds", "1", "--first-seed", "7", "--planner", "lawnmower_once"]
    other = CliRunner().invoke(app, ["score", path, *options, "--forecast", "none"])
    assert "before" not in other.stderr
    assert "forecast none, planner lawnmower_once; 1 seeds" in other.stdout
    assert "Brier" not in other.stdout


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="the kernel lists processes there")
def test_its_processes_end_with_a_command_that_is_killed(tmp_path: Path) -> None:
    path = str(written(tmp_path, SMALL))
    with started("score", path, *FEW, "--jobs", "2") as command:
        while len(_flying(command.pid)) < 2:
            sleep(0.05)
        command.end(signal.SIGKILL)
        # All that could print has ended; a run that went on would state its minutes.
        assert command.text == ""


def _flying(pid: int) -> list[str]:
    """The processes of the command that have Recon's code loaded, to fly runs."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [
        each
        for each in children
        if b"spawn_main" in Path(f"/proc/{each}/cmdline").read_bytes()
        and "recon/wire" in Path(f"/proc/{each}/maps").read_text()
    ]


def test_all_forecasts_are_compared_with_one(tmp_path: Path) -> None:
    options = ["--seeds", "1", "--against", "persistence"]
    done = CliRunner().invoke(app, ["score", str(written(tmp_path, BRIEF)), *options])
    assert done.exit_code == 0
    assert "| forecast by advection | 15 s |" in done.stdout
    assert "| Brier, seen | 15 s |" in done.stdout
    heading, _line, *rows = done.stdout.partition("| Brier over that of persistence, seen ")[
        2
    ].splitlines()
    methods = {row.split(" | ")[0].strip("| ") for row in rows if row}
    assert {"climatology", "advection", "true_motion"} <= methods
    assert "15 s" in heading


@pytest.mark.flight
def test_two_planners_are_compared_seed_by_seed(tmp_path: Path) -> None:
    path = str(written(tmp_path, BRIEF))
    options = ["--planner", "sunlit_first", "--seeds", "1", "--first-seed", "7"]
    done = CliRunner().invoke(app, ["score", path, *options, "--against", "lawnmower_again"])
    assert done.exit_code == 0, done.stderr
    assert "planner sunlit_first; 1 seeds" in done.stdout
    assert "| over lawnmower_again | ratio | 95 % | runs |" in done.stdout
    # The other planner's run is kept like any other.
    other = ["score", path, "--planner", "lawnmower_again", *options[2:]]
    assert "1 of 1 runs were flown before" in CliRunner().invoke(app, other).stderr


@pytest.mark.flight
def test_another_scenario_is_compared_seed_by_seed(tmp_path: Path) -> None:
    path = written(tmp_path, BRIEF)
    other = tmp_path / "slower.toml"
    other.write_text(path.read_text().replace("height_m", "speed_mps = 7.0\nheight_m"))
    options = ["--planner", "lawnmower_once", "--seeds", "1", "--surveys-only"]
    done = CliRunner().invoke(app, ["score", str(path), *options, "--against", str(other)])
    assert done.exit_code == 0, done.stderr
    assert "| over slower | ratio | 95 % | runs |" in done.stdout
    done = CliRunner().invoke(app, ["score", str(path), *options, "--against", "absent.toml"])
    assert done.exit_code == 2
    assert "absent.toml" in done.stderr


@pytest.mark.flight
def test_surveys_alone_are_flown_the_same_and_score_no_maps(tmp_path: Path) -> None:
    path = str(written(tmp_path, BRIEF))
    options = ["--planner", "lawnmower_once", "--seeds", "1"]
    whole, alone = (
        CliRunner().invoke(app, ["score", path, *options, *more]).stdout.rstrip().split("\n\n")
        for more in ([], ["--surveys-only"])
    )
    assert whole[1] == alone[1]
    assert "| time to 95 % imaged, min |" in alone[1]
    assert len(alone) == 2 < len(whole)


@pytest.mark.flight
def test_a_detection_is_compared_with_the_ideal_one_seed_by_seed(tmp_path: Path) -> None:
    path = str(written(tmp_path, BRIEF + "[conditions]\nperiod_s = 5.0\n"))
    options = ["--detection", "otsu", "--forecast", "none", "--seeds", "1"]
    done = CliRunner().invoke(app, ["score", path, *options, "--against", "ideal"])
    assert done.exit_code == 0, done.stderr
    assert "detection otsu" in done.stdout
    assert "| over ideal | ratio | 95 % | runs |" in done.stdout


def test_the_perfect_forecast_is_flown_and_compared_with_methods(tmp_path: Path) -> None:
    options = ["--forecast", "perfect", "--against", "persistence", "--seeds", "1"]
    done = CliRunner().invoke(app, ["score", str(written(tmp_path, BRIEF)), *options])
    assert done.exit_code == 0, done.stderr
    assert "forecast perfect, planner lawnmower_again; 1 seeds" in done.stdout
    assert "| forecast by perfect | 15 s |" in done.stdout
    # It states no time to shade that could be scored.
    assert "| median error, s | - | - | 1 |" in done.stdout
    rows = done.stdout.partition("| Brier over that of persistence, all ")[2].splitlines()
    (perfect,) = (row for row in rows if row.startswith("| perfect | "))
    assert float(perfect.split(" | ")[1].split()[0]) < 0.1


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--seeds", "0"], "expected --seeds of 1 to 10000"),
        (["--first-seed", "-1"], "--first-seed of 0 or more"),
        (
            ["--planner", "magic"],
            f"--planner: expected {known('planner')}, got",
        ),
        (["--detection", "magic"], f"--detection: expected {known('detection')}, got"),
        (["--forecast", "magic"], f"--forecast: expected {known('forecast')}, got"),
        (["--against", "magic"], "--against: expected advection or persistence or"),
        (["--against", "persistence", "--forecast", "none"], "expected a forecast to compare"),
        (["--against", "persistence", "--surveys-only"], "--surveys-only: expected --against a"),
        (
            ["--forecast", "perfect", "--detection", "otsu"],
            "--forecast: expected detection ideal with the forecast perfect, got detection otsu",
        ),
        (
            ["--forecast", "perfect", "--against", "otsu"],
            "--forecast: expected detection ideal with the forecast perfect, got detection otsu",
        ),
        (["--jobs", "0"], "--jobs: expected 1 or more, got 0"),
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
