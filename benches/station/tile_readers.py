"""Readers of a base map beside a measurement: each asks for tiles without a pause; consoles do not.

The map is a GeoTIFF with overviews, which costs the most to read.
"""

import http.client
import threading
import time
from pathlib import Path

import numpy as np
import rasterio
from rasterio.enums import Resampling
from rasterio.transform import Affine
from rasterio.windows import Window

from recon.basemap.web_mercator import MapArea
from recon.model.geo import GeoPoint
from recon.site.reading import MAPS_FOLDER

SIDE_PX = 12_000
PIXEL_DEG = 5e-7
"""Of 5 cm: the side is 660 m north."""
STRIPE_PX = 512
NAME = "orthophoto.tif"
ZOOMS = (16, 18, 20)
WAITS_S = 30.0


def write_orthophoto(site: Path, middle: GeoPoint) -> None:
    """Write a map of 144 megapixels around a place into a site's folder."""
    half_deg = SIDE_PX / 2 * PIXEL_DEG
    north_west = middle.longitude_deg - half_deg, middle.latitude_deg + half_deg
    transform = Affine(PIXEL_DEG, 0.0, north_west[0], 0.0, -PIXEL_DEG, north_west[1])
    path = site / MAPS_FOLDER / NAME
    path.parent.mkdir()
    rng = np.random.default_rng(1)
    with rasterio.open(
        path, "w", driver="GTiff", count=3, width=SIDE_PX, height=SIDE_PX, dtype="uint8",
        crs="EPSG:4326", transform=transform, tiled=True, photometric="RGB", compress="deflate",
        zlevel=1,
    ) as file:  # fmt: skip
        for first in range(0, SIDE_PX, STRIPE_PX):
            rows = min(STRIPE_PX, SIDE_PX - first)
            grain = rng.integers(0, 16, (3, rows, SIDE_PX), dtype=np.uint8)
            window = Window(0, first, SIDE_PX, rows)
            file.write(grain + np.uint8(100), window=window)
        file.build_overviews([2, 4, 8, 16], Resampling.nearest)


class TileReaders:
    """So many threads that read tiles until they are ended."""

    def __init__(self, http_port: int, middle: GeoPoint, count: int) -> None:
        """Begin at once."""
        half_deg = SIDE_PX / 4 * PIXEL_DEG
        west, east = middle.longitude_deg - half_deg, middle.longitude_deg + half_deg
        south, north = middle.latitude_deg - half_deg, middle.latitude_deg + half_deg
        self._area = MapArea(((west, south), (east, south), (east, north), (west, north)))
        self._port = http_port
        self._is_over = threading.Event()
        self._took_ms: list[float] = []
        self._began_s = time.monotonic()
        self._threads = [threading.Thread(target=self._read, args=(n,)) for n in range(count)]
        for thread in self._threads:
            thread.start()

    def end(self) -> tuple[float, list[float]]:
        """End all; return tiles a second, and how long each took, ms."""
        passed_s = time.monotonic() - self._began_s
        self._is_over.set()
        for thread in self._threads:
            thread.join()
        return len(self._took_ms) / passed_s, self._took_ms

    def _read(self, number: int) -> None:
        keys = [
            (zoom, col, row)
            for zoom in ZOOMS
            if (tiles := self._area.tiles(zoom)) is not None
            for col, row in zip(tiles.cols.tolist(), tiles.rows.tolist(), strict=True)
        ]
        connection = http.client.HTTPConnection("127.0.0.1", self._port, timeout=WAITS_S)
        at = number * len(keys) // max(1, len(self._threads))
        while not self._is_over.is_set():
            at = (at + 1) % len(keys)
            zoom, col, row = keys[at]
            asked_s = time.monotonic()
            connection.request("GET", f"/api/maps/{NAME}/{zoom}/{col}/{row}")
            answer = connection.getresponse()
            answer.read()
            if answer.status != http.client.OK:
                raise RuntimeError(f"expected tile {keys[at]}, got status {answer.status}")
            self._took_ms.append(1e3 * (time.monotonic() - asked_s))
        connection.close()
