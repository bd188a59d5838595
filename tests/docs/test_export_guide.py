"""docs/how-to/fly-a-plan-without-the-app.md: its commands run, its table is the code's."""

import re
import shlex
from itertools import pairwise
from pathlib import Path

import pytest
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.plans.aircraft import AIRCRAFT, PAYLOADS
from recon.plans.features import CANNOT, ByHand, FlightFeature, FormatName

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/how-to/fly-a-plan-without-the-app.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^recon plan .+$", PAGE, re.MULTILINE)


def table() -> str:
    """The code's table as the page shows it."""
    names = [f"`{each.value}`" for each in FormatName]
    lines = [f"| | {' | '.join(names)} |", f"|---|{'---|' * len(names)}"]
    for feature in FlightFeature:
        cells = [said(CANNOT[name].get(feature)) for name in FormatName]
        lines.append(f"| {feature} | {' | '.join(cells)} |")
    return "\n".join(lines)


def said(lack: object) -> str:
    if lack is None:
        return "file"
    return "by hand" if isinstance(lack, ByHand) else "refused"


def test_the_page_has_the_codes_table_and_names() -> None:
    assert table() in PAGE
    unwrapped = re.sub(r"\s+", " ", PAGE)
    assert ", ".join(AIRCRAFT) in unwrapped
    assert ", ".join(PAYLOADS) in unwrapped


@pytest.mark.parametrize("command", COMMANDS)
def test_its_commands_write_their_files(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = [str(ROOT / w) if (ROOT / w).is_file() else w for w in shlex.split(command)[1:]]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    asked = [w for before, w in pairwise(words) if before == "--export"]
    written = {path.name for path in tmp_path.iterdir()}
    if "--drones" in words:
        asked = [f"river-drone-{n}-flight-1.kmz" for n in (1, 2)]
        assert all(f"`{name}`" in PAGE for name in asked)
    assert written == set(asked)
