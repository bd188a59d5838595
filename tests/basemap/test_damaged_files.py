"""Any damage to a map file gives an answer: facts, a tile, or a sentence; the process stays."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.basemap.made_maps import FIELD, Key, keys_over, write_mbtiles, write_pmtiles
from tests.basemap.test_geotiff_map import ramps, write
from tests.examples import examples

from recon.basemap.map_file import BaseMapError
from recon.basemap.map_reader import MapReader

KEYS = keys_over(FIELD, range(15, 18))
NAMES = ("a.mbtiles", "a.pmtiles", "a.tif")
DAMAGE = st.lists(
    st.tuples(st.floats(0.0, 1.0, exclude_max=True), st.integers(0, 255)), min_size=1, max_size=20
)
"""Where, as a share of the file or of its head, and the byte that comes there."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("whole")
    write_mbtiles(folder / "a.mbtiles", KEYS, {"attribution": "x"})
    write_pmtiles(folder / "a.pmtiles", KEYS)
    write(folder / "a.tif", ramps(600), overviews=True)
    return {name: (folder / name).read_bytes() for name in NAMES}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("damaged")


@pytest.fixture(scope="module")
def reader(folder: Path) -> Iterator[MapReader]:
    with closing(MapReader(folder)) as opened:
        yield opened


def tile_or_problem(reader: MapReader, name: str, key: Key) -> str:
    """Return a tile's media type, "none" for none, or why it cannot be read."""
    try:
        tile, _ = reader.tile(name, *key)
    except BaseMapError as problem:
        return str(problem)
    assert tile is None or tile.media_type in ("image/png", "image/jpeg", "image/webp")
    return "none" if tile is None else tile.media_type


@pytest.mark.parametrize("name", NAMES)
@given(damage=DAMAGE, head=st.sampled_from([200, 2_000, None]), kept=st.floats(0.2, 1.0))
@settings(
    max_examples=examples(200),
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_a_damaged_file_gives_an_answer_and_the_process_stays(
    name: str,
    damage: list[tuple[float, int]],
    head: int | None,
    kept: float,
    whole: dict[str, bytes],
    folder: Path,
    reader: MapReader,
) -> None:
    data = bytearray(whole[name])
    for place, byte in damage:
        data[int(place * (head or len(data)))] = byte
    (folder / name).unlink(missing_ok=True)
    (folder / name).write_bytes(data[: int(kept * len(data))] if head is None else data)
    known = reader.facts(name, FIELD)
    assert "ends its reader" not in known.problem
    assert (known.info is None) == bool(known.problem)
    for key in (KEYS[0], KEYS[-1]):
        assert "ends its reader" not in tile_or_problem(reader, name, key)
