"""MCAP files: read by the library's own reader, whole, cut anywhere, and repaired."""

import io
import os
import struct
from pathlib import Path
from random import Random

import pytest
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader

from recon.model.errors import RecordError
from recon.record.mcap.mcap_file import McapFile
from recon.record.mcap.mcap_read import MAGIC, McapReading, RecordAttachment, RecordMessage
from recon.record.mcap.mcap_repair import is_finished, repair

CHUNKS, PER_CHUNK = 6, 20


def content(channel: int, number: int) -> bytes:
    return Random(f"{channel}-{number}").randbytes(40 + number)


def written(path: Path, finish: bool = True) -> Path:
    """A file of known messages: two channels, the second begins in the third chunk."""
    file = McapFile(path, "test")
    schema = file.add_schema("test.Thing", "jsonschema", b"{}")
    file.add_attachment("start", "text/plain", b"the beginning", 5)
    channels = [file.add_channel("/first", "json", schema)]
    for chunk in range(CHUNKS):
        if chunk == 2:
            channels.append(file.add_channel("/second", "msgpack"))
        for number in range(chunk * PER_CHUNK, (chunk + 1) * PER_CHUNK):
            for channel in channels:
                file.add_message(channel, number, 1000 + number, content(channel, number))
        file.flush()
    if finish:
        file.finish()
    else:
        file.abandon()
    return path


def numbers(path: Path) -> dict[str, list[int]]:
    """The numbers of the messages of each topic, by the library's indexed reader."""
    found: dict[str, list[int]] = {}
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        for _schema, channel, message in reader.iter_messages():
            found.setdefault(channel.topic, []).append(message.sequence)
            assert message.data == content(channel.id, message.sequence)
        counts = {
            summary.channels[n].topic: c
            for n, c in summary.statistics.channel_message_counts.items()
        }
    assert counts == {topic: len(each) for topic, each in found.items()}
    return found


def test_a_finished_file_is_read_by_the_library(tmp_path: Path) -> None:
    path = written(tmp_path / "a.mcap")
    assert numbers(path) == {"/first": [*range(120)], "/second": [*range(40, 120)]}
    with path.open("rb") as file:
        (attachment,) = make_reader(file).iter_attachments()
        assert (attachment.name, attachment.data) == ("start", b"the beginning")
    with path.open("rb") as file:
        kinds = [type(r).__name__ for r in StreamReader(file, validate_crcs=True).records]
    assert kinds[0] == "Header"
    assert kinds[-1] == "Footer"
    assert is_finished(path)
    assert repair(path) is None


def test_our_reader_gives_what_was_written(tmp_path: Path) -> None:
    path = written(tmp_path / "a.mcap")
    with path.open("rb") as file:
        reading = McapReading(file)
        items = list(reading.items())
    assert not reading.trouble
    assert items[0] == RecordAttachment("start", "text/plain", b"the beginning")
    messages = [item for item in items if isinstance(item, RecordMessage)]
    assert messages[0] == RecordMessage("/first", "json", "test.Thing", 0, 1000, content(1, 0))
    assert len(messages) == 200


@pytest.mark.parametrize("seed", range(40))
def test_a_file_cut_anywhere_keeps_every_whole_chunk(tmp_path: Path, seed: int) -> None:
    whole = written(tmp_path / "whole.mcap", finish=seed % 2 == 0)
    data = whole.read_bytes()
    cut = Random(seed).randrange(len(data))
    path = tmp_path / "cut.mcap"
    path.write_bytes(data[:cut])
    if cut < 8:
        with pytest.raises(RecordError, match="expected a flight record"):
            repair(path)
        return
    with path.open("rb") as file:
        reading = McapReading(file)
        kept = sum(isinstance(item, RecordMessage) for item in reading.items())
    repaired = repair(path)
    assert repaired is not None
    assert is_finished(path)
    found = numbers(path)
    assert sum(map(len, found.values())) == kept
    assert found.get("/first", []) == [*range(len(found.get("/first", [])))]
    # No chunk that was whole is lost: each holds 20 numbers.
    assert kept >= _messages_whole_before(data, cut)


def _messages_whole_before(data: bytes, cut: int) -> int:
    count, stream = 0, StreamReader(io.BytesIO(data), emit_chunks=True)
    chunk = 0
    for record in stream.records:
        if type(record).__name__ == "Chunk":
            if stream._stream.count > cut:
                break
            count += PER_CHUNK * (1 if chunk < 2 else 2)
            chunk += 1
            if chunk == CHUNKS:
                break
    return count


@pytest.mark.parametrize("seed", range(20))
def test_bytes_that_never_reached_the_disk_cost_the_last_chunk(tmp_path: Path, seed: int) -> None:
    """A power cut: the file has its length, and its last bytes are zeros."""
    data = written(tmp_path / "whole.mcap", finish=False).read_bytes()
    zeros = Random(seed).randrange(1, 2500)
    path = tmp_path / "cut.mcap"
    path.write_bytes(data[:-zeros] + bytes(zeros))
    assert repair(path) is not None
    first = numbers(path)["/first"]
    assert first == [*range(len(first))]
    assert len(first) >= PER_CHUNK * (CHUNKS - 3)


@pytest.mark.parametrize("seed", range(60))
def test_damage_is_no_crash(tmp_path: Path, seed: int) -> None:
    data = bytearray(written(tmp_path / "whole.mcap").read_bytes())
    random = Random(seed)
    for _ in range(random.randrange(1, 5)):
        data[random.randrange(8, len(data))] = random.randrange(256)
    reading = McapReading(io.BytesIO(bytes(data)))
    for item in reading.items():
        assert isinstance(item, RecordMessage | RecordAttachment)


def test_a_size_that_a_file_claims_is_not_allocated() -> None:
    reading = McapReading(io.BytesIO(MAGIC + b"\x06" + (2**62).to_bytes(8, "little") + b"x" * 50))
    assert list(reading.items()) == []
    assert "limit" in reading.trouble or "up to" in reading.trouble


def test_an_attachment_that_claims_more_than_can_be_counted_is_damage(tmp_path: Path) -> None:
    """Its own length of its data, inside a record of a true length."""
    texts = struct.pack("<QQI", 1, 2, 1) + b"a" + struct.pack("<I", 1) + b"b"
    content = texts + struct.pack("<Q", 2**63) + b"data"
    record = b"\x09" + len(content).to_bytes(8, "little") + content
    reading = McapReading(io.BytesIO(MAGIC + record))
    assert list(reading.items()) == []
    assert "damaged record at byte 8" in reading.trouble
    path = tmp_path / "cut.mcap"
    path.write_bytes(MAGIC + record)
    assert repair(path) is not None
    assert is_finished(path)


def test_a_failed_write_is_made_good(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = McapFile(tmp_path / "a.mcap", "test")
    channel = file.add_channel("/first", "json")
    file.add_message(channel, 0, 1000, content(1, 0))
    file.flush()
    size, real = file.size, os.pwrite

    def full(descriptor: int, data: bytes, at: int) -> int:
        real(descriptor, data[:7], at)
        raise OSError(28, "No space left on device")

    file.add_message(channel, 1, 1001, content(1, 1))
    monkeypatch.setattr(os, "pwrite", full)
    with pytest.raises(OSError, match="No space"):
        file.flush()
    assert file.path.stat().st_size == size
    monkeypatch.setattr(os, "pwrite", real)
    file.add_message(channel, 2, 1002, content(1, 2))
    file.finish()
    assert numbers(file.path) == {"/first": [0, 1, 2]}
