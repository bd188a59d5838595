"""Writing the audit: in order, without blocking a caller; disks fail."""

import errno
import json
import os
import stat
import threading
from pathlib import Path

import pytest
from tests.record.audits import PATIENCE_S, entry, until, written

from recon.model.errors import RecordError
from recon.record.audit import audit_log
from recon.record.audit.audit_check import check_audit
from recon.record.audit.audit_log import (
    KEPT_ENTRIES,
    WAITING_ENTRIES,
    AuditLog,
    refuse_other_writer,
)


class Disk:
    """Stands in for os.write: full on demand, and writes in pieces."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.is_full = False
        self.piece_bytes = 1 << 30
        self.gate = threading.Event()
        self.gate.set()
        self.is_reached = threading.Event()
        self._write = os.write
        monkeypatch.setattr(audit_log.os, "write", self.write)
        monkeypatch.setattr(audit_log, "RETRY_AFTER_S", 0.3)

    def write(self, file: int, data: bytes) -> int:
        self.is_reached.set()
        self.gate.wait(PATIENCE_S)
        if self.is_full:
            raise OSError(errno.ENOSPC, "No space left on device")
        return self._write(file, data[: self.piece_bytes])


@pytest.fixture
def disk(monkeypatch: pytest.MonkeyPatch) -> Disk:
    return Disk(monkeypatch)


def content(log: AuditLog) -> bytes:
    return b"" if log.path is None else log.path.read_bytes()


def read(path: Path | None) -> list[dict[str, object]]:
    assert path is not None
    return [json.loads(line) for line in path.read_bytes().splitlines()]


def test_lines_are_written_in_order_with_their_moment(tmp_path: Path) -> None:
    path = written(tmp_path, 50)
    lines = read(path)
    assert [line["n"] for line in lines] == list(range(51))
    assert lines[0]["kind"] == "audit.opened"
    assert lines[7]["text"] == "entry 6"
    assert lines[7]["t_ns"] == 6
    assert str(lines[7]["utc"]).endswith("Z")


def test_the_file_is_for_its_owner_alone(tmp_path: Path) -> None:
    path = written(tmp_path / "new" / "folder", 1)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_a_line_is_in_the_file_before_the_run_ends(tmp_path: Path) -> None:
    """What kill -9 leaves: everything that was put a moment ago."""
    log = AuditLog(tmp_path)
    log.start()
    log.put(entry("the last order"), 1)
    until(lambda: b"the last order" in content(log))
    log.close()


def test_a_file_is_never_opened_again(tmp_path: Path) -> None:
    first = written(tmp_path, 2)
    data = first.read_bytes()
    assert written(tmp_path, 2) != first
    assert first.read_bytes() == data


def test_a_line_written_in_pieces_is_one_line(tmp_path: Path, disk: Disk) -> None:
    disk.piece_bytes = 7
    assert check_audit(written(tmp_path, 3)).is_whole


def test_a_full_disk_is_reported_and_nothing_is_lost_when_it_has_room_again(
    tmp_path: Path, disk: Disk
) -> None:
    log = AuditLog(tmp_path)
    disk.is_full = True
    log.start()
    log.put(entry("one"), 1)
    until(lambda: log.problem is not None)
    log.put(entry("two"), 2)
    assert log.problem is not None
    assert "No space left on device" in log.problem
    disk.is_full = False
    until(lambda: log.problem is None)
    log.put(entry("three"), 3)
    log.close()
    assert [line["text"] for line in read(log.path)][1:] == ["one", "two", "three"]
    assert check_audit(log.path or tmp_path).is_whole


def test_a_disk_that_hangs_blocks_no_caller(tmp_path: Path, disk: Disk) -> None:
    """More than the queue holds is put while a write stands still; the file states what is lost."""
    log = AuditLog(tmp_path)
    disk.gate.clear()
    log.start()
    log.put(entry("the first"), 0)
    assert disk.is_reached.wait(PATIENCE_S)
    for number in range(WAITING_ENTRIES + 500):
        log.put(entry(f"entry {number}"), number)
    assert log.waiting == WAITING_ENTRIES
    disk.gate.set()
    log.close()
    assert log.path is not None
    verdict = check_audit(log.path)
    assert verdict.is_whole
    assert verdict.lost == 500
    lines = read(log.path)
    assert lines[1]["text"] == "the first"
    assert lines[-1]["text"] == f"entry {WAITING_ENTRIES + 499}"
    (lost,) = [line for line in lines if line["kind"] == "audit.lost"]
    assert lost["details"] == {"count": verdict.lost}


def test_a_folder_that_cannot_be_made_is_trouble_until_it_can(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(audit_log, "RETRY_AFTER_S", 0.3)
    folder = tmp_path / "audit"
    folder.write_text("a file where the folder should be")
    log = AuditLog(folder)
    log.start()
    log.put(entry("waits"), 1)
    until(lambda: log.problem is not None)
    folder.unlink()
    until(lambda: log.problem is None)
    log.close()
    assert [line["text"] for line in read(log.path)][1:] == ["waits"]


def test_a_deleted_file_is_reported_and_another_begun(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(audit_log, "RETRY_AFTER_S", 0.3)
    log = AuditLog(tmp_path)
    log.start()
    log.put(entry("before"), 1)
    until(lambda: b"before" in content(log))
    first = log.path
    assert first is not None
    first.unlink()
    log.put(entry("after"), 2)
    until(lambda: log.problem is not None)
    assert "deleted" in str(log.problem)
    until(lambda: log.problem is None)
    log.close()
    assert [line["text"] for line in read(log.path)][1:] == ["after"]
    assert check_audit(log.path or tmp_path).missing_before == first.name


def test_two_stations_do_not_write_into_one_folder(tmp_path: Path) -> None:
    log = AuditLog(tmp_path)
    log.start()
    log.put(entry(), 1)
    until(lambda: log.path is not None)
    with pytest.raises(RecordError, match="--audit"):
        refuse_other_writer(tmp_path)
    log.close()
    refuse_other_writer(tmp_path)


class TestInMemory:
    def test_pages_follow_each_other(self, tmp_path: Path) -> None:
        log = AuditLog(tmp_path)
        for number in range(25):
            log.put(entry(), number)
        assert [s.n for s in log.after(0, 10)] == list(range(1, 11))
        assert [s.n for s in log.after(20, 10)] == [21, 22, 23, 24, 25]
        assert log.after(25, 10) == []
        assert log.last_n == 25

    def test_the_oldest_are_forgotten(self, tmp_path: Path) -> None:
        log = AuditLog(tmp_path)
        for number in range(KEPT_ENTRIES + 5):
            log.put(entry(), number)
        assert log.after(0, 1)[0].n == 6
