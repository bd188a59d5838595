"""Every bench runs: nothing else does before someone measures."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FEW = ("--apps", "2")
COMMANDS = {
    "cli.bench_first_page": ("--rounds", "1"),
    "cli.bench_startup": ("--repeats", "1"),
    "fields.bench_import": ("--fields", "20", "--only", "register"),
    "fleet.bench_trust": (),
    "gateway.bench_foxglove": ("--vehicles", "2", "--seconds", "1"),
    "gateway.bench_mavlink": ("--vehicles", "2", "--seconds", "1", "--orders", "2"),
    "product.bench_tag": ("--photos", "8"),
    "record.bench_record": ("--seconds", "1"),
    "record.bench_replay_seek": ("--hours", "0.01", "--seeks", "2"),
    "safety.bench_watchdogs": (),
    "station.bench_all_stop": (*FEW, "--streams", "1", "--repeats", "1", "--tile-readers", "1"),
    "station.bench_guard": (*FEW, "--streams", "0", "--repeats", "1"),
    "station.bench_load": (*FEW, "--streams", "1", "--seconds", "1"),
    "station.bench_stick_jitter": (*FEW, "--seconds", "2", "--shared"),
}
MEASURED_BY_HAND = {
    "console.bench_console",
    "product.bench_mosaic",
    "score.bench_flights",
    "station.bench_app_reports",
    "station.bench_state_reader",
}
"""Minutes of Chromium, of a peer that is fetched, or of two checkouts; that their imports exist is
tested with all others."""


def test_every_bench_is_listed() -> None:
    found = (ROOT / "benches").glob("*/bench_*.py")
    assert {f"{each.parent.name}.{each.stem}" for each in found} == {*COMMANDS, *MEASURED_BY_HAND}


def run(*words: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", *words], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.flight
@pytest.mark.parametrize("name", COMMANDS)
def test_a_short_round_runs_to_its_end(name: str) -> None:
    run("tests.benches.short_rounds", name, *COMMANDS[name])


@pytest.mark.flight
def test_those_of_pytest_run_to_their_ends() -> None:
    plugins = ("-p", "tests.benches.short_rounds", "-p", "no:cacheprovider")
    run("pytest", "benches", *plugins)
