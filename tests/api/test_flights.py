"""Recorded flights by the API: lists, figures, files, and requests for what is not there."""

import asyncio
import json
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import uvloop
from tests.api.client import Client
from tests.api.fake_station import FakeStation
from tests.product.made_flight import flight, write_record

from recon.api.flight_routes import FlightBusyError, FlightFileError
from recon.api.security import Access, AccessCheck
from recon.station.api_views.app import create_app
from recon.station.host import background_process, flight_archive
from recon.station.host.flight_archive import RecordedFlights

Made = Callable[..., RecordedFlights]
NAME = "recon-20250620T160000Z"
PRINTS = "import sys, pathlib; pathlib.Path(sys.argv[-1]).write_text(' '.join(sys.argv[1:]))"


def application(flights: RecordedFlights | None) -> Client:
    app = create_app(FakeStation(), None, "1.2.3", flights=flights)
    return Client(AccessCheck(app, Access()))


def python(script: str) -> tuple[str, ...]:
    return (sys.executable, "-c", script)


@pytest.fixture
def recorded() -> Iterator[Callable[..., RecordedFlights]]:
    """Makes archives, and closes them."""
    with ExitStack() as stack:

        def make(*words, **more) -> RecordedFlights:
            flights = RecordedFlights(*words, **more)
            stack.callback(flights.close)
            return flights

        yield make


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("records")
    write_record(flight(maps_every_s=40.0), folder / f"{NAME}.mcap")
    (folder / "notes.txt").write_text("secret")
    (folder / "linked.mcap").symlink_to(folder / "notes.txt")
    (folder / "folder.mcap").mkdir()
    return folder


def test_the_records_are_listed_and_downloaded_as_they_are(recorded: Made, folder: Path) -> None:
    client = application(recorded(folder))
    (listed,) = client.get("/api/flights").json()
    data = (folder / f"{NAME}.mcap").read_bytes()
    assert listed["name"] == NAME
    assert listed["size_bytes"] == len(data)
    assert listed["is_recording"] is False
    got = client.get(f"/api/flights/{NAME}/record.mcap")
    assert got.content == data
    assert f'filename="{NAME}.mcap"' in got.headers["content-disposition"]


