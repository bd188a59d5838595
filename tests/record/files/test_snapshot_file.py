"""The snapshot file: after a crash or damage at any byte, the old or the new one is read."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.record.files import snapshot_file
from recon.record.files.snapshot_file import (
    CURRENT,
    PREVIOUS,
    SNAPSHOT,
    TEMPORARY,
    read_snapshot,
    write_snapshot,
)

OLD, NEW = b'{"old": 1}', b'{"new": [2, 3]}'


def read(folder: Path) -> tuple[bytes | None, tuple[str, ...]]:
    found = read_snapshot(folder, bytes)
    return found.value, found.troubles


def write(folder: Path, payload: bytes, *, keep_current: bool = True) -> None:
    write_snapshot(folder, payload, keep_current=keep_current)


class Killed(BaseException):
    """The process ends here."""


class KilledAfter:
    """Lets a write go on for so many bytes and calls of the system, then kills it."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, steps: int) -> None:
        self.steps = steps
        self._write, self._replace, self._fsync = os.write, os.replace, os.fsync
        monkeypatch.setattr(snapshot_file.os, "write", self.write)
        monkeypatch.setattr(snapshot_file.os, "replace", self.replace)
        monkeypatch.setattr(snapshot_file.os, "fsync", self.fsync)

    def write(self, file: int, data: bytes) -> int:
        part = data[: self.steps]
        self.steps -= len(part)
        written = self._write(file, part)
        if len(part) < len(data):
            raise Killed
        return written

    def replace(self, source: Path, target: Path) -> None:
        self.step()
        self._replace(source, target)

    def fsync(self, file: int) -> None:
        self.step()
        self._fsync(file)

    def step(self) -> None:
        if self.steps == 0:
            raise Killed
        self.steps -= 1


def test_what_is_written_is_read(tmp_path: Path) -> None:
    assert read(tmp_path) == (None, ())
    write(tmp_path / "new" / "folder", OLD)
    assert read(tmp_path / "new" / "folder") == (OLD, ())
    assert (tmp_path / "new" / "folder" / CURRENT).stat().st_mode & 0o077 == 0


def test_a_kill_at_any_step_of_a_write_leaves_the_old_or_the_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = tmp_path / "whole"
    write(whole, NEW)
    calls = 4  # Two syncs and two replacements.
    last = (whole / CURRENT).stat().st_size + calls
    values: list[bytes | None] = []
    for steps in range(last + 1):
        folder = tmp_path / f"at-{steps}"
        write(folder, b"older")
        write(folder, OLD)
        with monkeypatch.context() as patched:
            killed = KilledAfter(patched, steps)
            try:
                write(folder, NEW)
            except Killed:
                assert steps < last
        value, troubles = read(folder)
        assert troubles == ()
        values.append(value)
        # The next run writes on, whatever it found.
        write(folder, b"next", keep_current=read_snapshot(folder, bytes).is_current_good)
        assert read(folder) == (b"next", ())
        assert killed.steps == 0
    assert set(values) == {OLD, NEW}
    assert values == sorted(values, key=lambda value: value == NEW)
    assert values[-2:] == [NEW, NEW]


@pytest.mark.parametrize("flipped", [0x01, 0x20, 0x80, 0xFF])
def test_damage_at_any_byte_of_the_current_file_yields_the_previous_one(
    tmp_path: Path, flipped: int
) -> None:
    write(tmp_path, OLD)
    write(tmp_path, NEW)
    data = (tmp_path / CURRENT).read_bytes()
    for position in range(len(data)):
        damaged = bytearray(data)
        damaged[position] ^= flipped
        (tmp_path / CURRENT).write_bytes(damaged)
        value, (trouble,) = read(tmp_path)
        assert value == OLD
        assert CURRENT in trouble


def test_a_current_file_cut_or_extended_anywhere_yields_the_previous_one(tmp_path: Path) -> None:
    write(tmp_path, OLD)
    write(tmp_path, NEW)
    data = (tmp_path / CURRENT).read_bytes()
    for length in range(len(data)):
        (tmp_path / CURRENT).write_bytes(data[:length])
        value, (trouble,) = read(tmp_path)
        assert value == OLD
        assert "not used" in trouble
    (tmp_path / CURRENT).write_bytes(data + b"x")
    assert read(tmp_path)[0] == OLD


