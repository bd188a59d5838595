"""The photos of a flight by the API: steps, refusals, and what a failed step leaves."""

import asyncio
import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from threading import Event

import pytest
from tests.api.client import Client
from tests.api.fake_station import FakeStation
from tests.product.made_flight import ONE, flight, write_card, write_record

from recon.api.photo_routes import PhotoBusyError, PhotoRequestError
from recon.api.schema import PhotoJobView, PhotoRequest
from recon.api.security import Access, AccessCheck
from recon.station.api_views.app import create_app
from recon.station.host import background_process, photo_job
from recon.station.host.flight_archive import RecordedFlights
from recon.station.host.photo_job import PhotoJob

NAME = "flight-20250620T160000Z"
TELLS = "tell = lambda **facts: print('\\x1e' + json.dumps(facts), flush=True)"
Made = Callable[..., PhotoJob]


def python(script: str) -> tuple[str, ...]:
    """A command in place of `recon`: `words` are its words, `tell` tells facts."""
    begin = f"import json, pathlib, sys; words = sys.argv[1:]; {TELLS}\n"
    return (sys.executable, "-c", begin + script)


CLOCK = {
    "camera": "CAM-1",
    "vehicle": "Drone 1",
    "photos": 9,
    "offset_s": -3600.0,
    "sigma_s": 0.2,
    "distance_m": 1.5,
    "is_stated": False,
    "is_reported": False,
}
WORKS = f"""
if words[0] == "tag":
    tell(doing="tagging", share=0.5)
    tell(clocks=[{CLOCK}])
    tell(counts=dict(photos=9, sunlit=4, mixed=2, shaded=3, unknown=0))
    tell(gaps=dict(area_m2=700.0, regions=2))
    out = pathlib.Path(words[words.index("--out") + 1])
    out.mkdir(exist_ok=True)
    (out / "tags.csv").write_text(" ".join(words))
"""


@pytest.fixture
def photos(tmp_path: Path) -> Iterator[Made]:
    """Makes the job on photos of a folder with one record, and closes it."""
    (tmp_path / "records").mkdir()
    (tmp_path / "records" / f"{NAME}.mcap").write_bytes(b"1")
    (tmp_path / "card").mkdir()
    with ExitStack() as stack:

        def make(*words, **more) -> PhotoJob:
            flights = RecordedFlights(tmp_path / "records")
            job = PhotoJob(tmp_path / "records", flights.record, *words, **more)
            stack.callback(flights.close)
            stack.callback(job.close)
            return job

        yield make


def application(job: PhotoJob | None) -> Client:
    return Client(AccessCheck(create_app(FakeStation(), None, "1.2.3", photos=job), Access()))


def finished(job: PhotoJob, folder: Path, **more: object) -> PhotoJobView:
    """Run a job on a folder to its end."""
    asyncio.run(job.start(PhotoRequest(flight=NAME, folders=[str(folder)], **more)))
    return ended(job)


def ended(job: PhotoJob) -> PhotoJobView:
    assert job._thread is not None
    job._thread.join(120.0)
    view = job.view().job
    assert view is not None
    return view


def states(view: PhotoJobView) -> str:
    return " ".join(step.state for step in view.steps)


def problems(view: PhotoJobView) -> list[str]:
    return [step.problem for step in view.steps if step.problem]


