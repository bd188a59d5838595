"""The heights of `recon site fetch`: tiles found or fetched, cut to the site, and described."""

import shutil
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path

import typer

from recon.cli.opened_site import save_staged
from recon.cli.output import print_line
from recon.fetching.file_download import download
from recon.fetching.polite_client import (
    AskedServer,
    AskFailedError,
    FetchError,
    polite_client,
)
from recon.fetching.source_address import local_path, shown_source
from recon.geo.geoid import ERROR_95_M, geoid_height_m
from recon.model.errors import SiteError
from recon.model.foreign_text import one_line
from recon.site import Site
from recon.site.elevation import Datum, flown_area_m, refuse_other_datum
from recon.site.elevation_tiles import DegreeTile, has_places, tile_address, tiles_over
from recon.site.elevation_window import ElevationWindow, elevation_window, needed_bounds_deg
from recon.site.fetched_files import stage_elevation
from recon.site.height_file import HeightFile, opened_on_disk
from recon.site.terrain_source import KnownElevation, TerrainSource, known_elevation

LARGEST_TILE_BYTES = 768 * 1024 * 1024
"""3DEP's tiles of a third of a second have up to half of it, Copernicus' 40 MB."""
UNFINISHED_FOLDER = ".fetching"
"""Tiles under way, in the site's folder: hidden, no part of the site, removed at the end."""


@dataclass(slots=True)
class _FoundTiles:
    """Tiles on this computer, and those that the source does not have."""

    files: list[Path] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)


async def fetch_elevation(
    folder: Path, site: Site, addresses: Sequence[str], stated: str | None, replaces: bool
) -> bool:
    """Make a site's elevation model of tiles; return whether all of the boundary has heights.

    Raises `FetchError` or `SiteError`; what was fetched by then is kept for the next call.
    """
    known = known_elevation(" ".join(addresses))
    datum = _datum(stated, known)
    tiles = tiles_over(needed_bounds_deg(site))
    found, unfinished = _FoundTiles(), folder / UNFINISHED_FOLDER
    for address in addresses:
        await _find(address, tiles, unfinished, found)
    if not found.files:
        raise FetchError(
            f"expected heights over the site, got none: {', '.join(found.missing)} missing at the "
            "source; it is sea there, or the model has no coverage"
        )
    source = _source(addresses, known, found, datum)
    with ExitStack() as stack:
        window = elevation_window(site, _opened(stack, found.files, unfinished, datum))
        geotiff = window.geotiff(source)
    assert site.frame is not None, "a folder's site has an origin"
    origin = site.frame.origin
    sea_level_m = round(geoid_height_m(origin.latitude_deg, origin.longitude_deg), 2)
    staged = stage_elevation(folder, geotiff, datum, sea_level_m, replaces=replaces)
    save_staged(folder, staged, f"heights from {source.title}")
    print_line(f"{', '.join(staged.files)} written")
    shutil.rmtree(unfinished, ignore_errors=True)
    for line in _lines(site, window, source, sea_level_m if datum == "geoid" else None):
        print_line(line)
    share = window.reach_share if window.boundary_share is None else window.boundary_share
    return share == 1.0


def _datum(stated: str | None, known: KnownElevation | None) -> Datum:
    if stated in ("geoid", "wgs84"):
        return "geoid" if stated == "geoid" else "wgs84"
    if stated is None and known is not None:
        return "geoid"
    got = "none for a model that is not known" if stated is None else ascii(stated[:40])
    raise SiteError(
        f"--datum: expected geoid (heights above sea level) or wgs84 (above the ellipsoid), got "
        f"{got}"
    )


async def _find(
    address: str, tiles: Sequence[DegreeTile], unfinished: Path, found: _FoundTiles
) -> None:
    """Add an address's tiles: files of this computer as they are, others fetched."""
    if has_places(address):
        named = {str(tile): tile_address(address, tile) for tile in tiles}
    else:
        named = {shown_source(address): address}
    fetched: dict[str, str] = {}
    for name, own in named.items():
        path = local_path(own)
        if path is None:
            fetched[name] = own
        elif path.is_file():
            found.files.append(path)
        else:
            found.missing.append(name)
    if fetched:
        await _fetch(shown_source(address), fetched, unfinished, found)


