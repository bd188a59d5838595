"""Makes map files whose every tile is known: its colour states zoom level, column and row."""

import sqlite3
from collections.abc import Iterable, Sequence
from contextlib import closing
from io import BytesIO
from pathlib import Path

from PIL import Image

from recon.basemap.web_mercator import MapArea

FIELD = MapArea(((-93.604, 41.900), (-93.600, 41.900), (-93.600, 41.903), (-93.604, 41.903)))
"""330 m square in Iowa."""
Key = tuple[int, int, int]
INDEX = "CREATE UNIQUE INDEX place ON tiles (zoom_level, tile_column, tile_row)"


def colour_of(zoom: int, col: int, row: int) -> tuple[int, int, int]:
    return 10 * zoom % 256, col % 256, row % 256


def picture(colour: tuple[int, int, int], size_px: int = 256, kind: str = "PNG") -> bytes:
    data = BytesIO()
    Image.new("RGB", (size_px, size_px), colour).save(data, kind)
    return data.getvalue()


def colour_in(data: bytes) -> tuple[int, ...]:
    with Image.open(BytesIO(data)) as image:
        pixel = image.convert("RGB").getpixel((128, 128))
    assert isinstance(pixel, tuple)
    return pixel


def keys_over(area: MapArea, zooms: Iterable[int]) -> list[Key]:
    keys = []
    for zoom in zooms:
        tiles = area.tiles(zoom)
        assert tiles is not None
        pairs = zip(tiles.cols.tolist(), tiles.rows.tolist(), strict=True)
        keys += [(zoom, col, row) for col, row in pairs]
    return keys


def write_pmtiles(
    path: Path,
    keys: Iterable[Key],
    facts: dict[str, str] | None = None,
    tile: bytes | None = None,
    **header: object,
) -> Path:
    """Write a file of these tiles by the format's own library."""
    from pmtiles.tile import Compression, TileType, zxy_to_tileid
    from pmtiles.writer import Writer

    west, south, east, north = (round(each * 1e7) for each in FIELD.bounds_deg)
    with path.open("wb") as file:
        writer = Writer(file)
        for key in sorted(keys, key=lambda key: zxy_to_tileid(*key)):
            writer.write_tile(zxy_to_tileid(*key), tile or picture(colour_of(*key)))
        stated = {
            "tile_type": TileType.PNG,
            "tile_compression": Compression.NONE,
            "min_lon_e7": west,
            "min_lat_e7": south,
            "max_lon_e7": east,
            "max_lat_e7": north,
        }
        writer.finalize({**stated, **header}, facts or {})
    return path


def write_mbtiles(
    path: Path,
    keys: Sequence[Key],
    facts: dict[str, str] | None = None,
    tile: bytes | None = None,
) -> Path:
    """Write a file of these tiles; rows from the south, as MBTiles has them."""
    with closing(sqlite3.connect(path)) as database, database:
        database.execute("CREATE TABLE metadata (name text, value text)")
        database.execute(
            "CREATE TABLE tiles (zoom_level integer, tile_column integer, tile_row integer,"
            " tile_data blob)"
        )
        database.execute(INDEX)
        database.executemany("INSERT INTO metadata VALUES (?, ?)", (facts or {}).items())
        database.executemany(
            "INSERT INTO tiles VALUES (?, ?, ?, ?)",
            [(z, x, 2**z - 1 - y, tile or picture(colour_of(z, x, y))) for z, x, y in keys],
        )
    return path
