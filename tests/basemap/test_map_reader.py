"""Map files as the station reads them: by the process, whole ones and hostile ones."""

import sqlite3
import sys
from contextlib import closing
from pathlib import Path

import pytest
from tests.basemap.made_maps import (
    FIELD,
    colour_in,
    colour_of,
    keys_over,
    picture,
    write_mbtiles,
)

from recon.basemap import map_reader
from recon.basemap.coverage import coverage, finest_covered
from recon.basemap.map_file import LARGEST_TILE_BYTES, BaseMapError, MapInfo, Tile
from recon.basemap.map_reader import MapReader, map_versions
from recon.basemap.web_mercator import MapArea, metres_per_pixel

ZOOMS = range(15, 19)
FACTS = {"name": "orthophoto 2025", "attribution": '© <a href="https://x">survey</a>\n &amp; co'}


def test_an_mbtiles_file_states_what_it_is_and_covers(folder: Path, reader: MapReader) -> None:
    write_mbtiles(folder / "a.mbtiles", keys_over(FIELD, ZOOMS), FACTS)
    facts = reader.facts("a.mbtiles", FIELD)
    assert facts.problem == ""
    info = facts.info
    assert info is not None
    assert (info.kind, info.title, info.attribution) == (
        "MBTiles",
        "orthophoto 2025",
        "© survey & co",
    )
    assert (info.min_zoom, info.max_zoom, info.tile_px) == (15, 18, 256)
    west, south, east, north = info.bounds_deg
    assert west <= -93.604 < -93.600 <= east
    assert south <= 41.900 < 41.903 <= north
    assert [level.zoom for level in facts.coverage] == list(ZOOMS)
    covers = finest_covered(facts.coverage)
    assert covers is not None
    assert (covers.zoom, covers.share) == (18, pytest.approx(1.0))
    assert covers.metres_per_pixel == pytest.approx(metres_per_pixel(41.9015, 18))


def test_a_file_without_a_description_is_known_by_its_tiles(
    folder: Path, reader: MapReader
) -> None:
    path = write_mbtiles(folder / "a.mbtiles", keys_over(FIELD, ZOOMS))
    with closing(sqlite3.connect(path)) as database, database:
        database.execute("DROP TABLE metadata")
    facts = reader.facts("a.mbtiles", FIELD)
    assert facts.info is not None
    assert facts.info.title == "a"
    west, south, east, north = facts.info.bounds_deg
    assert west <= -93.604 < -93.600 <= east
    assert south <= 41.900 < 41.903 <= north


def test_each_tile_is_the_one_of_its_place(folder: Path, reader: MapReader) -> None:
    keys = keys_over(FIELD, ZOOMS)
    write_mbtiles(folder / "a.mbtiles", keys)
    for key in keys:
        tile, version = reader.tile("a.mbtiles", *key)
        assert tile is not None
        assert version == map_versions(folder)["a.mbtiles"][1]
        assert (tile.media_type, colour_in(tile.data)) == ("image/png", colour_of(*key))
    zoom, col, row = keys[-1]
    assert reader.tile("a.mbtiles", zoom, col + 100, row)[0] is None
    assert reader.tile("a.mbtiles", zoom + 1, 2 * col, 2 * row)[0] is None
    assert reader.tile("b.mbtiles", *keys[-1])[0] is None


def test_a_hole_lowers_the_coverage_of_its_level_only(folder: Path, reader: MapReader) -> None:
    keys = keys_over(FIELD, ZOOMS)
    tiles = FIELD.tiles(18)
    assert tiles is not None
    lost = int(tiles.shares.argmax())
    keys.remove((18, int(tiles.cols[lost]), int(tiles.rows[lost])))
    write_mbtiles(folder / "a.mbtiles", keys)
    levels = reader.facts("a.mbtiles", FIELD).coverage
    assert levels[-1].share == pytest.approx(1.0 - tiles.shares[lost])
    covers = finest_covered(levels)
    assert covers is not None
    assert covers.zoom == 17


def test_without_full_coverage_the_finest_level_with_most_is_named(
    folder: Path, reader: MapReader
) -> None:
    # The same half at each level: what is covered is a matter of place, not of detail.
    tiles = FIELD.tiles(16)
    assert tiles is not None
    half = [
        (zoom, col * 2 ** (zoom - 16) + dx, row * 2 ** (zoom - 16) + dy)
        for col, row in list(zip(tiles.cols.tolist(), tiles.rows.tolist(), strict=True))[:1]
        for zoom in (16, 17)
        for dx in range(2 ** (zoom - 16))
        for dy in range(2 ** (zoom - 16))
    ]
    write_mbtiles(folder / "a.mbtiles", half)
    covers = finest_covered(reader.facts("a.mbtiles", FIELD).coverage)
    assert covers is not None
    assert covers.zoom == 17
    assert covers.share == pytest.approx(tiles.shares[0], abs=1e-6)
    assert 0.0 < covers.share < 1.0


