"""Coordinates south and west are numbers, not options; NaN and infinity are none."""

from typing import Annotated

import pytest
import typer
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from recon.cli.commands import COMMANDS, App, ShellCommand, TakesNegativeNumbers
from recon.cli.commands import app as recon

app = App()


@app.command(cls=TakesNegativeNumbers)
def go(
    latitude: float,
    longitude: float,
    height: Annotated[float, typer.Option("--height")] = 0.0,
    is_json: Annotated[bool, typer.Option("--json")] = False,
) -> None:
    typer.echo(f"{latitude!r} {longitude!r} {height!r} {is_json}")


def run(*words: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, words)
    return result.exit_code, result.output


@pytest.mark.parametrize(
    "words",
    [
        ("--height", "-5", "41.9", "-93.6"),
        ("41.9", "-93.6", "--height=-5"),
        ("41.9", "--height", "-5", "-93.6"),
        ("--height", "-5", "--", "41.9", "-93.6"),
    ],
)
def test_they_stand_anywhere_and_need_nothing_before_them(words: tuple[str, ...]) -> None:
    assert run(*words) == (0, "41.9 -93.6 -5.0 False\n")


@given(st.floats(allow_nan=False, allow_infinity=False), st.floats(-180.0, 180.0))
def test_every_number_comes_as_it_was_written(latitude: float, longitude: float) -> None:
    code, output = run(repr(latitude), repr(longitude), "--json")
    assert (code, output) == (0, f"{latitude!r} {longitude!r} 0.0 True\n")


@pytest.mark.parametrize("odd", ["--heigth", "-h", "-9x", "--9", "-", "-inf"])
def test_what_is_no_number_is_refused_as_ever(odd: str) -> None:
    code, output = run("41.9", "-93.6", odd)
    assert code == 2
    assert "Usage" in output


@pytest.mark.parametrize("word", ["nan", "inf", "1e999"])
def test_a_number_that_is_not_finite_is_refused_with_its_name(word: str) -> None:
    for words, name in (
        (("41.9", f"--height={word}", "-93.6"), "'--height'"),
        ((word, "-93.6"), "'latitude'"),
    ):
        code, output = run(*words)
        assert code == 2
        assert f"{name}: expected a number, got {float(word):g}" in output


def test_every_command_refuses_them() -> None:
    group = typer.main.get_group(recon)
    for name in COMMANDS:
        loaded = group.get_command(None, name)
        for command in getattr(loaded, "commands", {name: loaded}).values():
            assert isinstance(command, ShellCommand), (name, command.name)
