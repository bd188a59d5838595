"""docs/how-to/plan-a-survey.md: its commands run, and print what the page shows."""

import re
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.site.survey_cameras import read_survey_cameras

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/how-to/plan-a-survey.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^ *```(\w*)\n(.*?)^ *```", PAGE, re.DOTALL | re.MULTILINE)
COMMANDS = [
    line.strip()
    for _, block in BLOCKS
    for line in block.splitlines()
    if line.strip().startswith("recon plan")
]


def output(command: str, folder: Path) -> str:
    words = shlex.split(command)[1:]
    words = [str(folder / w) if w.startswith("plan.") else w for w in words]
    words = [str(ROOT / w) if (ROOT / w).exists() else w for w in words]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    return result.output


def test_the_first_command_prints_what_the_page_shows(tmp_path: Path) -> None:
    shown = next(block for _, block in BLOCKS if block.startswith("area  "))
    assert output(COMMANDS[0], tmp_path) == shown
    drawn = (tmp_path / "plan.png").read_bytes()
    assert drawn.startswith(b"\x89PNG")
    assert (tmp_path / "plan.geojson").is_file()


@pytest.mark.parametrize("command", COMMANDS[1:])
def test_the_other_commands_run(command: str, tmp_path: Path) -> None:
    assert "speed  " in output(command, tmp_path)


def test_the_pages_camera_is_read(tmp_path: Path) -> None:
    (toml,) = (block for language, block in BLOCKS if language == "toml")
    (tmp_path / "cameras.toml").write_text(toml, encoding="utf-8")
    assert list(read_survey_cameras(tmp_path)) == ["a6000-16mm"]
