"""`recon replay FILE` as a person meets it: an address, a flight, no orders, a clean end."""

import json
import signal
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from tests.basemap.made_maps import FIELD, colour_in, colour_of, keys_over, write_mbtiles
from tests.cli.processes import started
from tests.replay.flights import FOLDER
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.site.reading import MAPS_FOLDER


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
    assert refused.exit_code == 2
    assert "expected a flight record (MCAP), got " in refused.stderr
    missing = CliRunner().invoke(app, ["replay", str(tmp_path / "none.mcap")])
    assert missing.exit_code == 2
    assert "No such file or directory" in missing.output
    two = CliRunner().invoke(app, ["replay", "a.mcap", "b.mcap"])
    assert "expected one FILE, for each is one flight; got 2" in " ".join(two.output.split())
    flight = str(FOLDER / "survey.mcap")
    nowhere = CliRunner().invoke(app, ["replay", flight, "--site", str(tmp_path / "none")])
    assert nowhere.exit_code == 2
    assert "does not exist" in " ".join(nowhere.output.split())


def test_a_replay_shows_the_base_maps_of_the_folder_it_is_given(tmp_path: Path) -> None:
    (tmp_path / MAPS_FOLDER).mkdir()
    keys = keys_over(FIELD, range(15, 17))
    write_mbtiles(tmp_path / MAPS_FOLDER / "field.mbtiles", keys)
    words = ("replay", str(FOLDER / "survey.mcap"), "--http-port", "0", "--site", str(tmp_path))
    with started(*words) as recon:
        console = recon.line_with("console: http://127.0.0.1:").partition(": ")[2]
        with urllib.request.urlopen(f"{console}/api/maps", timeout=120) as response:
            (listed,) = json.load(response)["maps"]
        # Coverage is of the record's site, and this flight was flown without one.
        assert (listed["name"], listed["covers"]) == ("field.mbtiles", None)
        path = "/".join(str(number) for number in keys[0])
        tile = f"{console}/api/maps/field.mbtiles/{path}"
        with urllib.request.urlopen(tile, timeout=120) as response:
            assert colour_in(response.read()) == colour_of(*keys[0])
        assert recon.end(signal.SIGINT) == 0
        assert "Traceback" not in recon.text
