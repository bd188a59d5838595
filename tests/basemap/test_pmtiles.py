"""PMTiles by the process that reads maps: whole files, and hostile ones."""

import gzip
from pathlib import Path

import pytest
from pmtiles import writer
from pmtiles.tile import (
    Compression,
    Entry,
    TileType,
    deserialize_header,
    serialize_directory,
    serialize_header,
    zxy_to_tileid,
)
from tests.basemap.made_maps import (
    FIELD,
    Key,
    colour_in,
    colour_of,
    keys_over,
    picture,
    write_pmtiles,
)

from recon.basemap.coverage import FULL
from recon.basemap.map_file import BaseMapError
from recon.basemap.map_reader import MapReader

ZOOMS = range(14, 19)
KEYS = keys_over(FIELD, ZOOMS)
ROOT = 127


def test_a_file_states_what_it_is_and_each_tile_is_of_its_place(
    folder: Path, reader: MapReader
) -> None:
    facts = {"name": "orthophoto", "attribution": "<b>© survey</b>"}
    write_pmtiles(folder / "a.pmtiles", KEYS, facts)
    known = reader.facts("a.pmtiles", FIELD)
    info = known.info
    assert info is not None
    assert (info.kind, info.title, info.attribution) == ("PMTiles", "orthophoto", "© survey")
    assert (info.min_zoom, info.max_zoom, info.tile_px) == (14, 18, 256)
    assert info.bounds_deg == pytest.approx(FIELD.bounds_deg)
    assert [level.zoom for level in known.coverage] == list(ZOOMS)
    assert min(level.share for level in known.coverage) >= FULL
    for key in KEYS:
        tile, _ = reader.tile("a.pmtiles", *key)
        assert tile is not None
        assert colour_in(tile.data) == colour_of(*key)
    zoom, col, row = KEYS[-1]
    assert reader.tile("a.pmtiles", zoom, col + 50, row)[0] is None


def test_missing_tiles_lower_the_coverage(folder: Path, reader: MapReader) -> None:
    tiles = FIELD.tiles(18)
    assert tiles is not None
    lost = int(tiles.shares.argmax())
    key = (18, int(tiles.cols[lost]), int(tiles.rows[lost]))
    write_pmtiles(folder / "a.pmtiles", [each for each in KEYS if each != key])
    levels = reader.facts("a.pmtiles", FIELD).coverage
    assert levels[-1].share == pytest.approx(1.0 - tiles.shares[lost])
    assert levels[-2].share >= FULL


