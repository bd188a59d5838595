"""Tiles of a server, fetched into an MBTiles file before leaving base.

A few requests at a time, each bounded in time and size and read as it is; redirects are not
followed. Tiles that are in the file are not asked for again, so an interrupted fetch resumes where
it stopped.
"""

import asyncio
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from hashlib import sha256
from pathlib import Path
from urllib.parse import urlsplit

import httpx

from recon.basemap.map_file import (
    LARGEST_TILE_BYTES,
    VECTOR,
    BaseMapError,
    checked_zooms,
    picture_of,
)
from recon.basemap.mbtiles_writer import MBTilesWriter
from recon.basemap.web_mercator import MapArea
from recon.fetching.polite_client import (
    AT_ONCE,
    PAUSE_S,
    AskedServer,
    AskFailedError,
    answered,
    body_of,
    polite_client,
    with_tries,
)
from recon.model.foreign_text import one_line

MOST_FETCHED = 20_000
"""Most tiles of one run unless allowed: 0.5 GB, acceptable for a public server."""
TILE_WITHIN_S = 20.0
MOST_FAILURES = 10
"""Most failures in a row: the server is gone, or refuses."""
PLACES = ("{z}", "{x}", "{y}")

Key = tuple[int, int, int]
Progress = Callable[["FetchCount"], None]


@dataclass(frozen=True, slots=True)
class TileServer:
    """A server of tiles: its address with {z}, {x} and {y} ({-y}: rows from the south)."""

    template: str
    attribution: str = ""

    def __post_init__(self) -> None:
        plain = self.template.replace("{-y}", "{y}")
        address = urlsplit(plain) if plain.isprintable() and " " not in plain else None
        is_address = address is not None and address.scheme in ("http", "https") and address.netloc
        is_whole = all(plain.count(place) == 1 for place in PLACES)
        if not is_address or not is_whole or set(re.findall(r"\{.*?\}", plain)) != set(PLACES):
            raise BaseMapError(
                "expected the address of a tile server with {z}, {x} and {y} in it, like "
                f"http://HOST/{{z}}/{{x}}/{{y}}.png; got {one_line(self.template)!a}"
            )

    @property
    def host(self) -> str:
        """The server's name, which may be shown: an address may hold a key."""
        return urlsplit(self.template).hostname or ""

    @property
    def digest(self) -> str:
        """Distinguishes the address from others, without the key in it."""
        return sha256(self.template.encode()).hexdigest()

    def url(self, zoom: int, col: int, row: int) -> str:
        """Return the address of a tile, rows from the north."""
        numbers = {"{z}": zoom, "{x}": col, "{y}": row, "{-y}": 2**zoom - 1 - row}
        text = self.template
        for place, number in numbers.items():
            text = text.replace(place, str(number))
        return text


@dataclass(slots=True)
class FetchCount:
    """How far a fetch is; `missing` are tiles that the server does not have."""

    needed: int
    present: int
    fetched: int = 0
    missing: int = 0
    failed: int = 0
    problems: dict[str, int] = field(default_factory=dict)
    """How often each, at most a few."""

    @property
    def done(self) -> int:
        """Return the number of finished tiles."""
        return self.present + self.fetched + self.missing + self.failed


def needed_tiles(area: MapArea, zooms: range, most: int = MOST_FETCHED) -> list[Key]:
    """Return the tiles over an area, coarse ones first; raises `BaseMapError` for too many."""
    checked_zooms(zooms.start, zooms.stop - 1)
    keys: list[Key] = []
    for zoom in zooms:
        tiles = area.tiles(zoom)
        if tiles is None or len(keys) + len(tiles.cols) > most:
            got = len(keys) + (area.most_tiles(zoom) if tiles is None else len(tiles.cols))
            fits = f"fetch zoom {zooms[0]}-{zoom - 1}" if zoom > zooms[0] else "begin coarser"
            raise BaseMapError(
                f"expected at most {most} tiles, got {got} or more to zoom {zoom}; {fits}, or "
                "allow more with --most-tiles"
            )
        pairs = zip(tiles.cols.tolist(), tiles.rows.tolist(), strict=True)
        keys += [(zoom, col, row) for col, row in pairs]
    return keys


async def fetch(
    server: TileServer,
    keys: list[Key],
    area: MapArea,
    path: Path,
    progress: Progress = lambda _: None,
    pause_s: float = PAUSE_S,
) -> FetchCount:
    """Fetch the tiles that an MBTiles file lacks. Raises `BaseMapError`.

    The file is made, or must be of the same server. What was fetched before an error is kept.
    """
    with MBTilesWriter(path, server.digest) as file:
        present = file.present()
        wanted = [key for key in keys if key not in present]
        count = FetchCount(len(keys), len(keys) - len(wanted))
        progress(count)
        file.describe(path.stem, server.attribution, area.bounds_deg)
        async with polite_client("image/*") as client:
            run = _Run(server, client, file, count, progress, pause_s)
            await run.all(iter(wanted))
    return count


@dataclass(slots=True)
class _Run:
    """One fetch."""

    server: TileServer
    client: httpx.AsyncClient
    file: MBTilesWriter
    count: FetchCount
    progress: Progress
    pause_s: float
    _failures: int = 0

    async def all(self, wanted: Iterator[Key]) -> None:
        """Fetch all; the first error of a kind that stays ends it."""
        try:
            async with asyncio.TaskGroup() as tasks:
                for _ in range(AT_ONCE):
                    tasks.create_task(self._some(wanted))
        except BaseExceptionGroup as problems:
            raise problems.exceptions[0] from None

    async def _some(self, wanted: Iterator[Key]) -> None:
        for key in wanted:
            try:
                data = await with_tries(partial(self._ask, key), self.pause_s)
            except AskFailedError as problem:
                self._failed(str(problem))
            else:
                self._failures = 0
                if data is None:
                    self.count.missing += 1
                else:
                    self.file.add(key, data)
                    self.count.fetched += 1
            self.progress(self.count)

    def _failed(self, problem: str) -> None:
        count = self.count
        count.failed += 1
        self._failures += 1
        if problem in count.problems or len(count.problems) < MOST_FAILURES:
            count.problems[problem] = count.problems.get(problem, 0) + 1
        if self._failures >= MOST_FAILURES:
            raise BaseMapError(
                f"{self.server.host}: expected tiles, got {MOST_FAILURES} failures in a row, the "
                f"last: {problem}; try again later, it resumes where it stopped"
            )

    async def _ask(self, key: Key) -> bytes | None:
        """Return a tile; None if the server has none. Raises `AskFailedError`."""
        url, asked = self.server.url(*key), AskedServer(self.server.host, "tiles", BaseMapError)
        async with answered(self.client, url, asked, TILE_WITHIN_S) as answer:
            if answer is None:
                return None
            data = await body_of(answer, LARGEST_TILE_BYTES, "a tile")
        try:
            picture_of(data)
        except BaseMapError as problem:
            sentence = VECTOR if data[:2] == b"\x1f\x8b" else str(problem)
            raise AskFailedError(sentence, tries_again=False) from problem
        return data
