"""The record's writer: killed at any moment, a full disk, a slow disk; never in anyone's way."""

import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from recon.record.mcap import record_writer, topics
from recon.record.mcap.mcap_read import McapReading, RecordMessage
from recon.record.mcap.mcap_repair import is_finished
from recon.record.mcap.record_writer import (
    FLUSH_EVERY_S,
    GROUND_FILES_KEPT,
    RecordWriter,
    Status,
    repair_all,
)
from recon.record.mcap.topics import Topics

PATIENCE_S = 120.0


BEGIN, FLOWN = "begin", "flown"


class Plain:
    """Items are (topic, bytes), written as they are; images are excluded when asked to."""

    def begin(self, item: Any, topics: Topics) -> None:
        topics.file.add_attachment("start", "text/plain", b"begun", 0)

    def write(self, item: Any, topics: Topics, *, with_images: bool) -> None:
        topic, data = item
        if topic != "/image" or with_images:
            topics.add(topic, "raw", data, 1)

    def flush(self, topics: Topics, *, with_images: bool) -> None:
        pass

    def finish(self, topics: Topics, *, with_images: bool) -> None:
        pass


class Writing:
    """A writer on a thread, with a file begun."""

    def __init__(self, folder: Path, **more: Any) -> None:
        self.inbox: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.writer = RecordWriter(
            folder,
            Plain(),
            self.inbox,
            "test",
            begins=lambda item: item == BEGIN,
            has_flown=lambda item: item == FLOWN,
            **more,
        )
        self.thread = threading.Thread(target=self.writer.run, daemon=True)
        self.thread.start()
        self.put(BEGIN)

    def put(self, item: Any) -> None:
        self.inbox.put(item)

    def is_file(self) -> bool:
        return self.writer.path is not None

    @property
    def path(self) -> Path:
        assert self.writer.path is not None
        return self.writer.path

    @property
    def problem(self) -> str | None:
        return self.writer.problem

    def close(self) -> None:
        self.writer.is_ending = True
        self.put(None)
        self.thread.join(PATIENCE_S)
        assert not self.thread.is_alive()


def until(is_so: Callable[[], bool]) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not is_so():
        assert time.monotonic() < end_s, "it never came"
        time.sleep(0.005)


def messages(path: Path) -> list[RecordMessage]:
    if path.stat().st_size == 0:
        return []
    with path.open("rb") as file:
        return [i for i in McapReading(file).items() if isinstance(i, RecordMessage)]


def test_what_was_put_is_in_the_file_without_an_end(tmp_path: Path) -> None:
    """It writes without a call, more than twice a second; it does not wait for more, nor for the
    end.
    """
    assert FLUSH_EVERY_S <= 0.5
    writing = Writing(tmp_path / "new" / "folder")
    writing.put(("/step", b"one"))
    until(lambda: writing.is_file() and len(messages(writing.path)) == 1)
    writing.put(("/step", b"two"))
    path = writing.path
    until(lambda: len(messages(path)) == 2)
    assert not is_finished(path)
    writing.close()
    assert is_finished(path)
    assert path.stat().st_mode & 0o777 == 0o600
    with path.open("rb") as file:
        found = [message.data for *_, message in make_reader(file).iter_messages()]
    assert found == [b"one", b"two"]


KILLED = """
import sys
from pathlib import Path
from tests.record.mcap.test_record_writer import BEGIN, Plain
from recon.record.mcap.record_writer import RecordWriter

class Endless:
    number = -1
    def get(self, *, timeout):
        self.number += 1
        return ("/step", (self.number - 1).to_bytes(8, "big") * 30_000) if self.number else BEGIN

begins = lambda item: item == BEGIN
RecordWriter(Path(sys.argv[1]), Plain(), Endless(), "test", begins=begins).run()
"""


@pytest.mark.parametrize("kill_at_bytes", [1, 20_000, 150_000])
def test_a_killed_writer_leaves_all_but_the_last_chunk(tmp_path: Path, kill_at_bytes: int) -> None:
    process = subprocess.Popen([sys.executable, "-c", KILLED, str(tmp_path)])
    try:
        until(lambda: any(p.stat().st_size >= kill_at_bytes for p in tmp_path.glob("*.mcap")))
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    (path,) = tmp_path.iterdir()
    before = messages(path)
    assert repair_all(tmp_path) == [path]
    assert is_finished(path)
    after = messages(path)
    assert [m.data for m in after] == [m.data for m in before]
    assert [m.data[:8] for m in after] == [n.to_bytes(8, "big") for n in range(len(after))]


def test_a_file_is_reported_before_anything_is_in_it_and_its_new_name_at_once(
    tmp_path: Path,
) -> None:
    """Else a record that grows is shown as one of an earlier run."""
    items = iter([BEGIN, ("/step", b"1"), FLOWN, ("/step", b"2"), None])
    happened: list[str] = []

    class Inbox:
        def get(self, timeout: float) -> Any:
            item = next(items)
            happened.append("taken")
            return item

    def report(status: Status) -> None:
        happened.append(Path(status.path or "none").name.partition("-")[0])

    is_begin, is_flown = (lambda item: item == BEGIN), (lambda item: item == FLOWN)
    writer = RecordWriter(tmp_path, Plain(), Inbox(), "test", is_begin, is_flown, report)
    writer.run()
    wanted = ["taken", "ground", "taken", "taken", "flight", "taken", "taken"]
    assert happened[: len(wanted)] == wanted


