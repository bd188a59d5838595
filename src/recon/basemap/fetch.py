"""Tiles of a server, fetched into an MBTiles file before leaving base.

A few requests at a time, each bounded in time and size and read as it is; redirects are not
followed. Tiles that are in the file are not asked for again, so an interrupted fetch resumes where
it stopped.
"""

import asyncio
import re
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from urllib.parse import urlsplit

import httpx

from recon import version
from recon.basemap.map_file import (
    LARGEST_TILE_BYTES,
    VECTOR,
    BaseMapError,
    checked_zooms,
    one_line,
    picture_of,
)
from recon.basemap.mbtiles_writer import MBTilesWriter
from recon.basemap.web_mercator import MapArea

MOST_FETCHED = 20_000
"""Most tiles of one run unless allowed: 0.5 GB, acceptable for a public server."""
AT_ONCE = 2
"""Requests at once, as the usage policies of public servers require."""
TILE_WITHIN_S = 20.0
TRIES = 3
PAUSE_S = 1.0
"""Pause before a second try, doubled before the third."""
LONGEST_PAUSE_S = 60.0
"""Longest pause, whatever a busy server asks for."""
MOST_FAILURES = 10
"""Most failures in a row: the server is gone, or refuses."""
USER_AGENT = f"Recon/{version()} (ground control station; offline map of one field)"
PLACES = ("{z}", "{x}", "{y}")
OK, NO_CONTENT, NOT_FOUND, GONE = 200, 204, 404, 410
REFUSED = frozenset({401, 402, 403})

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
        async with _client() as client:
            run = _Run(server, client, file, count, progress, pause_s)
            await run.all(iter(wanted))
    return count


@asynccontextmanager
async def _client() -> AsyncIterator[httpx.AsyncClient]:
    headers = {"User-Agent": USER_AGENT, "Accept-Encoding": "identity", "Accept": "image/*"}
    limits = httpx.Limits(max_connections=AT_ONCE)
    async with httpx.AsyncClient(
        headers=headers, timeout=TILE_WITHIN_S, follow_redirects=False, limits=limits
    ) as client:
        yield client


class _TileFailedError(Exception):
    """One tile could not be fetched; perhaps another try succeeds, `after_s` from now."""

    def __init__(self, problem: str, after_s: float = 0.0, tries_again: bool = True) -> None:
        super().__init__(problem)
        self.after_s = after_s
        self.tries_again = tries_again


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
                data = await self._tries(key)
            except _TileFailedError as problem:
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

    async def _tries(self, key: Key) -> bytes | None:
        pause_s = self.pause_s
        for left in reversed(range(TRIES)):
            try:
                return await self._ask(key)
            except _TileFailedError as problem:
                if left == 0 or not problem.tries_again:
                    raise
                await asyncio.sleep(min(LONGEST_PAUSE_S, max(pause_s, problem.after_s)))
                pause_s *= 2.0
        return None

    async def _ask(self, key: Key) -> bytes | None:
        """Return a tile; None if the server has none. Raises `_TileFailedError`."""
        try:
            async with (
                asyncio.timeout(TILE_WITHIN_S),
                self.client.stream("GET", self.server.url(*key)) as answer,
            ):
                if answer.status_code != OK:
                    self._refused(answer)
                    return None
                data = await _body(answer)
        except TimeoutError as problem:
            raise _TileFailedError(f"no answer within {TILE_WITHIN_S:g} s") from problem
        except (httpx.HTTPError, httpx.InvalidURL) as problem:
            raise _TileFailedError(one_line(problem) or type(problem).__name__) from problem
        try:
            picture_of(data)
        except BaseMapError as problem:
            sentence = VECTOR if data[:2] == b"\x1f\x8b" else str(problem)
            raise _TileFailedError(sentence, tries_again=False) from problem
        return data

    def _refused(self, answer: httpx.Response) -> None:
        """Return for a tile that does not exist; raise for everything else."""
        status = answer.status_code
        if status in (NO_CONTENT, NOT_FOUND, GONE):
            return
        if status in REFUSED:
            raise BaseMapError(
                f"{self.server.host}: expected tiles, got status {status}: it refuses; is its key "
                "in the address, and does its licence allow offline use?"
            )
        if answer.is_redirect:
            raise BaseMapError(
                f"{self.server.host}: expected a tile, got a redirect to "
                f"{one_line(answer.headers.get('location', 'nowhere'))!a}; if that is right, give "
                "its address"
            )
        raise _TileFailedError(f"status {status}", _asked_pause_s(answer))


async def _body(answer: httpx.Response) -> bytes:
    """Return the body, as long as a tile may be."""
    parts, length = [], 0
    async for part in answer.aiter_raw():
        parts.append(part)
        length += len(part)
        if length > LARGEST_TILE_BYTES:
            raise _TileFailedError(
                f"expected a tile of at most {LARGEST_TILE_BYTES} bytes, got more",
                tries_again=False,
            )
    return b"".join(parts)


def _asked_pause_s(answer: httpx.Response) -> float:
    text = answer.headers.get("retry-after", "")
    return float(text) if re.fullmatch(r"\d{1,4}", text) else 0.0