async def _fetch(host: str, named: dict[str, str], folder: Path, found: _FoundTiles) -> None:
    print_line(f"{len(named)} tiles from {host}: {', '.join(named)}")
    server = AskedServer(host, "tiles")
    try:
        folder.mkdir(exist_ok=True)
        async with polite_client("image/tiff, application/octet-stream;q=0.9, */*;q=0.1") as client:
            for name, url in named.items():
                path = folder / f"{sha256(url.encode()).hexdigest()[:32]}.tif"
                shown = _TileProgress(name)
                if await download(client, url, server, path, LARGEST_TILE_BYTES, shown.show):
                    found.files.append(path)
                else:
                    found.missing.append(name)
    except AskFailedError as problem:
        raise FetchError(
            f"{host}: expected the tile {name}, got: {problem}; try again later, it resumes where "
            "it stopped"
        ) from problem
    except OSError as problem:
        raise FetchError(f"{folder} cannot be written: {problem.strerror or problem}") from problem


def _opened(
    stack: ExitStack, files: Sequence[Path], unfinished: Path, datum: Datum
) -> list[HeightFile]:
    """Return the open tiles, which `stack` closes. Raises `SiteError` for what is none."""
    opened = []
    for path in files:
        try:
            opened.append(stack.enter_context(opened_on_disk(path)))
            refuse_other_datum(opened[-1], datum)
        except SiteError:
            # A fetched one would be found again, and refused again.
            if path.parent == unfinished:
                path.unlink(missing_ok=True)
            raise
    return opened


def _source(
    addresses: Sequence[str], known: KnownElevation | None, found: _FoundTiles, datum: Datum
) -> TerrainSource:
    shown = dict.fromkeys(shown_source(address) for address in addresses)
    origin = one_line(", ".join(shown), 120)
    zero = "the WGS84 ellipsoid" if datum == "wgs84" else "sea level"
    return TerrainSource(
        origin if known is None else f"{known.title} ({origin})",
        int(time.time()),
        known.zero if known is not None and datum == "geoid" else zero,
        None if known is None else known.is_surface,
        "" if known is None else known.notice,
        tuple(one_line(name, 40) for name in found.missing[:100]),
    )


def _lines(
    site: Site, window: ElevationWindow, source: TerrainSource, sea_level_m: float | None
) -> list[str]:
    """Return what a person should know about the heights."""
    (west, south), (east, north) = (each.tolist() for each in flown_area_m(site.airspace))
    rows, cols = window.heights_m.shape
    inside = window.boundary_share
    lines = [
        "heights of "
        + ("" if inside is None else f"{_percent(inside)} of the boundary and ")
        + f"{_percent(window.reach_share)} of the {east - west:.0f} x {north - south:.0f} m that "
        f"flights may reach: {cols} x {rows} pixels from {source.title}"
    ]
    if source.missing:
        lines.append(
            f"no tile at the source: {', '.join(source.missing)}: sea, or no coverage; flights "
            "over ground without heights are refused"
        )
    if sea_level_m is not None:
        lines.append(
            f"heights above {source.zero}, taken as sea level, which is {sea_level_m:g} m above "
            f"the WGS84 ellipsoid here by EGM96 at whole degrees (within {ERROR_95_M:g} m at 95 % "
            "of places): a better value goes to elevation.geoid_height_m"
        )
    if source.is_surface:
        lines.append("a surface model: trees and buildings are part of its ground")
    return [*lines, *([f"source: {source.notice}"] if source.notice else [])]


def _percent(share: float) -> str:
    """Return a share as text: never 100 % for less."""
    return f"{int(1000.0 * share) / 10.0:g} %"


class _TileProgress:
    """Progress on standard error: a line each ten megabytes."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._next = 0

    def show(self, received_bytes: int) -> None:
        if received_bytes >= self._next:
            self._next = received_bytes + 10_000_000
            typer.echo(f"{self._name}: {received_bytes / 1e6:.1f} MB", err=True)