class Shares:
    """A map of which each level, from 0 on, shows a share of any area."""

    def __init__(self, *shares: float | None) -> None:
        self._shares = shares
        last = len(shares) - 1
        self.info = MapInfo("", "", "", 0, last, 256, (-94.0, 41.0, -93.0, 42.0))

    def tile(self, zoom: int, col: int, row: int) -> Tile | None:
        return None

    def share(self, area: MapArea, zoom: int) -> float | None:
        return self._shares[zoom]

    def close(self) -> None:
        pass


def test_all_but_rounding_is_all_and_no_more() -> None:
    levels = coverage(Shares(0.9996, 1.0000002, 0.9994, None), FIELD)
    assert [level.share for level in levels] == [1.0, 1.0, 0.9994]
    covers = finest_covered(levels)
    assert covers is not None
    assert covers.zoom == 1


def test_a_changed_file_is_opened_anew(folder: Path, reader: MapReader) -> None:
    key = keys_over(FIELD, [15])[0]
    path = write_mbtiles(folder / "a.mbtiles", [key])
    first = reader.tile("a.mbtiles", *key)
    path.unlink()
    write_mbtiles(path, [key, (15, 0, 0)], tile=picture((9, 9, 9)))
    second = reader.tile("a.mbtiles", *key)
    assert first[1] != second[1]
    assert second[0] is not None
    assert colour_in(second[0].data) == (9, 9, 9)


def title(reader: MapReader) -> str:
    info = reader.facts("a.mbtiles", FIELD).info
    return "" if info is None else info.title


def test_a_file_with_a_log_of_writes_is_read_during_and_after_them(
    folder: Path, reader: MapReader
) -> None:
    keys = keys_over(FIELD, [15])
    path = write_mbtiles(folder / "a.mbtiles", keys)
    with closing(sqlite3.connect(path)) as writer:
        writer.execute("PRAGMA journal_mode=WAL")
        with writer:
            writer.execute("INSERT INTO metadata VALUES ('name', 'written')")
        assert title(reader) == "written"
    assert title(reader) == "written"
    assert reader.tile("a.mbtiles", *keys[0])[0] is not None


def test_nothing_is_written_beside_a_file_that_had_a_log(folder: Path, reader: MapReader) -> None:
    path = write_mbtiles(folder / "a.mbtiles", keys_over(FIELD, [15]), {"name": "closed"})
    with closing(sqlite3.connect(path)) as writer:
        writer.execute("PRAGMA journal_mode=WAL")
    assert title(reader) == "closed"
    assert [each.name for each in folder.iterdir()] == ["a.mbtiles"]


