"""The Containerfile runs a station without rights, with places to write to."""

import json
import re
from pathlib import Path

import typer

from recon.cli.commands import app

TEXT = (Path(__file__).parents[2] / "Containerfile").read_text(encoding="utf-8")


def words(instruction: str) -> list[str]:
    (found,) = re.findall(rf"^{instruction} (\[.+\])$", TEXT, re.MULTILINE)
    listed: list[str] = json.loads(found)
    return listed


def test_the_station_runs_without_rights_and_writes_to_its_volumes_only() -> None:
    assert re.search(r"^USER (\d+):\1$", TEXT, re.MULTILINE)
    volumes, (name, *options) = words("VOLUME"), words("CMD")
    assert words("ENTRYPOINT") == ["recon"]
    command = typer.main.get_command(app)
    assert isinstance(command, typer.core.TyperGroup)
    run = command.get_command(typer.Context(command), name)
    assert run is not None
    known = {option for each in run.params for option in each.opts}
    assert {word for word in options if word.startswith("--")} <= known
    assert {each for each in options if each.startswith("/")} == set(volumes)
