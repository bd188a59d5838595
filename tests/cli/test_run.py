"""`recon run` as a person meets it: addresses, one sentence for what is wrong, a clean end."""

import contextlib
import json
import signal
import socket
import urllib.request
from pathlib import Path
from time import monotonic, sleep

import pytest
from mcap.reader import make_reader
from tests.basemap.made_maps import FIELD, colour_in, colour_of, keys_over, write_mbtiles
from tests.cli.processes import PATIENCE_S, started

from recon import wire
from recon.model.errors import RecordError
from recon.model.geo import GeoPoint
from recon.record.audit.audit import STOPPED_KIND
from recon.record.mcap.link_bytes import LINKS_TOPIC, link_bytes
from recon.record.mcap.mcap_repair import is_finished
from recon.site.new_site import NewSiteFields, make_site
from recon.site.reading import MAPS_FOLDER
from recon.station.recording.playback import Playback
from recon.station.recording.replay import check

FREE = ("--link-port", "0", "--http-port", "0", "--no-guard")
HELLO = wire.encode(wire.MessageString(type=1, text=b"hello"))


def link_port(line: str) -> int:
    return int(line.rpartition(":")[2])


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_prints_its_addresses_and_ends_cleanly(number: int, tmp_path: Path) -> None:
    """Also with an app connected: what it sent is in the record."""
    with started("run", *FREE, "--record", str(tmp_path / "raw")) as recon:
        port = link_port(recon.line_with("companion apps: 127.0.0.1:"))
        console = recon.line_with("console: http://127.0.0.1:").partition(": ")[2]
        with urllib.request.urlopen(f"{console}/api/state", timeout=120) as response:
            assert json.load(response)["vehicles"] == []
        with socket.create_connection(("127.0.0.1", port)) as app:
            recon.line_with("app connected")
            app.sendall(HELLO)
            app.shutdown(socket.SHUT_WR)
            recon.line_with("app disconnected")
            assert recon.end(number) == 0
        assert "Traceback" not in recon.text
    (record,) = (tmp_path / "raw").iterdir()
    assert is_finished(record)
    assert HELLO in received(record)
    with contextlib.closing(Playback(record)) as playback:
        assert list(playback.move(playback.ends_ns).station.fleet.links) == [1]


def test_stopped_again_and_again_it_still_ends_as_a_stop(tmp_path: Path) -> None:
    """Ctrl+C comes more than once: a launcher passes it on, and people repeat it."""
    with started("run", *FREE, "--record", str(tmp_path / "raw")) as recon:
        port = link_port(recon.line_with("companion apps: 127.0.0.1:"))
        recon.line_with("console")
        with socket.create_connection(("127.0.0.1", port)) as app:
            recon.line_with("app connected")
            app.sendall(HELLO)
            end_s = monotonic() + PATIENCE_S
            while recon.is_running:
                assert monotonic() < end_s
                recon.send(signal.SIGINT)
                sleep(0.005)
        assert recon.wait() == 0
        assert "station stopped" in recon.text
    (record,) = (tmp_path / "raw").iterdir()
    assert is_finished(record)


def received(record: Path) -> bytes:
    """What apps have sent, by a record that may be in the making."""
    with record.open("rb") as file:
        if file.read(8) != b"\x89MCAP0\r\n":
            return b""
        with contextlib.suppress(RecordError):
            parts = []
            for each in link_bytes(file):
                parts += [each.data] if each.is_from_app else []
    return b"".join(parts)


def test_a_killed_stations_record_is_finished_by_its_process(tmp_path: Path) -> None:
    with started("run", *FREE, "--record", str(tmp_path)) as recon:
        port = link_port(recon.line_with("companion apps: 127.0.0.1:"))
        console = recon.line_with("console: http://127.0.0.1:").partition(": ")[2]
        with socket.create_connection(("127.0.0.1", port)) as app:
            app.sendall(HELLO)
            end_s = monotonic() + PATIENCE_S
            while not any(HELLO in received(each) for each in tmp_path.iterdir()):
                assert monotonic() < end_s
                sleep(0.02)
            with urllib.request.urlopen(f"{console}/api/flights", timeout=120) as response:
                (listed,) = json.load(response)
            recon.end(signal.SIGKILL)
    (record,) = tmp_path.iterdir()
    assert (listed["name"], listed["is_recording"]) == (record.stem, True)
    while not is_finished(record):
        assert monotonic() < end_s
        sleep(0.02)
    with record.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert LINKS_TOPIC in {each.topic for each in summary.channels.values()}
    found = check(record)
    assert (found.differences, found.trouble) == ([], "")
    assert found.steps > 0


def test_an_app_still_connected_at_the_end_is_recorded(tmp_path: Path) -> None:
    with started("run", *FREE, "--record", str(tmp_path)) as recon:
        port = link_port(recon.line_with("companion apps"))
        recon.line_with("console")
        with socket.create_connection(("127.0.0.1", port)) as app:
            app.sendall(HELLO)
            recon.line_with("app connected")
            assert recon.end(signal.SIGTERM) == 0
            app.settimeout(20)
            with contextlib.suppress(ConnectionResetError):
                assert app.recv(1) == b""
    assert len(list(tmp_path.iterdir())) == 1
    assert "Traceback" not in recon.text


