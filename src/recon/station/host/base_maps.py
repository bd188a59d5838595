"""The base maps of a site's folder for the API: read by processes, asked on threads.

Two readers: what a new map covers takes seconds, and tiles do not wait for it.
"""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from recon.api import schema
from recon.api.map_routes import IsGone, MapFileError, MapFolder, MapsBusyError, NoMaps, TileRead
from recon.basemap.coverage import ZoomCoverage, finest_covered
from recon.basemap.map_file import BaseMapError, MapInfo
from recon.basemap.map_reader import KnownMap, MapReader, map_versions
from recon.basemap.web_mercator import MapArea, area_around
from recon.site import Site, own_folder
from recon.site.reading import MAPS_FOLDER

MOST_WAITING = 256
"""Most requests that wait for a tile being read: a console sends sixteen at once."""
NO_FOLDER = (
    "Base maps belong to a site: start the station with a site's folder (--site) that has a folder "
    "maps"
)
EMPTY = (
    "No map in the site's folder maps: put MBTiles, PMTiles or GeoTIFF files there, or fetch one "
    "with recon maps fetch"
)
EMPTY_INFO = MapInfo("", "", "", 0, 0, 256, (0.0, 0.0, 0.0, 0.0))


class SiteMaps:
    """Implements the API's `MapFolder` for the folder of a site."""

    def __init__(
        self, folder: Path, site: Callable[[], Site], reader: Callable[[Path], MapReader]
    ) -> None:
        """Take the folder with the maps; `site` returns the site that is in force."""
        self._folder = folder
        self._site = site
        self._tiles, self._facts = reader(folder), reader(folder)
        self._tile_thread = ThreadPoolExecutor(1, thread_name_prefix="map-tiles")
        self._facts_thread = ThreadPoolExecutor(1, thread_name_prefix="map-facts")
        self._known: dict[tuple[str, str, MapArea | None], KnownMap] = {}
        self._turn = asyncio.Lock()
        self._waiting = 0

    def close(self) -> None:
        """End both readers; what waits is dropped."""
        threads = (self._tile_thread, self._facts_thread)
        for thread in threads:
            thread.shutdown(wait=False, cancel_futures=True)
        for reader in (self._tiles, self._facts):
            reader.close()
        for thread in threads:
            thread.shutdown()

    async def maps(self) -> schema.BaseMapsView:
        """Return the maps with their coverage of the boundary that is in force."""
        area = site_area(self._site())
        loop = asyncio.get_running_loop()
        found = await loop.run_in_executor(self._facts_thread, self._read_facts, area)
        return schema.BaseMapsView(
            maps=[base_map_view(each) for each in found], note=None if found else EMPTY
        )

    async def tile(
        self, name: str, zoom: int, col: int, row: int, is_gone: IsGone
    ) -> TileRead | None:
        """Return a tile; raises `MapsBusyError` and `MapFileError`."""
        if self._waiting >= MOST_WAITING:
            raise MapsBusyError("Too many tiles of base maps are asked for; try again in a second")
        self._waiting += 1
        try:
            async with self._turn:
                return None if await is_gone() else await self._read_tile(name, zoom, col, row)
        finally:
            self._waiting -= 1

    async def _read_tile(self, name: str, zoom: int, col: int, row: int) -> TileRead | None:
        read = partial(self._tiles.tile, name, zoom, col, row)
        try:
            loop = asyncio.get_running_loop()
            tile, version = await loop.run_in_executor(self._tile_thread, read)
        except BaseMapError as problem:
            raise MapFileError(f"{name}: {problem}") from problem
        return None if tile is None else TileRead(tile.media_type, tile.data, version)

    def _read_facts(self, area: MapArea | None) -> list[KnownMap]:
        """Return the facts of each map, read anew where the file or the area has changed."""
        keys = {
            name: (name, version, area) for name, (_, version) in map_versions(self._folder).items()
        }
        known = {
            key: self._known.get(key) or self._facts.facts(name, area) for name, key in keys.items()
        }
        self._facts.rest()
        self._known = known
        return list(known.values())


def maps_of(folder: Path | None, site: Callable[[], Site], missing: str = NO_FOLDER) -> MapFolder:
    """Return the maps of a site's folder; `missing` is shown in place of them."""
    own = own_folder(folder)
    return NoMaps(missing) if own is None else SiteMaps(own / MAPS_FOLDER, site, MapReader)


def site_area(site: Site) -> MapArea | None:
    """Return the ground that a site's map should show; None for a site without an origin."""
    if site.frame is None:
        return None
    return area_around(site.frame, site.layers.boundary, site.limits.max_distance_from_home_m)


def base_map_view(facts: KnownMap) -> schema.BaseMapView:
    """Return a map as the API's message."""
    info = facts.info or EMPTY_INFO
    west_deg, south_deg, east_deg, north_deg = info.bounds_deg
    covers = finest_covered(facts.coverage)
    return schema.BaseMapView(
        name=facts.name,
        title=info.title or facts.name,
        kind=info.kind,
        size_bytes=facts.size_bytes,
        version=facts.version,
        attribution=info.attribution,
        min_zoom=info.min_zoom,
        max_zoom=info.max_zoom,
        tile_px=info.tile_px,
        west_deg=west_deg,
        south_deg=south_deg,
        east_deg=east_deg,
        north_deg=north_deg,
        covers=None if covers is None else _coverage_view(covers),
        coverage=[_coverage_view(level) for level in facts.coverage],
        problem=facts.problem or None,
    )


def _coverage_view(level: ZoomCoverage) -> schema.MapCoverageView:
    return schema.MapCoverageView(
        zoom=level.zoom, share=level.share, metres_per_pixel=level.metres_per_pixel
    )
