"""Pairings reach the list's file: atomically, again after a full disk, never over a hand's edit."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.record.audits import until

from recon.fleet.admission import AllowedApp
from recon.model.event import AppListFailed, Event, Tick
from recon.site import default_site
from recon.site.app_list import app_list_text, read_app_list
from recon.station.host import rewritten_file
from recon.station.host.app_list_writer import AppListWriter
from recon.station.kernel.build import first_state
from recon.station.state.station import Station
from recon.station.state.steps import StepTaken

A, B = AllowedApp("A"), AllowedApp("B")


def station(*entries: AllowedApp) -> Station:
    return first_state(default_site(), apps=entries)


def taken(before: Station, after: Station) -> StepTaken:
    return StepTaken(Tick(), 0, before, after, ())


@pytest.fixture
def path(tmp_path: Path) -> Path:
    made = tmp_path / "apps.toml"
    made.write_text(app_list_text((A,)))
    return made


def test_a_pairing_is_written_and_nothing_else_is(path: Path) -> None:
    events: list[Event] = []
    writer = AppListWriter(path, events.append)
    writer.start()
    before = station(A)
    writer.observe(taken(before, replace(before, next_frame_id=2)))
    writer.observe(taken(before, station(A, B)))
    writer.close()
    assert read_app_list(path) == (A, B)
    assert [p.name for p in path.parent.iterdir()] == ["apps.toml"]
    assert events == []


def test_a_file_changed_by_hand_is_left_alone(path: Path) -> None:
    events: list[Event] = []
    writer = AppListWriter(path, events.append)
    path.write_text('[[apps]]\nserial = "C"\n')
    writer.start()
    writer.observe(taken(station(A), station(A, B)))
    writer.close()
    assert read_app_list(path) == (AllowedApp("C"),)
    (event,) = events
    assert isinstance(event, AppListFailed)
    assert "changed by hand" in (event.problem or "")


def test_what_cannot_be_written_is_tried_again(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    events: list[Event] = []
    monkeypatch.setattr(rewritten_file, "RETRY_S", 0.01)
    folder, away = path.parent, path.parent.with_name("away")
    writer = AppListWriter(path, events.append)
    folder.rename(away)
    path_is_gone = AppListWriter(path, events.append)  # knows no file, and has no folder
    path_is_gone.start()
    path_is_gone.observe(taken(station(), station(B)))
    until(lambda: bool(events))
    folder.mkdir()
    until(lambda: events[-1] == AppListFailed(None))
    path_is_gone.close()
    writer.close()
    assert read_app_list(path) == (B,)
    first = events[0]
    assert isinstance(first, AppListFailed)
    assert "cannot be written" in (first.problem or "")
