"""Capture files: complete, bounded, readable while the station runs."""

import time
from pathlib import Path

import pytest

from recon.link import capture as capture_module
from recon.link.capture import MAGIC, RECORD_HEADER, Capture, Direction

MIB = 1024 * 1024


def records(path: Path) -> list[tuple[int, int, bytes]]:
    """Read a file by its description, not by the writer."""
    data = path.read_bytes()
    assert data.startswith(b"RECONCAP1\n")
    place, found = len(b"RECONCAP1\n"), []
    while place < len(data):
        at_ns = int.from_bytes(data[place : place + 8], "big")
        length = int.from_bytes(data[place + 9 : place + 13], "big")
        found.append((at_ns, data[place + 8], data[place + 13 : place + 13 + length]))
        place += 13 + length
    return found


def test_what_was_recorded_is_in_the_files(tmp_path: Path) -> None:
    capture = Capture(tmp_path / "new" / "folder", "run", MIB)
    capture.start()
    capture.record(1, Direction.FROM_APP, b"abc", 10)
    capture.record(2, Direction.FROM_APP, b"", 11)
    capture.record(1, Direction.TO_APP, b"defg", 12)
    capture.close()
    first, second = sorted((tmp_path / "new" / "folder").iterdir())
    assert records(first) == [(10, 0, b"abc"), (12, 1, b"defg")]
    assert records(second) == [(11, 0, b"")]
    assert capture.dropped_bytes == 0


def test_the_limit_counts_what_lies_on_the_disk(tmp_path: Path) -> None:
    limit_bytes = 10_000
    capture = Capture(tmp_path, "run", limit_bytes)
    capture.start()
    for number in range(2000):
        capture.record(number % 5, Direction.FROM_APP, b"x", number)
    capture.close()
    on_disk = sum(path.stat().st_size for path in tmp_path.iterdir())
    assert limit_bytes - len(MAGIC) - RECORD_HEADER.size - 1 < on_disk <= limit_bytes
    assert capture.dropped_bytes > 0


def test_files_of_gone_links_are_closed(tmp_path: Path) -> None:
    open_before = len(list(Path("/proc/self/fd").iterdir()))
    capture = Capture(tmp_path, "run", MIB)
    capture.start()
    for link_id in range(200):
        capture.record(link_id, Direction.FROM_APP, b"x", 0)
        capture.end_link(link_id)
    give_up_at_s = time.monotonic() + 120.0
    while len(list(Path("/proc/self/fd").iterdir())) > open_before + 3:
        assert time.monotonic() < give_up_at_s, "files of gone links stay open"
    capture.close()
    assert len(list(tmp_path.iterdir())) == 200


def test_the_number_of_files_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(capture_module, "MOST_FILES", 3)
    capture = Capture(tmp_path, "run", MIB)
    capture.start()
    for link_id in range(10):
        capture.record(link_id, Direction.FROM_APP, b"x", 0)
    capture.close()
    assert len(list(tmp_path.iterdir())) == 3
    assert capture.dropped_bytes == 7


def test_bytes_after_the_end_go_on_in_the_same_file(tmp_path: Path) -> None:
    capture = Capture(tmp_path, "run", MIB)
    capture.start()
    capture.record(1, Direction.FROM_APP, b"a", 1)
    capture.end_link(1)
    capture.record(1, Direction.TO_APP, b"b", 2)
    capture.close()
    assert records(next(tmp_path.iterdir())) == [(1, 0, b"a"), (2, 1, b"b")]


def test_a_folder_that_is_a_file_is_refused_at_the_start(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(OSError, match="exists"):
        Capture(tmp_path / "file", "run", MIB).start()


def test_a_disk_that_fails_drops_and_counts(tmp_path: Path) -> None:
    folder = tmp_path / "gone"
    capture = Capture(folder, "run", MIB)
    capture.start()
    folder.rmdir()
    capture.record(1, Direction.FROM_APP, b"abc", 1)
    capture.close()
    assert capture.dropped_bytes > 0
