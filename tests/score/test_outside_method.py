"""The example package of a method of one's own: installed, scored and verified by its name."""

import os
import subprocess
import sys
from dataclasses import replace
from importlib.metadata import entry_points
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image
from tests.outside_package import install, install_example
from tests.score.scenes import BRIEF, small, written

from recon.score import Scenario, kept_runs
from recon.score.kept_runs import flown_code, runs_digest

ROOT = Path(__file__).parents[2]
PROGRAM = """
import sys
from typer.testing import CliRunner
from recon.cli.commands import app

scenario, maps = sys.argv[1:]
for words in (
    ["methods"],
    ["score", scenario, "--seeds", "1", "--forecast", "half_persistence"],
    ["score", scenario, "--seeds", "1", "--forecast", "half_persistence"],
    ["verify", maps, "--step-s", "10", "--sun", "255", "--shade", "0"],
):
    done = CliRunner().invoke(app, words)
    print("#", *words, done.exit_code, done.stdout, done.stderr, sep="\\n")
"""


def test_it_is_scored_verified_and_listed_like_our_own(tmp_path: Path) -> None:
    packages, maps = tmp_path / "packages", tmp_path / "maps"
    install_example(ROOT / "examples/own_method", packages)
    install(packages, "made-broken", {"recon.planners": {"broken": "no_such_module:plan"}})
    maps.mkdir()
    for number in range(6):
        shade = np.zeros((24, 24), np.uint8)
        shade[:, number * 3 :] = 255
        Image.fromarray(shade).save(maps / f"map-{number}.png")
    path = written(tmp_path, BRIEF)
    text = path.read_text().replace("[wind]", '[methods]\nforecast = "half_persistence"\n\n[wind]')
    path.write_text(text)
    paths = os.pathsep.join([str(packages), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": paths, "XDG_STATE_HOME": str(tmp_path / "state")}
    command = [sys.executable, "-c", PROGRAM, str(path), str(maps)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    listed, scored, again, verified = done.stdout.split("#\n")[1:]
    assert "forecast: half_persistence (recon-own-method 0.1.0)" in listed
    # One that cannot be imported is named, and disturbs nobody.
    for told in (listed, scored):
        assert "recon.planners: 'broken' of made-broken: expected a module to import" in told
    assert "\n0\n" in scored
    assert "detection ideal, forecast half_persistence, planner" in scored
    assert "| Brier, not seen |" in scored
    assert "1 of 1 runs were flown before" in again
    assert "\n0\n" in verified
    assert "half_persistence" in verified


def test_a_changed_method_is_flown_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Kept runs follow from its code, too."""
    install_example(ROOT / "examples/own_method", tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    outside = {"half_persistence": entry_points(name="half_persistence")["half_persistence"]}
    monkeypatch.setattr(kept_runs, "FORECASTERS", SimpleNamespace(outside=outside))
    scenario = small(tmp_path, BRIEF)
    own = replace(scenario, methods=replace(scenario.methods, forecast="half_persistence"))

    def digest(of: Scenario) -> str:
        return runs_digest(tmp_path / "small.toml", of, flown_code(of))

    before, usual = digest(own), digest(scenario)
    with (tmp_path / "own_method.py").open("a") as module:
        module.write("# changed\n")
    assert digest(own) != before
    assert digest(scenario) == usual