def test_a_flight_is_recorded_unless_that_is_not_wanted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    for option, is_recorded in (("--no-record", False), ("--guard", True)):
        with started("run", "--link-port", "0", "--http-port", "0", option) as recon:
            recon.line_with("console: ")
            assert recon.end(signal.SIGTERM) == 0
        assert ("records: " in recon.text) == is_recorded
    assert len(list((tmp_path / "recon" / "records").glob("ground-*.mcap"))) == 1


def refused(*options: str, code: int = 1) -> str:
    """Run with options that cannot work; return the one sentence."""
    with started("run", *options) as recon:
        assert recon.wait() == code
        assert "Traceback" not in recon.text
        assert "station started" not in recon.text
        assert "fault" not in recon.text
        return recon.text


def test_a_link_port_in_use_is_one_sentence() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        error = refused("--link-port", str(port), "--http-port", "0")
    assert f"port {port} of 127.0.0.1 is in use" in error
    assert "--link-port" in error


def test_an_http_port_in_use_is_one_sentence() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        error = refused("--link-port", "0", "--http-port", str(port))
    assert f"port {port} of 127.0.0.1 is in use" in error
    assert "--http-port" in error


def test_a_port_bound_but_not_yet_listening_is_in_use() -> None:
    """Two stations started in the same moment."""
    with socket.socket() as other:
        other.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        other.bind(("127.0.0.1", 0))
        port = other.getsockname()[1]
        # The guard's port would be the next one, which nobody keeps free.
        ports = ("--link-port", "0", "--http-port", str(port), "--no-guard")
        with started("run", *ports) as first:
            first.line_with("console:")
            assert "is in use" in refused(*ports)
            assert first.end(signal.SIGINT) == 0


@pytest.mark.parametrize(
    ("options", "text", "code"),
    [
        (("--site", "/nowhere/at/all"), "/nowhere/at/all", 2),
        (("--http-host", "0.0.0.0"), "recon user add NAME --role operator", 2),
        (("--http-host", "::"), "--https-host ::", 2),
        (("--https-host", "0.0.0.0", "--users", "/nowhere/users.toml"), "recon user add NAME", 2),
        (("--certificate", "/nowhere.pem"), "--certificate and --key belong together", 2),
        (("--link-host", "203.0.113.77"), "--link-port", 1),
        (("--announce",), "add --link-host 0.0.0.0", 2),
        (("--link-host", "no.such.host.invalid"), "no.such.host.invalid", 1),
        (("--record", "/proc/none"), "--record", 2),
        (("--link-port", "70000"), "--link-port", 2),
        (("--nonsense",), "nonsense", 2),
    ],
)
def test_wrong_options_are_one_sentence(options: tuple[str, ...], text: str, code: int) -> None:
    given = dict.fromkeys(options)
    free = FREE if "--link-port" not in given else FREE[2:]
    assert text in refused(*free, *options, code=code)


def test_the_audit_of_a_refused_start_is_no_faults(tmp_path: Path) -> None:
    sentence = refused(*FREE, "--audit", str(tmp_path), "--light-sensors", "tcp:4002", code=2)
    assert "\nrecon run: --light-sensors: expected a CSV file" in sentence
    (audit,) = tmp_path.glob("*.jsonl")
    last = json.loads(audit.read_text(encoding="utf-8").splitlines()[-1])
    assert last["kind"] == STOPPED_KIND
    assert last["text"].startswith("station not started: --light-sensors: expected a CSV file")


def test_a_station_shows_the_base_maps_of_its_sites_folder(tmp_path: Path) -> None:
    folder = tmp_path / "field"
    make_site(
        folder,
        GeoPoint(41.9015, -93.602, 275.0),
        NewSiteFields(name="field", drones=0, has_imager=False),
    )
    (folder / MAPS_FOLDER).mkdir()
    first, *keys = keys_over(FIELD, range(15, 17))
    assert keys[0][0] == first[0] == 15
    write_mbtiles(folder / MAPS_FOLDER / "a.mbtiles", keys)
    with started("run", *FREE, "--site", str(folder), "--no-record") as recon:
        console = recon.line_with("console: http://127.0.0.1:").partition(": ")[2]
        with urllib.request.urlopen(f"{console}/api/maps", timeout=120) as response:
            (listed,) = json.load(response)["maps"]
        # Without a boundary: of what is in reach, of which the file lacks one tile.
        assert (listed["name"], listed["covers"]["zoom"]) == ("a.mbtiles", 15)
        assert 0.0 < listed["covers"]["share"] < 1.0
        path = "/".join(str(number) for number in keys[-1])
        with urllib.request.urlopen(f"{console}/api/maps/a.mbtiles/{path}", timeout=120) as tile:
            assert colour_in(tile.read()) == colour_of(*keys[-1])
        assert recon.end(signal.SIGINT) == 0
        assert "Traceback" not in recon.text
