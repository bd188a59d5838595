"""Exit codes over the commands: 0 done, 1 refused or failed, 2 wrong use."""

import errno
import json
from collections.abc import Iterator
from contextlib import closing
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from socket import create_server
from threading import Thread

import pytest
from tests.replay.flights import FOLDER
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.cli.exit_codes import REFUSED, WRONG_USE, exit_code
from recon.client.errors import AddressError, ConnectionLostError, WaitTimeoutError
from recon.model.errors import RecordError

NO_STATION = "http://127.0.0.1:9"
KML = """<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"><Placemark><Point>
<coordinates>-93.6,42.0,0</coordinates></Point></Placemark></kml>"""
FLIGHT = str(FOLDER / "faults.mcap")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "field.kml").write_text(KML)
    (tmp_path / "empty").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    ("line", "code", "words"),
    [
        ("site new own --at 42,-93 --ground-above-sea-level 278m", 0, ""),
        (f"export {FLIGHT} tracks.csv", 0, ""),
        ("run --site nosite", 2, "nosite/site.toml: Folder or site.toml not found"),
        ("demo --site field.kml", 2, "expected a site's folder"),
        ("demo --scenario none.toml", 2, "none.toml"),
        ("site new own --at 142,-93 --ground-above-sea-level 278m", 2, "142"),
        ("site new own --at 42,-93", 2, "expected one of --ground-above-sea-level"),
        ("site check nosite", 2, "recon site new nosite"),
        ("maps check nosite", 2, "Folder or site.toml not found"),
        (f"tag nophotos --flight {FLIGHT}", 2, "nophotos"),
        (f"tag empty --flight {FLIGHT}", 2, "expected"),
        (f"mosaic {FLIGHT} nophotos", 2, "nophotos"),
        ("tag empty --flight none.mcap", 2, "none.mcap"),
        ("replay field.kml", 2, "expected a flight record (MCAP), got an XML file, such as KML"),
        (
            "replay --check field.kml",
            2,
            "expected a flight record (MCAP), got an XML file, such as KML",
        ),
        ("replay none.mcap", 2, "No such file"),
        ("replay", 2, "Missing argument"),
        ("report field.kml", 2, "expected a flight record (MCAP), got an XML file, such as KML"),
        (
            "export field.kml tracks.csv",
            2,
            "expected a flight record (MCAP), got an XML file, such as KML",
        ),
        (f"export {FLIGHT} tracks.shp", 2, "expected .gpx"),
        (f"export {FLIGHT} field.kml", 2, "field.kml exists"),
        ("inspect none", 2, "No such file"),
        ("inspect field.kml", 1, "holds no packet"),
        ("calibrate field.kml --rows 6 --cols 9 --square-mm 25", 2, "got an XML file, such as KML"),
        ("detect empty --camera none.txt --out out", 2, "none.txt"),
        ("verify empty", 2, "expected 3 maps or more"),
        ("forecast empty --out out", 2, "expected 3 maps or more"),
        ("score none.toml", 2, "none.toml"),
        ("plan none.kml --camera mavic3m", 2, "none.kml"),
        ("audit show empty", 2, "expected audit files"),
        ("user remove nobody --users users.toml", 2, "expected a user's name"),
        ("sim --fps 0", 2, "--fps: expected a positive number"),
        ("sim proxy --station nowhere", 2, "--station: expected HOST:PORT"),
        (f"all-stop --station {NO_STATION}", 1, "expected a station at"),
        (f"status --station {NO_STATION}", 1, "expected a station at"),
        ("status --station nowhere://x", 2, "nowhere"),
        (f"status --station {NO_STATION} --token-file none", 2, "cannot read the token file none"),
        (
            f"fly SIM-1 field.kml --station {NO_STATION}",
            2,
            "recon site import read areas",
        ),
        ("warp", 2, "No such command"),
        ("hold --wait -1", 2, "--wait"),
    ],
)
def test_each_command_ends_with_its_code_and_a_sentence(
    here: Path, line: str, code: int, words: str
) -> None:
    ended = CliRunner().invoke(app, line.split())
    assert (ended.exit_code, words in ended.output) == (code, True), ended.output
    assert ended.exception is None or isinstance(ended.exception, SystemExit)


def test_a_taken_port_is_a_failure(here: Path) -> None:
    with closing(create_server(("127.0.0.1", 0))) as taken:
        port = str(taken.getsockname()[1])
        words = ("demo", "--http-port", port, "--link-port", "0", "--no-record")
        ended = CliRunner().invoke(app, words)
    assert ended.exit_code == 1
    assert f"port {port} of 127.0.0.1 is in use" in ended.stderr


class RefusesByRole(BaseHTTPRequestHandler):
    """A station whose every answer is that a role does not include it."""

    def do_POST(self) -> None:
        text = json.dumps({"error": "anna has the role viewer; this needs pilot"}).encode()
        self.send_response(403)
        self.send_header("content-type", "application/json")
        self.send_header("content-length", str(len(text)))
        self.end_headers()
        self.wfile.write(text)

    def log_message(self, format: str, *args: object) -> None:
        pass


@pytest.fixture
def refusing() -> Iterator[str]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), RefusesByRole)
    Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


def test_a_role_that_does_not_include_it_is_a_refusal(refusing: str) -> None:
    ended = CliRunner().invoke(app, ["all-stop", "--station", refusing])
    assert ended.exit_code == 1
    assert ended.stderr == (
        "recon all-stop: refused (role): anna has the role viewer; this needs pilot\n"
    )


@pytest.mark.parametrize(
    ("problem", "cause", "code"),
    [
        (RecordError("what"), None, WRONG_USE),
        (RecordError("what"), FileNotFoundError(errno.ENOENT, "no such file"), WRONG_USE),
        (RecordError("what"), OSError(errno.ENOSPC, "no space left"), REFUSED),
        (RecordError("what"), PermissionError(errno.EACCES, "not permitted"), REFUSED),
        (AddressError("what"), None, WRONG_USE),
        (ConnectionLostError("what"), None, REFUSED),
        (WaitTimeoutError("what"), None, REFUSED),
    ],
)
def test_each_error_has_one_code(problem: RecordError, cause: OSError | None, code: int) -> None:
    problem.__cause__ = cause
    assert exit_code(problem) == code
