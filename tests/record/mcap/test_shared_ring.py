"""The ring between the station and the process that writes its record."""

import os
import queue
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.model.errors import RecordError
from recon.record.mcap.items import HEAD, Item, ItemKind, packed
from recon.record.mcap.record_process import RingInbox
from recon.record.mcap.shared_ring import SharedRing, shared_file

SIZE = 64


@given(st.lists(st.lists(st.binary(max_size=20), max_size=3), max_size=40), st.data())
def test_what_comes_out_is_what_was_put(batches: list[list[bytes]], data: st.DataObject) -> None:
    descriptor = shared_file(SIZE)
    writer, reader = SharedRing(descriptor, SIZE), SharedRing(descriptor, SIZE)
    os.close(descriptor)
    sent, came = b"", b""
    for parts in batches:
        if sum(map(len, parts)) <= SIZE - writer.waiting_bytes:
            writer.put(parts)
            sent += b"".join(parts)
        count = data.draw(st.integers(0, reader.waiting_bytes))
        came += reader.peek(count)
        reader.take(count)
    came += reader.peek(reader.waiting_bytes)
    assert came == sent
    writer.close()
    reader.close()


READER = """
import sys
from recon.record.mcap.shared_ring import SharedRing

ring = SharedRing(int(sys.argv[1]), int(sys.argv[2]))
print("ready", flush=True)
print(sum(ring.waiting_bytes != 1 for _ in range(2_000_000)))
"""


def test_another_process_never_reads_half_a_counter() -> None:
    descriptor = shared_file(SIZE)
    writer = SharedRing(descriptor, SIZE)
    writer.put([b"x"])
    command = [sys.executable, "-c", READER, str(descriptor), str(SIZE)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, pass_fds=[descriptor]) as reader:
        os.close(descriptor)
        assert reader.stdout is not None
        assert reader.stdout.readline() == b"ready\n"
        while reader.poll() is None:
            for _ in range(1000):
                writer.put(())
        assert reader.stdout.read() == b"0\n"
    writer.close()


def test_half_an_item_is_an_error_and_not_the_end() -> None:
    descriptor = shared_file(SIZE)
    ring = SharedRing(descriptor, SIZE)
    os.close(descriptor)
    inbox = RingInbox(ring)
    ring.put(packed(ItemKind.STEP, b"whole"))
    assert inbox.get(timeout=0.0) == Item(ItemKind.STEP, b"whole")
    with pytest.raises(queue.Empty):
        inbox.get(timeout=0.0)
    ring.put([HEAD.pack(ItemKind.STEP, 10), b"half"])
    inbox.is_over = True
    with pytest.raises(RecordError, match="expected an item of 15 bytes, got 9"):
        inbox.get(timeout=0.0)
    ring.take(9)
    assert inbox.get(timeout=0.0) is None
    ring.close()
