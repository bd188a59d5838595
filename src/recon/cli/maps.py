"""`recon maps`: base maps for the console, brought before leaving base: fetched and checked."""

import asyncio
import re
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from recon.cli.commands import App
from recon.cli.opened_site import FolderArgument, opened_site
from recon.cli.output import print_line

if TYPE_CHECKING:
    from recon.basemap.fetch import FetchCount, TileServer
    from recon.basemap.map_reader import KnownMap
    from recon.basemap.web_mercator import MapArea
    from recon.site import Site

maps_app = App(
    help="Bring base maps for the console: fetch tiles, check coverage.", no_args_is_help=True
)
INCOMPLETE = 1
LARGEST_MARGIN_M = 5_000.0


@maps_app.command("check")
def check_command(folder: FolderArgument) -> None:
    """Print what each map shows of the site at each zoom level, before leaving base.

    Exit code 0: a map shows all of the boundary with its margin; 1: no map does.
    """
    from recon.basemap.coverage import finest_covered
    from recon.basemap.map_reader import MapReader, map_versions
    from recon.site.reading import MAPS_FOLDER

    site = opened_site(folder)
    area = _area(site)
    print_line(f"site {site.name}: {_area_line(site, area)}")
    reader = MapReader(folder / MAPS_FOLDER)
    try:
        maps = [reader.facts(each, area) for each in map_versions(folder / MAPS_FOLDER)]
    finally:
        reader.close()
    for each in maps:
        for line in _map_lines(each):
            print_line(line)
    if not maps:
        print_line(f"no map in {folder / MAPS_FOLDER}: put MBTiles, PMTiles or GeoTIFF files there")
    finest = [covers for each in maps if (covers := finest_covered(each.coverage))]
    if not any(covers.share == 1.0 for covers in finest):
        print_line("no map shows all of the site")
        raise typer.Exit(INCOMPLETE)


@maps_app.command("fetch")
def fetch_command(
    folder: FolderArgument,
    url: Annotated[
        str | None,
        typer.Option(
            metavar="TEMPLATE",
            help="Address of a tile server with {z}, {x} and {y}; default: [tile_server] of "
            "site.toml.",
        ),
    ] = None,
    zoom: Annotated[
        str, typer.Option(metavar="FIRST-LAST", help="Zoom levels; 19 has pixels of 0.2 to 0.3 m.")
    ] = "12-19",
    name: Annotated[
        str | None, typer.Option(help="Of the file in maps; default: the server's host.")
    ] = None,
    attribution: Annotated[
        str | None, typer.Option(help="The source to show on the map, as its licence asks.")
    ] = None,
    margin_m: Annotated[
        float,
        typer.Option(min=100.0, max=LARGEST_MARGIN_M, help="Around the boundary, metres."),
    ] = 100.0,
    most_tiles: Annotated[
        int, typer.Option(min=1, max=250_000, help="Refuse to fetch more than this.")
    ] = 20_000,
) -> None:
    """Fetch tiles of the site's ground from a tile server into its folder, for offline use.

    Ask the server's licence first. An interrupted fetch resumes where it stopped.
    """
    from recon.basemap.fetch import fetch, needed_tiles
    from recon.site.reading import MAPS_FOLDER

    area = _area(opened_site(folder), margin_m)
    server = _server(folder, url, attribution)
    keys = needed_tiles(area, _zooms(zoom), most_tiles)
    path = folder / MAPS_FOLDER / f"{_file_name(name or server.host)}.mbtiles"
    print_line(f"{len(keys)} tiles of zoom {zoom} from {server.host} into {path}")
    count = asyncio.run(fetch(server, keys, area, path, _Shown(len(keys)).show))
    print_line(
        f"{count.fetched} fetched, {count.present} there already, {count.missing} that the server "
        f"does not have, {count.failed} failed"
    )
    for problem, times in count.problems.items():
        print_line(f"failed {times} times: {problem}")
    print_line(f"what it covers: recon maps check {folder}")
    if count.failed:
        print_line("fetch again to try the failed ones again")
        raise typer.Exit(INCOMPLETE)