def test_figures_are_made_by_the_command_in_its_own_process(
    recorded: Made, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # At its own priority it waits for everything else on this computer.
    monkeypatch.setattr(background_process, "NICENESS", 0)
    client = application(recorded(folder))
    figures = client.get(f"/api/flights/{NAME}").json()
    assert figures["record"] == f"{NAME}.mcap"
    assert figures["site"] == "made field"
    assert figures["region_m2"] == pytest.approx(180.0**2)


def test_a_page_runs_nothing_and_other_files_are_attachments(recorded: Made, folder: Path) -> None:
    client = application(recorded(folder, command=python(PRINTS)))
    page = client.get(f"/api/flights/{NAME}/files/report.html")
    assert page.text.startswith(f"report {folder / NAME}.mcap --out ")
    assert page.headers["content-security-policy"].startswith("sandbox; default-src 'none'")
    assert page.headers["content-disposition"].startswith("inline")
    tracks = client.get(f"/api/flights/{NAME}/files/tracks.gpx")
    assert tracks.text.startswith(f"export {folder / NAME}.mcap ")
    assert tracks.headers["content-disposition"].startswith("attachment")


@pytest.mark.parametrize(
    "name",
    [
        "notes.txt",
        "linked",
        "folder",
        "other",
        "..",
        "%2e%2e",
        "..%2f..%2fetc%2fpasswd",
        "%2fetc%2fpasswd",
        "a%00b",
        "-x",
        f"..%2frecords%2f{NAME}",
        "x" * 101,
    ],
)
@pytest.mark.parametrize("what", ["", "/record.mcap", "/files/tracks.csv"])
def test_no_name_leads_outside_the_records(
    recorded: Made, folder: Path, name: str, what: str
) -> None:
    client = application(recorded(folder, command=python("raise SystemExit(9)")))
    got = client.get(f"/api/flights/{name}{what}")
    assert got.status_code in (404, 422)
    assert "secret" not in got.text


def test_a_file_of_another_kind_is_refused(recorded: Made, folder: Path) -> None:
    client = application(recorded(folder, command=python("raise SystemExit(9)")))
    for file in ("a.html", "..%2fnotes.txt", "tracks.GPX"):
        assert client.get(f"/api/flights/{NAME}/files/{file}").status_code in (404, 422)


def test_this_runs_record_is_downloaded_after_the_run(recorded: Made, folder: Path) -> None:
    path = folder / f"{NAME}.mcap"
    client = application(recorded(folder, lambda: path))
    (listed,) = client.get("/api/flights").json()
    assert listed["is_recording"] is True
    assert client.get(f"/api/flights/{NAME}/record.mcap").status_code == 409


def test_what_a_command_refuses_is_a_sentence_without_folders(recorded: Made, folder: Path) -> None:
    path = folder / f"{NAME}.mcap"
    script = f"import sys; sys.exit('recon: {path}: expected shade maps')"
    got = application(recorded(folder, command=python(script))).get(
        f"/api/flights/{NAME}/files/sun.tif"
    )
    assert got.status_code == 422
    assert got.json()["error"] == f"{NAME}.mcap: expected shade maps"
    client = application(recorded(folder, command=python(PRINTS)))
    got = client.get(f"/api/flights/{NAME}")
    assert got.json()["error"] == f"{NAME}: its figures cannot be read"


def test_files_are_made_once_until_the_record_changes(recorded: Made, tmp_path: Path) -> None:
    record = tmp_path / "a.mcap"
    record.write_bytes(b"1")
    script = PRINTS.replace("' '.join(sys.argv[1:])", "sys.argv[-1]")
    client = application(recorded(tmp_path, command=python(script)))
    texts = [client.get("/api/flights/a/files/tracks.csv").text for _ in range(2)]
    assert texts[0] == texts[1]
    os.utime(record, ns=(1, 1))
    assert client.get("/api/flights/a/files/tracks.csv").text != texts[0]


def test_few_files_are_kept(
    recorded: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(flight_archive, "MOST_KEPT", 2)
    for name in "abc":
        (tmp_path / f"{name}.mcap").write_bytes(b"1")

    async def made() -> list[bool]:
        flights = recorded(tmp_path, command=python(PRINTS))
        paths = [await flights.file(name, "tracks.csv") for name in "abc"]
        return [path is not None and path.exists() for path in paths]

    assert asyncio.run(made()) == [False, True, True]


def test_one_file_at_a_time_and_few_wait(recorded: Made, tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_bytes(b"1")
    log = tmp_path / "log"
    script = f"{PRINTS}; open({str(log)!r}, 'a').write('began '); import time; time.sleep(0.05)"
    script += f"; open({str(log)!r}, 'a').write('ended ')"
    files = ("tracks.csv", "tracks.gpx", "tracks.geojson", "surveys.kml", "sun.tif")

    async def made() -> list[object]:
        flights = recorded(tmp_path, command=python(script))
        return await asyncio.gather(
            *(flights.file("a", file) for file in files), return_exceptions=True
        )

    found = asyncio.run(made())
    assert [isinstance(each, FlightBusyError) for each in found] == [False] * 4 + [True]
    assert log.read_text() == "began ended " * 4


def test_a_command_that_never_ends_is_ended(
    recorded: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(flight_archive, "WITHIN_S", 0.05)
    (tmp_path / "a.mcap").write_bytes(b"1")
    pid = tmp_path / "pid"
    script = f"import os, time; open({str(pid)!r}, 'w').write(str(os.getpid())); time.sleep(600)"

    async def made() -> None:
        await recorded(tmp_path, command=python(script)).file("a", "sun.tif")

    with pytest.raises(FlightFileError, match="took longer"):
        asyncio.run(made())
    if pid.exists() and (text := pid.read_text()):
        with pytest.raises(ProcessLookupError):
            os.kill(int(text), 0)


def test_a_station_without_records_has_none() -> None:
    client = application(None)
    assert client.get("/api/flights").json() == []
    assert client.get(f"/api/flights/{NAME}").status_code == 404
    assert json.loads(client.get(f"/api/flights/{NAME}/record.mcap").text)["error"]


def test_the_station_is_not_copied_to_make_a_file(recorded: Made, folder: Path) -> None:
    """A fork copies the page tables of all its memory, and an order waits meanwhile."""
    forks: list[str] = []
    os.register_at_fork(before=lambda: forks.append("fork"))
    flights = recorded(folder, command=python(PRINTS))
    path = uvloop.run(flights.file(NAME, "tracks.csv"))
    assert path is not None
    assert path.is_file()
    assert forks == []