def test_a_file_with_leaves_is_read_to_its_last_tile(
    folder: Path, reader: MapReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    def in_leaves(entries: list[Entry], _: int) -> tuple[bytes, bytes, int]:
        return writer.build_roots_leaves(entries, 5)

    monkeypatch.setattr(writer, "optimize_directories", in_leaves)
    path = write_pmtiles(folder / "a.pmtiles", KEYS)
    assert deserialize_header(path.read_bytes()[:ROOT])["leaf_directory_length"] > 0
    known = reader.facts("a.pmtiles", FIELD)
    assert min(level.share for level in known.coverage) >= FULL
    for key in KEYS:
        tile, _version = reader.tile("a.pmtiles", *key)
        assert tile is not None
        assert colour_in(tile.data) == colour_of(*key)


def write_raw(path: Path, root: bytes, data: bytes = b"", **changes: object) -> None:
    """Write a file whose root directory is these bytes."""
    header = {
        "root_offset": ROOT,
        "root_length": len(root),
        "metadata_offset": ROOT + len(root),
        "metadata_length": 0,
        "leaf_directory_offset": ROOT,
        "leaf_directory_length": len(root),
        "tile_data_offset": ROOT + len(root),
        "tile_data_length": len(data),
        "clustered": True,
        "internal_compression": Compression.GZIP,
        "tile_compression": Compression.NONE,
        "tile_type": TileType.PNG,
        "min_zoom": 0,
        "max_zoom": 0,
        **changes,
    }
    path.write_bytes(serialize_header(header) + root + data)  # type: ignore[arg-type]


def test_directories_may_be_plain(folder: Path, reader: MapReader) -> None:
    key = keys_over(FIELD, [18])[0]
    tile = picture(colour_of(*key))
    packed = serialize_directory([Entry(zxy_to_tileid(*key), 0, len(tile), 1)])
    west, south, east, north = (round(degrees * 1e7) for degrees in FIELD.bounds_deg)
    write_raw(
        folder / "a.pmtiles",
        gzip.decompress(packed),
        tile,
        internal_compression=Compression.NONE,
        min_zoom=18,
        max_zoom=18,
        min_lon_e7=west,
        min_lat_e7=south,
        max_lon_e7=east,
        max_lat_e7=north,
    )
    assert reader.facts("a.pmtiles", FIELD).info is not None
    found, _ = reader.tile("a.pmtiles", *key)
    assert found is not None
    assert colour_in(found.data) == colour_of(*key)


def broken(path: Path, kind: str) -> None:
    one: list[Key] = [(0, 0, 0)]
    tile = picture((1, 2, 3))
    whole = serialize_directory([Entry(0, 0, len(tile), 1)])
    match kind:
        case "empty":
            path.write_bytes(b"")
        case "another kind":
            path.write_bytes(b"no map " * 100)
        case "version 2":
            path.write_bytes(b"PMTiles\x02" + bytes(200))
        case "vector":
            write_pmtiles(path, one, None, b"\x1a\x00", tile_type=TileType.MVT)
        case "other tiles":
            write_pmtiles(path, one, tile_type=TileType.AVIF)
        case "not the type it claims":
            write_pmtiles(path, one, None, b"\x1f\x8b" + bytes(30))
        case "cut short":
            data = write_pmtiles(path, KEYS).read_bytes()
            path.write_bytes(data[: len(data) - 300])
        case "no entries":
            write_raw(path, serialize_directory([]))
        case "bomb":
            write_raw(path, gzip.compress(bytes(400_000_000), 9), tile)
        case "many claimed":
            write_raw(path, gzip.compress(b"\xff\xff\xff\xff\x7f" + bytes(100)), tile)
        case "loop":
            # A leaf that is the root itself.
            loop = serialize_directory([Entry(0, 0, 46, 0)])
            write_raw(path, serialize_directory([Entry(0, 0, len(loop), 0)]), tile)
        case "far offset":
            write_raw(path, serialize_directory([Entry(0, 2**62, 100, 1)]), tile)
        case "giant directory":
            write_raw(path, whole, tile, root_length=2**63)
        case "giant tile":
            write_raw(path, serialize_directory([Entry(0, 0, 2**40, 1)]), tile)
        case "deep zoom":
            write_raw(path, serialize_directory([Entry(4**30, 0, len(tile), 1)]), tile)
        case "huge picture":
            write_raw(path, serialize_directory([Entry(0, 0, 10**5, 1)]), picture((1, 2, 3), 9_000))


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [
        ("empty", "expected a whole PMTiles file"),
        ("another kind", "got another kind of file"),
        ("version 2", "expected PMTiles version 3"),
        ("vector", "got vector tiles"),
        ("other tiles", "expected tiles as PNG, JPEG or WebP"),
        ("not the type it claims", "expected tiles as PNG, JPEG or WebP"),
        ("cut short", "expected a whole PMTiles file"),
        ("no entries", "without any"),
        ("bomb", "bytes unpacked, got more"),
        ("many claimed", "expected a whole PMTiles file"),
        ("loop", "expected"),
        ("far offset", "expected a whole PMTiles file"),
        ("giant directory", "expected directories of at most"),
        ("giant tile", "expected tiles of at most"),
        ("deep zoom", "expected zoom levels of 0 to 24"),
        ("huge picture", "got 9000 x 9000"),
    ],
)
def test_what_is_no_map_is_refused_with_a_sentence_and_disturbs_no_other(
    folder: Path, reader: MapReader, kind: str, sentence: str
) -> None:
    broken(folder / "bad.pmtiles", kind)
    write_pmtiles(folder / "good.pmtiles", KEYS[:1])
    assert sentence in reader.facts("bad.pmtiles", FIELD).problem
    with pytest.raises(BaseMapError):
        reader.tile("bad.pmtiles", 0, 0, 0)
    assert reader.tile("good.pmtiles", *KEYS[0])[0] is not None
    # The process that refused it still runs.
    assert reader._process is not None
    assert reader._process.poll() is None
