"""The record's writer: killed at any moment, a full disk, a slow disk; never in anyone's way."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from recon.record import record_writer
from recon.record.mcap_read import McapReading, RecordMessage
from recon.record.mcap_repair import is_finished
from recon.record.record_writer import FLUSH_EVERY_S, RecordWriter, Topics, repair_all

PATIENCE_S = 120.0


class Plain:
    """Items are (topic, bytes), written as they are; images are left out when asked to."""

    def begin(self, topics: Topics) -> None:
        topics.file.add_attachment("start", "text/plain", b"begun", 0)

    def write(self, item: Any, topics: Topics, *, with_images: bool) -> None:
        topic, data = item
        if topic != "/image" or with_images:
            topics.add(topic, "raw", data, 1)


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
    """The thread writes by itself, twice a second; it does not wait for more, nor for the end."""
    assert FLUSH_EVERY_S <= 0.5
    writer = RecordWriter(tmp_path / "new" / "folder", Plain(), "test")
    writer.start()
    writer.put(("/step", b"one"), 3)
    until(lambda: writer.path is not None and len(messages(writer.path)) == 1)
    writer.put(("/step", b"two"), 3)
    assert writer.path is not None
    path = writer.path
    until(lambda: len(messages(path)) == 2)
    assert not is_finished(path)
    writer.close()
    assert is_finished(path)
    assert path.stat().st_mode & 0o777 == 0o600
    with path.open("rb") as file:
        found = [message.data for *_, message in make_reader(file).iter_messages()]
    assert found == [b"one", b"two"]


KILLED = """
import sys
from pathlib import Path
from tests.record.test_record_writer import Plain
from recon.record.record_writer import RecordWriter
writer = RecordWriter(Path(sys.argv[1]), Plain(), "test")
writer.start()
number = 0
while True:
    if writer.has_room:
        writer.put(("/step", number.to_bytes(8, "big") * 30_000), 240_000)
        number += 1
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


def test_the_next_start_repairs_and_leaves_what_is_being_written(tmp_path: Path) -> None:
    first = RecordWriter(tmp_path, Plain(), "test")
    first.start()
    first.put(("/step", b"one"), 3)
    until(lambda: first.path is not None and first.path.stat().st_size > 0)
    (tmp_path / "cut.mcap").write_bytes(b"\x89MCAP0\r\n" + bytes(3))
    (tmp_path / "other.mcap").write_bytes(b"something else")
    second = RecordWriter(tmp_path, Plain(), "test")
    second.start()
    until(lambda: second.path is not None)
    assert second.repaired == [tmp_path / "cut.mcap"]
    assert is_finished(tmp_path / "cut.mcap")
    assert (tmp_path / "other.mcap").read_bytes() == b"something else"
    assert first.path is not None
    assert not is_finished(first.path)
    first.close()
    second.close()
    assert first.path != second.path
    assert second.problem is None


def test_images_stop_first_and_come_back(tmp_path: Path) -> None:
    free_bytes = [record_writer.IMAGES_STOP_BYTES]
    writer = RecordWriter(tmp_path, Plain(), "test", lambda _folder: free_bytes[0])
    writer.start()
    writer.put(("/image", b"first"), 5)
    until(lambda: writer.path is not None and len(messages(writer.path)) == 1)
    assert writer.problem is None
    free_bytes[0] = record_writer.IMAGES_STOP_BYTES - 1
    until(lambda: writer.problem is not None)
    assert writer.problem is not None
    assert "less than 2 GiB are free" in writer.problem
    assert "without images" in writer.problem
    writer.put(("/image", b"second"), 5)
    writer.put(("/step", b"order"), 5)
    free_bytes[0] = record_writer.IMAGES_AGAIN_BYTES
    assert writer.path is not None
    path = writer.path
    until(lambda: writer.problem is None)
    writer.put(("/image", b"third"), 5)
    writer.close()
    assert b"order" in [m.data for m in messages(path)]
    assert [m.data for m in messages(path) if m.topic == "/image"][-1] == b"third"


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
    writer = RecordWriter(tmp_path, Plain(), "test")
    writer.start()
    until(lambda: writer.path is not None)
    is_full[0] = True
    for number in range(20):
        writer.put(("/step", bytes([number])), 1)
    until(lambda: writer.problem is not None)
    assert writer.problem == f"the record cannot be written to {tmp_path}: No space left on device"
    is_full[0] = False
    until(lambda: writer.problem is None)
    writer.close()
    assert writer.path is not None
    assert [m.data for m in messages(writer.path)] == [bytes([n]) for n in range(20)]


def test_a_folder_that_cannot_be_written_is_a_problem(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    writer = RecordWriter(tmp_path / "file", Plain(), "test")
    writer.start()
    until(lambda: writer.problem is not None)
    writer.close()
    assert writer.problem is not None
    assert writer.problem.startswith("the record cannot be written to")


def test_what_waits_is_bounded(tmp_path: Path) -> None:
    """The thread has not begun: a disk that takes nothing."""
    writer = RecordWriter(tmp_path, Plain(), "test")
    assert writer.has_room
    writer.put(("/image", b""), record_writer.WAITING_BYTES)
    assert not writer.has_room
    for _ in range(record_writer.WAITING_ITEMS - 1):
        assert writer.put(("/step", b""), 0)
    assert not writer.put(("/step", b""), 0)


def test_an_item_that_cannot_be_written_is_a_problem_and_no_end(tmp_path: Path) -> None:
    writer = RecordWriter(tmp_path, Plain(), "test")
    writer.start()
    writer.put("neither topic nor bytes", 1)
    writer.put(("/step", b"one"), 3)
    until(lambda: writer.path is not None and len(messages(writer.path)) == 1)
    assert writer.problem is not None
    assert "a part of the record is missing" in writer.problem
    writer.close()


def test_topics_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(record_writer, "MOST_TOPICS", 3)
    writer = RecordWriter(tmp_path, Plain(), "test")
    writer.start()
    for number in range(10):
        writer.put((f"/{number}", b"x"), 1)
    writer.close()
    assert writer.path is not None
    topics = {m.topic for m in messages(writer.path)}
    assert topics == {"/0", "/1", "/2", "/other/raw"}
