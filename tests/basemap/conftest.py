"""One process that reads maps for all tests of a file: each start loads GDAL again."""

import shutil
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from recon.basemap.map_reader import MapReader


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory) -> Iterator[MapReader]:
    """The reader of the maps in `folder`."""
    with closing(MapReader(tmp_path_factory.mktemp("maps"))) as opened:
        yield opened


@pytest.fixture
def folder(reader: MapReader) -> Path:
    """The reader's folder, empty when a test begins."""
    shutil.rmtree(reader.folder)
    reader.folder.mkdir()
    return reader.folder
