"""`recon pair` at a real station: an app from another loopback address waits, and is admitted."""

import signal
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.cli.processes import started
from tests.cli.station_process import StationProcess, addresses, run_options
from tests.link.approved import core, extended

from recon.site.app_list import read_app_list

LISTED = '[[apps]]\nserial = "MINE"\naddress = "127.0.0.1"\n'


@contextmanager
def app_from(host: str, port: int, serial: bytes) -> Iterator[socket.socket]:
    """An app that connects from a loopback address, and reports a serial again and again."""
    with socket.create_connection(("127.0.0.1", port), source_address=(host, 0)) as sock:
        is_over = threading.Event()

        def talk() -> None:
            while not is_over.wait(0.2):
                try:
                    sock.sendall(core() + extended(serial))
                except OSError:
                    return

        thread = threading.Thread(target=talk, daemon=True)
        thread.start()
        yield sock
        is_over.set()
        thread.join()


@contextmanager
def station_with_list(folder: Path) -> Iterator[StationProcess]:
    options = (*run_options(folder / "audit"), "--apps", str(folder / "apps.toml"))
    with started(*options) as process:
        url, link_port = addresses(process)
        process.line_with("apps admitted: ")
        yield StationProcess(process, None, url, link_port, folder / "audit")


def waits(station: StationProcess, count: int) -> list[dict[str, object]]:
    """Wait until so many links wait with a serial; return them."""

    def found() -> list[dict[str, object]]:
        links = station.get("/api/state")["links"]
        return [one for one in links if one["waiting"] is not None and one["waiting"]["serial"]]

    while len(found()) != count:
        assert station.station.is_running, station.station.text
    return found()


def test_an_unlisted_app_waits_and_is_paired_for_good(tmp_path: Path) -> None:
    (tmp_path / "apps.toml").write_text(LISTED)
    with station_with_list(tmp_path) as station:
        with app_from("127.0.0.2", station.link_port, b"OTHER"):
            waits(station, 1)
            shown = station.recon("pair")
            assert shown.code == 0
            assert "OTHER" in shown.out
            assert "127.0.0.2:" in shown.out
            paired = station.recon("pair", "OTHER")
            assert paired.code == 0, paired.err
            assert "on the list" in paired.out
            (vehicle,) = station.until(lambda vs: any(v["serial"] == "OTHER" for v in vs))
            assert vehicle["serial"] == "OTHER"
        assert "no app waits" in station.recon("pair").out
        with app_from("127.0.0.3", station.link_port, b"OTHER"):
            waits(station, 1)
            refused = station.recon("pair", "OTHER", "--refuse")
            assert refused.code == 0
            assert "refused for 5 minutes" in refused.out
        station.station.end(signal.SIGTERM)
    entries = [(e.serial, str(e.network)) for e in read_app_list(tmp_path / "apps.toml")]
    assert entries == [("MINE", "127.0.0.1/32"), ("OTHER", "127.0.0.2/32")]
    with (
        station_with_list(tmp_path) as station,
        app_from("127.0.0.2", station.link_port, b"OTHER"),
    ):
        station.until(lambda vs: any(v["serial"] == "OTHER" for v in vs))


def test_a_station_without_a_list_says_so(tmp_path: Path) -> None:
    with started(*run_options(tmp_path / "audit")) as process:
        url, link_port = addresses(process)
        station = StationProcess(process, None, url, link_port, tmp_path / "audit")
        assert "any app is admitted" in station.recon("pair").out
        assert station.recon("pair", "X").code == 2
        assert station.recon("pair", "--refuse").code == 2


def test_a_list_that_is_not_there_stops_the_start(tmp_path: Path) -> None:
    options = (*run_options(tmp_path / "audit"), "--apps", str(tmp_path / "none.toml"))
    with started(*options) as process:
        assert process.wait() == 2
        assert "expected a list of apps" in process.text
