"""The ring between the station and the process that writes its record."""

import os

from hypothesis import given
from hypothesis import strategies as st

from recon.record.shared_ring import SharedRing, shared_file

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