def test_the_next_start_repairs_and_leaves_what_is_being_written(tmp_path: Path) -> None:
    first = Writing(tmp_path)
    first.put(("/step", b"one"))
    until(lambda: first.is_file() and first.path.stat().st_size > 0)
    (tmp_path / "cut.mcap").write_bytes(b"\x89MCAP0\r\n" + bytes(3))
    (tmp_path / "other.mcap").write_bytes(b"something else")
    second = Writing(tmp_path)
    until(second.is_file)
    assert second.writer.repaired == (tmp_path / "cut.mcap",)
    assert is_finished(tmp_path / "cut.mcap")
    assert (tmp_path / "other.mcap").read_bytes() == b"something else"
    assert not is_finished(first.path)
    first.close()
    second.close()
    assert first.path != second.path
    assert second.problem is None


def test_a_file_is_a_flights_once_a_vehicle_has_flown(tmp_path: Path) -> None:
    """Of the time on the ground the last files stay, a flight is never removed."""
    writing = Writing(tmp_path)
    for is_flight in (True, False, False, False, True, False):
        writing.put(("/step", b"%d" % is_flight))
        if is_flight:
            writing.put(FLOWN)
        writing.put(BEGIN)
    writing.close()
    files = sorted(tmp_path.iterdir())
    flights = [path for path in files if path.name.startswith("flight-")]
    assert len(flights) == 2
    assert all(messages(path)[0].data == b"1" for path in flights)
    assert len(files) == 2 + GROUND_FILES_KEPT + 1
    assert all(is_finished(path) for path in files)


def test_a_flight_that_cannot_be_renamed_is_a_problem_and_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def rename(*_paths: Any) -> None:
        raise PermissionError(1, "Operation not permitted")

    writing = Writing(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(os, "rename", rename)
        patch.setattr(os, "link", rename)
        writing.put(("/step", b"flown"))
        writing.put(FLOWN)
        until(lambda: writing.problem is not None)
    assert writing.problem is not None
    assert "cannot be renamed to flight-" in writing.problem
    assert writing.problem.endswith("Operation not permitted")
    for _ in range(GROUND_FILES_KEPT + 2):
        writing.put(BEGIN)
    writing.close()
    assert writing.problem is None
    files = sorted(tmp_path.iterdir())
    assert [m.data for path in files for m in messages(path)] == [b"flown"]
    assert len(files) == 1 + GROUND_FILES_KEPT + 1


def test_images_stop_first_and_come_back(tmp_path: Path) -> None:
    free_bytes = [record_writer.IMAGES_STOP_BYTES]
    writing = Writing(tmp_path, free_bytes=lambda _folder: free_bytes[0])
    writing.put(("/image", b"first"))
    until(lambda: writing.is_file() and len(messages(writing.path)) == 1)
    assert writing.problem is None
    free_bytes[0] = record_writer.IMAGES_STOP_BYTES - 1
    until(lambda: writing.problem is not None)
    assert writing.problem is not None
    assert "less than 2 GiB are free" in writing.problem
    assert "without images" in writing.problem
    writing.put(("/image", b"second"))
    writing.put(("/step", b"order"))
    free_bytes[0] = record_writer.IMAGES_AGAIN_BYTES
    until(lambda: writing.problem is None)
    writing.put(("/image", b"third"))
    writing.close()
    assert b"order" in [m.data for m in messages(writing.path)]
    assert [m.data for m in messages(writing.path) if m.topic == "/image"][-1] == b"third"


def test_a_full_disk_is_a_problem_and_nothing_is_lost_when_it_is_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(record_writer, "RETRY_AFTER_S", 0.01)
    real = os.pwrite
    is_full = [False]

    def write(descriptor: int, data: bytes, at: int) -> int:
        if is_full[0]:
            raise OSError(28, "No space left on device")
        return real(descriptor, data, at)

    monkeypatch.setattr(os, "pwrite", write)
    writing = Writing(tmp_path)
    until(writing.is_file)
    is_full[0] = True
    for number in range(20):
        writing.put(("/step", bytes([number])))
    until(lambda: writing.problem is not None)
    assert writing.problem == f"the record cannot be written to {tmp_path}: No space left on device"
    is_full[0] = False
    until(lambda: writing.problem is None)
    writing.close()
    assert [m.data for m in messages(writing.path)] == [bytes([n]) for n in range(20)]


def test_a_folder_that_cannot_be_written_is_a_problem(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    writing = Writing(tmp_path / "file")
    until(lambda: writing.problem is not None)
    writing.close()
    assert writing.problem is not None
    assert writing.problem.startswith("the record cannot be written to")


def test_an_item_that_cannot_be_written_is_a_problem_and_no_end(tmp_path: Path) -> None:
    writing = Writing(tmp_path)
    writing.put("neither topic nor bytes")
    writing.put(("/step", b"one"))
    until(lambda: writing.is_file() and len(messages(writing.path)) == 1)
    assert writing.problem is not None
    assert "a part of the record is missing" in writing.problem
    writing.put(BEGIN)
    until(lambda: writing.problem is None)
    writing.close()


def test_topics_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(topics, "MOST_TOPICS", 3)
    writing = Writing(tmp_path)
    for number in range(10):
        writing.put((f"/{number}", b"x"))
    writing.close()
    assert {m.topic for m in messages(writing.path)} == {"/0", "/1", "/2", "/other/raw"}