def broken(folder: Path, kind: str) -> Path:
    path = folder / "bad.mbtiles"
    key = keys_over(FIELD, [15])[0]
    match kind:
        case "empty file":
            path.write_bytes(b"")
        case "another kind":
            path.write_bytes(b"<html>no map</html>" * 100)
        case "cut short":
            data = write_mbtiles(path, keys_over(FIELD, range(14, 19))).read_bytes()
            path.write_bytes(data[: len(data) // 3])
        case "no tables":
            with closing(sqlite3.connect(path)) as database, database:
                database.execute("CREATE TABLE other (x)")
        case "no tiles":
            write_mbtiles(path, [])
        case "vector format":
            write_mbtiles(path, [key], {"format": "pbf"}, b"\x1a\x00")
        case "gzipped tiles":
            write_mbtiles(path, [key], None, b"\x1f\x8b\x08" + bytes(50))
        case "giant picture":
            write_mbtiles(path, [key], None, picture((1, 2, 3), 6_000))
        case "giant blob":
            write_mbtiles(path, [key], None, bytes(LARGEST_TILE_BYTES + 1))
        case "text in a tile":
            write_mbtiles(path, [key])
            with closing(sqlite3.connect(path)) as database, database:
                database.execute("UPDATE tiles SET tile_data = 'text'")
        case "endless view":
            with closing(sqlite3.connect(path)) as database, database:
                database.execute("CREATE TABLE metadata (name text, value text)")
                database.execute(
                    "CREATE VIEW tiles AS WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1"
                    " FROM n) SELECT -1 - i AS zoom_level, 0 AS tile_column, 0 AS tile_row,"
                    " x'00' AS tile_data FROM n"
                )
    return path


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [
        ("empty file", "expected an MBTiles file"),
        ("another kind", "expected an MBTiles file"),
        ("cut short", "expected a whole MBTiles file"),
        ("no tables", "expected a whole MBTiles file, got: no such table"),
        ("no tiles", "without any"),
        ("vector format", "got vector tiles; export"),
        ("gzipped tiles", "got vector tiles; export"),
        ("giant picture", "got 6000 x 6000"),
        ("giant blob", "expected a whole MBTiles file"),
        ("text in a tile", "expected a picture in each tile"),
    ],
)
def test_what_is_no_map_is_refused_with_a_sentence_and_disturbs_no_other(
    folder: Path, reader: MapReader, kind: str, sentence: str
) -> None:
    broken(folder, kind)
    key = keys_over(FIELD, [15])[0]
    write_mbtiles(folder / "good.mbtiles", [key])
    refused = reader.facts("bad.mbtiles", FIELD)
    assert refused.info is None
    assert sentence in refused.problem
    assert str(folder) not in refused.problem
    with pytest.raises(BaseMapError, match="expected"):
        reader.tile("bad.mbtiles", *key)
    assert reader.tile("good.mbtiles", *key)[0] is not None
    assert reader.facts("good.mbtiles", FIELD).problem == ""


def test_a_file_that_never_ends_is_given_up_and_the_next_is_read(
    folder: Path, reader: MapReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken(folder, "endless view")
    key = keys_over(FIELD, [15])[0]
    write_mbtiles(folder / "good.mbtiles", [key])
    assert reader.tile("good.mbtiles", *key)[0] is not None
    monkeypatch.setattr(map_reader, "FACTS_WITHIN_S", 0.5)
    assert "not read within 0.5 s" in reader.facts("bad.mbtiles", FIELD).problem
    assert reader.tile("good.mbtiles", *key)[0] is not None


@pytest.mark.parametrize(
    "script",
    [
        "import os; input(); os._exit(11)",
        "input(); print('no json', flush=True); input()",
        "input(); print('{\"length\": 99999999999}', flush=True); input()",
        "input(); print('x' * 200000, flush=True); input()",
    ],
)
def test_a_process_that_breaks_costs_one_answer(folder: Path, script: str) -> None:
    write_mbtiles(folder / "a.mbtiles", keys_over(FIELD, [15]))
    opened = MapReader(folder, (sys.executable, "-c", script))
    with closing(opened):
        for _ in range(2):
            assert "ends its reader" in opened.facts("a.mbtiles", FIELD).problem
            with pytest.raises(BaseMapError, match="ends its reader"):
                opened.tile("a.mbtiles", 15, 0, 0)


def test_only_plain_files_of_the_folder_are_maps(folder: Path, reader: MapReader) -> None:
    key = keys_over(FIELD, [15])[0]
    outside = write_mbtiles(folder.parent / f"{folder.name}-outside.mbtiles", [key])
    (folder / "link.mbtiles").symlink_to(outside)
    (folder / "folder.mbtiles").mkdir()
    write_mbtiles(folder / ".hidden.mbtiles", [key])
    (folder / "notes.txt").write_text("x")
    write_mbtiles(folder / "Luftbild Süd 1.MBTILES", [key])
    assert list(map_versions(folder)) == ["Luftbild Süd 1.MBTILES", "link.mbtiles"]
    assert reader.tile("Luftbild Süd 1.MBTILES", *key)[0] is not None
    # A link is listed, with why it is not used.
    assert "got a link; copy the file" in reader.facts("link.mbtiles", FIELD).problem
    with pytest.raises(BaseMapError, match="got a link"):
        reader.tile("link.mbtiles", *key)
    for name in (f"../{outside.name}", str(outside), "folder.mbtiles", ".hidden.mbtiles", ""):
        assert reader.tile(name, *key)[0] is None
    assert map_versions(folder / "missing") == {}


def test_a_closed_reader_answers_nothing_and_leaves_no_process(folder: Path) -> None:
    write_mbtiles(folder / "a.mbtiles", keys_over(FIELD, [15]))
    opened = MapReader(folder)
    opened.facts("a.mbtiles", FIELD)
    process = opened._process
    assert process is not None
    opened.close()
    assert process.poll() is not None
    assert "closed" in opened.facts("a.mbtiles", FIELD).problem