def _area(site: "Site", margin_m: float | None = None) -> "MapArea":
    """Return the ground that a map should show."""
    from recon.basemap.web_mercator import MARGIN_M, area_around

    assert site.frame is not None, "a folder's site has an origin"
    reach_m = site.limits.max_distance_from_home_m
    margin_m = MARGIN_M if margin_m is None else margin_m
    return area_around(site.frame, site.layers.boundary, reach_m, margin_m)


def _area_line(site: "Site", area: "MapArea") -> str:
    west, south, east, north = area.bounds_deg
    reach = f"no boundary: {site.limits.max_distance_from_home_m:g} m around the origin"
    what = reach if site.layers.boundary is None else "boundary"
    return f"{what} with margin from {south:.5f}, {west:.5f} to {north:.5f}, {east:.5f}"


def _map_lines(known: "KnownMap") -> list[str]:
    from recon.basemap.coverage import finest_covered
    from recon.site.fetched_report import age_text

    if known.info is None:
        return [f"{known.name}: not used: {known.problem}"]
    covers = finest_covered(known.coverage)
    fetched_s = known.info.fetched_utc_s
    age = "" if fetched_s is None else f", {age_text(fetched_s, time.time())}"
    head = f"{known.name}: {known.info.kind}, {known.size_bytes / 1e6:.1f} MB{age}"
    if covers is None:
        return [f"{head}: too many tiles over the site to count"]
    lines = [
        f"{head}: covers {_percent(covers.share)} of the site to zoom {covers.zoom} "
        f"({covers.metres_per_pixel:.2f} m a pixel)"
    ]
    lines += [
        f"  zoom {level.zoom:2}: {_percent(level.share):>6}  {level.metres_per_pixel:.2f} m a pixel"
        for level in known.coverage
    ]
    return lines


def _percent(share: float) -> str:
    """Return a share as text: never 100 % for less, never 0 % for more."""
    return "< 1 %" if 0.0 < share < 0.01 else f"{int(100.0 * share)} %"


def _server(folder: Path, url: str | None, attribution: str | None) -> "TileServer":
    from recon.basemap.fetch import TileServer
    from recon.model.errors import SiteError
    from recon.site.load import read_tile_server

    table = read_tile_server(folder)
    if url is None and table is None:
        raise SiteError(
            f"{folder}: expected the address of a tile server, got none: give --url, or add "
            '[tile_server] with url = "..." to site.toml'
        )
    own = "" if table is None or url is not None else table.attribution
    address = url if url is not None or table is None else table.url
    assert address is not None
    return TileServer(address, own if attribution is None else attribution)


def _zooms(text: str) -> range:
    from recon.basemap.web_mercator import DEEPEST_ZOOM
    from recon.model.errors import SiteError

    match = re.fullmatch(r"(\d{1,2})(?:-(\d{1,2}))?", text)
    first, last = (int(match[1]), int(match[2] or match[1])) if match else (1, 0)
    if not first <= last <= DEEPEST_ZOOM:
        raise SiteError(
            f"--zoom: expected levels of 0 to {DEEPEST_ZOOM}, coarse to fine like 12-19, got "
            f"{text!a}"
        )
    return range(first, last + 1)


def _file_name(text: str) -> str:
    from recon.model.errors import SiteError

    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 ._-]{0,79}", text):
        raise SiteError(f"--name: expected letters, digits, spaces, dots and hyphens, got {text!a}")
    return text.removesuffix(".mbtiles")


class _Shown:
    """Progress on standard error: a line each twentieth."""

    def __init__(self, needed: int) -> None:
        self._step = max(1, needed // 20)
        self._next = 0

    def show(self, count: "FetchCount") -> None:
        if count.done < min(self._next, count.needed):
            return
        self._next = count.done + self._step
        typer.echo(f"{count.done} of {count.needed} tiles", err=True)
