"""`recon methods`, and the names that `recon run` takes."""

import pytest
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.cli.methods import check_methods
from recon.detection import DETECTORS
from recon.forecast import FORECASTERS
from recon.guidance.survey import PLANNERS


def test_all_methods_are_listed() -> None:
    lines = CliRunner().invoke(app, ["methods"]).stdout.splitlines()
    listed = [("detection", DETECTORS), ("forecast", FORECASTERS), ("planner", PLANNERS)]
    assert lines == [f"{kind}: {name}" for kind, methods in listed for name in methods]


@pytest.mark.parametrize("option", ["--detection", "--forecast"])
def test_a_station_does_not_start_with_a_method_that_does_not_exist(option: str) -> None:
    done = CliRunner().invoke(app, ["run", option, "by_eye"])
    assert done.exit_code == 2
    assert f"{option}: expected " in done.stderr
    assert "got 'by_eye'" in done.stderr


def test_our_own_are_taken() -> None:
    check_methods("otsu", "persistence")
