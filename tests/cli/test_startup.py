"""Commands that an operator waits for load no heavy library before they do their work."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from recon import wire
from recon.cli.commands import COMMANDS, app

HEAVY = frozenset(
    {
        *("numpy", "scipy", "cv2", "rasterio", "shapely", "pyproj"),
        *("pydantic", "fastapi", "uvicorn", "httpx", "websockets", "rich"),
    }
)
PROGRAM = """
import atexit, sys
atexit.register(lambda: print(*{name.partition(".")[0] for name in sys.modules}, file=sys.stderr))
from recon.cli import main
main()
"""
STOPS = ("all-stop", "hold", "land", "return")


def loaded_by(*words: str, stdin: bytes = b"") -> set[str]:
    """Return the top-level modules that a command has loaded when it ends."""
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM, *words], input=stdin, capture_output=True, check=True
    )
    return set(ended.stderr.decode().split())


@pytest.mark.parametrize(
    "words",
    [
        ("--help",),
        *((name, "--help") for name in (*STOPS, "goto", "nudge", "take", "status", "inspect")),
    ],
    ids=" ".join,
)
def test_help_loads_no_heavy_library(words: tuple[str, ...]) -> None:
    loaded = loaded_by(*words)
    assert "typer" in loaded
    assert loaded.isdisjoint(HEAVY)


def test_recon_help_loads_no_command() -> None:
    assert not loaded_by("--help") & {"msgspec", "asyncio"}


def test_inspecting_a_stream_without_images_loads_no_heavy_library() -> None:
    stream = wire.encode(wire.Acknowledgment(positive=1, source_pid=253))
    loaded = loaded_by("inspect", "-", stdin=stream)
    assert loaded.isdisjoint(HEAVY)


def test_a_station_starts_without_the_libraries_of_its_jobs() -> None:
    program = "import sys, recon.cli.run; print(*{name.partition('.')[0] for name in sys.modules})"
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert not set(ended.stdout.decode().split()) & {
        "scipy",
        "rasterio",
        "pyproj",
        "rich",
        "mcap",
        "google",
    }


@pytest.mark.parametrize("name", COMMANDS)
def test_a_summary_is_the_first_line_of_the_commands_own_help(name: str) -> None:
    group = typer.main.get_group(app)
    command = group.get_command(typer.Context(group), name)
    assert command is not None
    assert (command.help or "").splitlines()[0] == COMMANDS[name].summary


def test_help_lists_every_command() -> None:
    page = CliRunner().invoke(app, ["--help"]).output
    _, _, listed = page.partition("Commands:\n")
    names = [line.split()[0] for line in listed.splitlines() if line[2:3] not in ("", " ")]
    assert set(names) == set(COMMANDS)


def test_a_mistyped_command_gets_a_suggestion() -> None:
    result = CliRunner().invoke(app, ["al-stop"])
    assert result.exit_code == 2
    assert "Did you mean 'all-stop'" in result.output


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="the kernel counts threads there")
def test_linear_algebra_starts_no_threads() -> None:
    program = """
import os
from recon.cli import main
try:
    main()
finally:
    import numpy
    print("threads:", len(os.listdir("/proc/self/task")))
"""
    environment = {k: v for k, v in os.environ.items() if k != "OPENBLAS_NUM_THREADS"}
    ended = subprocess.run(
        [sys.executable, "-c", program, "--help"],
        env=environment,
        capture_output=True,
        check=True,
    )
    assert "threads: 1" in ended.stdout.decode().splitlines()


def test_a_plan_of_drones_at_one_place_loads_no_solver() -> None:
    field = str(Path(__file__).parents[2] / "examples" / "river-field.geojson")
    loaded = loaded_by("plan", field, "--gsd", "2cm", "--drones", "2")
    assert "numpy" in loaded
    assert "scipy" not in loaded
