"""The oldest records of demonstrations make room; all else in their folder stays."""

import json
from pathlib import Path

import pytest

from recon.record.files.file_lock import lock_file
from recon.record.mcap.mcap_file import ABOUT_NAME, McapFile
from recon.record.mcap.record_ceiling import remove_oldest_demos
from recon.record.mcap.record_file import RecordFile


def record(path: Path, size_bytes: int = 3_000, *, is_demo: bool = True) -> Path:
    """A record with what a flight's begins with."""
    file = McapFile(path, "test")
    file.add_attachment("recon/start", "text/plain", bytes(size_bytes), 5)
    about = json.dumps({"is_demo": True} if is_demo else {"site": "west field"})
    file.add_attachment(ABOUT_NAME, "application/json", about.encode(), 5)
    file.finish()
    return path


def names(folder: Path) -> list[str]:
    return sorted(each.name for each in folder.iterdir())


@pytest.fixture
def demos(tmp_path: Path) -> list[Path]:
    kinds = ("flight", "ground", "flight", "flight")
    return [
        record(tmp_path / f"{kind}-2026112{day}T100000Z.mcap") for day, kind in enumerate(kinds)
    ]


def test_the_oldest_are_removed_first(tmp_path: Path, demos: list[Path]) -> None:
    remove_oldest_demos(tmp_path, 2 * demos[0].stat().st_size)
    assert names(tmp_path) == [each.name for each in demos[2:]]
    remove_oldest_demos(tmp_path, 0)
    assert names(tmp_path) == []


def test_nothing_is_removed_below_the_ceiling(tmp_path: Path, demos: list[Path]) -> None:
    remove_oldest_demos(tmp_path, 4 * demos[0].stat().st_size)
    assert len(names(tmp_path)) == 4
    remove_oldest_demos(tmp_path / "none", 0)


def test_what_is_written_or_replayed_stays(tmp_path: Path, demos: list[Path]) -> None:
    replayed = RecordFile(demos[1])
    with demos[0].open("rb") as written:
        lock_file(written.fileno())
        remove_oldest_demos(tmp_path, 0)
    replayed.close()
    assert names(tmp_path) == sorted(each.name for each in demos[:2])
    remove_oldest_demos(tmp_path, 0)
    assert names(tmp_path) == []


def test_nothing_but_demos_is_removed(tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    folder = tmp_path / "demos"
    folder.mkdir()
    record(folder / "flight-20261120T100000Z.mcap", is_demo=False)
    record(folder / "own.mcap")
    (folder / "flight-20261121T100000Z.mcap").write_bytes(b"no record")
    (folder / "flight-20261122T100000Z.mcap").symlink_to(record(elsewhere / "demo.mcap"))
    (folder / "flight-20261123T100000Z.mcap").mkdir()
    record(folder / "flight-20261124T100000Z.mcap")
    remove_oldest_demos(folder, 0)
    assert "flight-20261124T100000Z.mcap" not in names(folder)
    assert len(names(folder)) == 5
    assert names(elsewhere) == ["demo.mcap"]
