"""The fuzzed readers read the files that the search begins with, or refuse them as documented."""

from contextlib import suppress
from pathlib import Path

import pytest
from studies.fuzz_readers.readers import READERS

LESS_DEAR = sorted(READERS.keys() - {"flight", "mbtiles", "pmtiles", "geotiff-map"})
"""Others make larger files, by what their own rooms test."""


@pytest.mark.parametrize("name", LESS_DEAR)
def test_a_reader_reads_a_file_that_its_search_begins_with(name: str, tmp_path: Path) -> None:
    reader, read = READERS[name], 0
    made = tmp_path / "made"
    made.mkdir()
    for number, data in enumerate(reader.seeds(made)):
        assert len(data) <= reader.longest_bytes
        folder = tmp_path / str(number)
        folder.mkdir()
        with suppress(*reader.errors):
            reader.read(data, folder)
            read += 1
    assert read > 0
