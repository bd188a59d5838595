"""`recon replay FILE` as a person meets it: an address, a flight, no orders, a clean end."""

import json
import signal
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from tests.cli.processes import started
from tests.replay.flights import FOLDER
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.model.errors import RecordError


def test_it_prints_its_address_replays_and_writes_nothing() -> None:
    flight = FOLDER / "survey.mcap"
    before = {path: path.stat().st_mtime_ns for path in FOLDER.iterdir()}
    with started("replay", str(flight), "--http-port", "0") as recon:
        recon.line_with("REPLAY of survey.mcap, 0 min 48 s: no orders possible")
        console = recon.line_with("console: http://127.0.0.1:").partition(": ")[2]
        with urllib.request.urlopen(f"{console}/api/state", timeout=120) as response:
            assert json.load(response)["replay"]["file"] == "survey.mcap"
        stop = urllib.request.Request(f"{console}/api/all-stop", b"", method="POST")
        with pytest.raises(urllib.error.HTTPError, match="409"):
            urllib.request.urlopen(stop, timeout=120)
        assert recon.end(signal.SIGINT) == 0
        assert "Traceback" not in recon.text
    assert {path: path.stat().st_mtime_ns for path in FOLDER.iterdir()} == before


def test_what_cannot_be_replayed_is_refused_with_a_sentence(tmp_path: Path) -> None:
    other = tmp_path / "notes.txt"
    other.write_text("wind 3 m/s from the west")
    refused = CliRunner().invoke(app, ["replay", str(other)])
    assert isinstance(refused.exception, RecordError)
    assert "expected an MCAP file, got one that begins with b'wind 3 m'" in str(refused.exception)
    missing = CliRunner().invoke(app, ["replay", str(tmp_path / "none.mcap")])
    assert missing.exit_code == 2
    assert "No such file or directory" in missing.output
    two = CliRunner().invoke(app, ["replay", "a.mcap", "b.mcap"])
    assert "expected one FILE, for each is one flight; got 2" in " ".join(two.output.split())