def test_a_temporary_file_of_any_content_is_never_read(tmp_path: Path) -> None:
    write(tmp_path, NEW)
    data = (tmp_path / CURRENT).read_bytes()
    for length in range(len(data) + 1):
        (tmp_path / TEMPORARY).write_bytes(data[:length])
        assert read(tmp_path) == (NEW, ())


def test_a_damaged_current_file_never_replaces_a_good_previous_one(tmp_path: Path) -> None:
    write(tmp_path, OLD)
    write(tmp_path, NEW)
    (tmp_path / CURRENT).write_bytes(b"garbage")
    found = read_snapshot(tmp_path, bytes)
    assert (found.value, found.is_current_good) == (OLD, False)
    write(tmp_path, b"next", keep_current=found.is_current_good)
    (tmp_path / CURRENT).write_bytes(b"garbage again")
    assert read(tmp_path)[0] == OLD


@given(st.binary(max_size=300), st.binary(max_size=300))
def test_two_files_of_any_content_are_troubles_and_no_exception(
    tmp_path_factory: pytest.TempPathFactory, current: bytes, previous: bytes
) -> None:
    folder = tmp_path_factory.mktemp("hostile")
    (folder / CURRENT).write_bytes(current)
    (folder / PREVIOUS).write_bytes(previous)
    value, troubles = read(folder)
    assert value is None
    assert len(troubles) == 2


def header(**changes: object) -> bytes:
    values = {"format": "recon-snapshot", "version": 1, "bytes": 0, "sha256": "0"} | changes
    return repr(values).replace("'", '"').encode() + b"\n"


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (header(version=3), "format version 3; this station reads versions 1 to 2"),
        (header(format="recon-audit"), "not a recovery snapshot"),
        (header(bytes=SNAPSHOT.max_bytes + 1), "the header announces 33554433"),
        (header(bytes=-1), "header is damaged"),
        (header(bytes=10**400), "header is damaged"),
        (header(), "checksum does not match"),
        (b"[" * 100_000, "header is damaged"),
        (b"", "header is damaged"),
        (b"z" * 1_000_000, "header is damaged"),
    ],
)
def test_a_header_that_is_not_accepted_is_named(
    tmp_path: Path, content: bytes, reason: str
) -> None:
    (tmp_path / CURRENT).write_bytes(content)
    value, (trouble,) = read(tmp_path)
    assert value is None
    assert reason in trouble


def test_a_huge_file_is_not_read_into_memory(tmp_path: Path) -> None:
    write(tmp_path, OLD)
    with (tmp_path / CURRENT).open("r+b") as file:
        file.truncate(10**12)
    value, (trouble,) = read(tmp_path)
    assert value is None
    assert f"expected {len(OLD)} bytes, got more" in trouble


def test_a_payload_that_is_not_accepted_yields_the_previous_one(tmp_path: Path) -> None:
    write(tmp_path, OLD)
    write(tmp_path, NEW)

    def decode(payload: bytes) -> bytes:
        if payload == NEW:
            raise ValueError("latitude_deg out of range")
        return payload

    found = read_snapshot(tmp_path, decode)
    assert found.value == OLD
    assert "latitude_deg out of range" in found.troubles[0]


def test_a_folder_or_a_pipe_in_its_place_is_a_trouble(tmp_path: Path) -> None:
    (tmp_path / CURRENT).mkdir()
    os.mkfifo(tmp_path / PREVIOUS)
    value, troubles = read(tmp_path)
    assert value is None
    assert all("not a regular file" in trouble for trouble in troubles)
    assert len(troubles) == 2


def test_a_payload_over_the_limit_is_an_error_before_anything_is_written(tmp_path: Path) -> None:
    write(tmp_path, OLD)
    with pytest.raises(OSError, match="up to 33554432 bytes"):
        write(tmp_path, bytes(SNAPSHOT.max_bytes + 1))
    assert read(tmp_path) == (OLD, ())