def test_photos_of_a_made_flight_are_tagged_by_the_commands(
    photos: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(background_process, "NICENESS", 0)
    (tmp_path / "records" / f"{NAME}.mcap").unlink()
    write_record(flight(ONE, maps_every_s=20.0), tmp_path / "records" / f"{NAME}.mcap")
    names = write_card(tmp_path / "card", 7261.4, every=8)
    job = photos()
    view = finished(job, tmp_path / "card")
    assert (view.state, problems(view)) == ("done", [])
    assert states(view) == "done done done done done"
    (clock,) = view.clocks
    assert clock.offset_s == pytest.approx(-7261.4, abs=1.0)
    assert view.counts is not None
    assert view.counts.photos == clock.photos == len(names)
    assert view.gaps is not None
    assert view.gaps.area_m2 > 0.0
    assert view.mosaic is not None
    assert view.mosaic.sun_m2 > 0.0
    assert sorted(each.name for each in (tmp_path / "card").iterdir()) == sorted(names)
    assert not (tmp_path / "records" / f"{NAME}-photos" / "tagged" / "odm").exists()
    client = application(photos())
    assert client.get("/api/photos").json()["job"] == view.model_dump()
    picture = client.get("/api/photos/files/mosaic.png")
    assert picture.content.startswith(b"\x89PNG")
    page = client.get("/api/photos/files/report.html")
    assert page.headers["content-security-policy"].startswith("sandbox")
    assert json.loads(client.get("/api/photos/files/fly-again.geojson").content)["features"]


def test_a_failed_mosaic_leaves_the_tags_and_a_report_without_it(
    photos: Made, tmp_path: Path
) -> None:
    fails = "if '/site' in words: sys.exit('recon: x.JPG: cannot be decoded')"
    log = "print('warning: turned by 90 degrees', file=sys.stderr)"
    job = photos(command=python(f"{WORKS}\n{fails}\n{log}"), site=lambda: Path("/site"))
    view = finished(job, tmp_path / "card", clock_offset_s=-5.0)
    assert states(view) == "done done done failed done"
    assert (view.state, problems(view)) == ("failed", ["x.JPG: cannot be decoded"])
    assert view.warnings == ["turned by 90 degrees"]
    assert view.clocks[0].offset_s == -3600.0
    assert set(view.files) == {"tags.csv", "fly-again.geojson", "report.html"}
    words = application(job).get("/api/photos/files/tags.csv").text
    assert f"tag {tmp_path / 'card'} --flight" in words
    assert words.endswith("--no-odm --clock-offset=-5.0")
    assert application(job).get("/api/photos/files/mosaic.png").status_code == 404


@pytest.mark.parametrize(
    ("script", "sentence"),
    [
        ("sys.exit('recon: two clock offsets fit equally well')", "two clock offsets"),
        ("raise MemoryError", "not enough memory: close other programs"),
        ("import os; os.kill(os.getpid(), 9)", "not enough memory: close other programs"),
        ("import os; os.kill(os.getpid(), 11)", "ended without a reason (code -11)"),
        (
            "tell(state='done'); print('\\x1e{'); print('\\x1e[1]'); tell(gaps=3); sys.exit('x')",
            "x",
        ),
    ],
)
def test_whatever_ends_the_first_step_is_a_sentence(
    photos: Made, tmp_path: Path, script: str, sentence: str
) -> None:
    view = finished(photos(command=python(script)), tmp_path / "card")
    assert states(view) == "failed waiting waiting waiting waiting"
    assert sentence in problems(view)[0]
    assert view.files == []


def test_one_job_at_a_time_which_can_be_cancelled(
    photos: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(background_process, "TICK_S", 0.02)
    job = photos(command=python(f"{WORKS}\nimport time; time.sleep(600)"))
    asked = PhotoRequest(flight=NAME, folders=[str(tmp_path / "card")])
    asyncio.run(job.start(asked))
    with pytest.raises(PhotoBusyError, match="wait for it, or cancel it"):
        asyncio.run(job.start(asked))
    give_up_at_s = time.monotonic() + 60.0
    while (view := job.view().job) is None or "done done running" not in states(view):
        assert time.monotonic() < give_up_at_s, view
        time.sleep(0.01)
    assert application(job).ask("DELETE", "/api/photos").status_code == 200
    view = ended(job)
    assert view.state == "cancelled"
    assert states(view) == "done done failed waiting waiting"
    assert problems(view) == ["Cancelled: start again, and it continues from there"]


def test_a_disk_that_the_records_need_ends_the_job(
    photos: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(photo_job, "LEAST_FREE_BYTES", 10**18)
    monkeypatch.setattr(background_process, "TICK_S", 0.02)
    view = finished(photos(command=python("import time; time.sleep(600)")), tmp_path / "card")
    (problem,) = problems(view)
    assert "is free on the disk of" in problem
    assert "free some, then start again" in problem


def test_only_folders_that_can_be_read_are_taken(photos: Made, tmp_path: Path) -> None:
    client = application(photos(command=python("")))
    file = tmp_path / "card" / "a.JPG"
    file.touch()
    for folder, words in (
        ("DCIM", "whole path"),
        (str(tmp_path / "none"), "No folder"),
        (str(file), "is a file: give the folder that holds it"),
        (str(tmp_path), "holds the station's flight records"),
        ("/", "holds the station's flight records"),
        ("/\x00", "No folder"),
    ):
        got = client.post("/api/photos", json={"flight": NAME, "folders": [folder]})
        assert (got.status_code, words in got.json()["error"]) == (422, True), got.json()
    got = client.post("/api/photos", json={"flight": "other", "folders": [str(tmp_path)]})
    assert "No flight record 'other'" in got.json()["error"]
    assert client.get("/api/photos").json() == {"job": None}


def test_a_folder_that_does_not_answer_is_refused(
    photos: Made, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hangs = Event()
    monkeypatch.setattr(photo_job, "ANSWERS_WITHIN_S", 0.01)
    monkeypatch.setattr(photo_job, "photo_folder", lambda *_words: str(hangs.wait(60.0)))
    job = photos(command=python(""))
    asked = PhotoRequest(flight=NAME, folders=[str(tmp_path / "card")])
    with pytest.raises(PhotoRequestError, match="does not answer: pull the card out"):
        asyncio.run(job.start(asked))
    with pytest.raises(PhotoBusyError):
        asyncio.run(job.start(asked))
    hangs.set()
    assert job._thread is not None
    job._thread.join(60.0)
    assert job.view().job is None


def test_a_station_without_records_has_no_photos() -> None:
    client = application(None)
    assert (
        client.get("/api/photos").json()
        == client.ask("DELETE", "/api/photos").json()
        == {"job": None}
    )
    got = client.post("/api/photos", json={"flight": NAME, "folders": ["/"]})
    assert "records no flights" in got.json()["error"]
    assert client.get("/api/photos/files/tags.csv").status_code == 404
