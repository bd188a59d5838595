"""Clients that come and go: consoles, readers of the base map, MAVLink programs at the gateway.

Each is a thread that a failing station does not end: while nothing answers, it tries again. Their
waits are drawn from a seed.
"""

import http.client
import random
import threading
import time
from collections import Counter
from contextlib import suppress

from benches.station.tile_readers import NAME, PIXEL_DEG, SIDE_PX, ZOOMS
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from recon.basemap.web_mercator import MapArea
from studies.soak.field import ORIGIN
from studies.soak.world import World

STAYS_S = (5.0, 60.0)
AWAY_S = (0.5, 10.0)
TILES_AT_ONCE = 40
"""About what a console asks for after its map was moved."""
WAITS_S = 10.0


class Clients:
    """So many clients of each kind, until they are ended; `seen` counts what they were given."""

    def __init__(self, world: World, consoles: int = 4, programs: int = 2, seed: int = 1) -> None:
        self.seen: Counter[str] = Counter()
        self._world = world
        self._is_over = threading.Event()
        kinds = [self._console] * consoles + [self._program] * programs + [self._tiles]
        self._threads = [
            threading.Thread(target=self._again_and_again, args=(kind, random.Random(seed + n)))
            for n, kind in enumerate(kinds)
        ]
        for thread in self._threads:
            thread.start()

    def end(self) -> None:
        """End all."""
        self._is_over.set()
        for thread in self._threads:
            thread.join()

    def _again_and_again(self, visit, rng: random.Random) -> None:
        while not self._is_over.is_set():
            try:
                visit(time.monotonic() + rng.uniform(*STAYS_S), rng)
            except (OSError, WebSocketException, http.client.HTTPException):
                self.seen["connections lost"] += 1
            self._is_over.wait(rng.uniform(*AWAY_S))

    def _stays(self, until_s: float) -> bool:
        return not self._is_over.is_set() and time.monotonic() < until_s

    def _console(self, until_s: float, rng: random.Random) -> None:
        """Read states as a console does; every other one asks for whole states."""
        query = "?changes=2" if rng.random() < 0.5 else ""
        address = f"ws://127.0.0.1:{self._world.http_port}/api/stream{query}"
        with connect(address, max_size=None, compression=None) as stream:
            while self._stays(until_s):
                with suppress(TimeoutError):
                    stream.recv(1.0)
                    self.seen["states"] += 1

    def _program(self, until_s: float, rng: random.Random) -> None:
        """Read the vehicles as a MAVLink program does; its own heartbeat keeps it connected."""
        from pymavlink import mavutil

        place = f"tcp:127.0.0.1:{self._world.gateway_port}"
        link = mavutil.mavlink_connection(place, source_system=rng.randint(200, 254), retries=1)
        try:
            next_s = 0.0
            while self._stays(until_s):
                if time.monotonic() >= next_s:
                    next_s = time.monotonic() + 1.0
                    link.mav.heartbeat_send(6, 8, 0, 0, 0)
                if link.recv_match(blocking=True, timeout=0.5) is not None:
                    self.seen["MAVLink messages"] += 1
        finally:
            link.close()

    def _tiles(self, until_s: float, rng: random.Random) -> None:
        """Ask for the tiles around one place after another."""
        connection = http.client.HTTPConnection("127.0.0.1", self._world.http_port, timeout=WAITS_S)
        try:
            while self._stays(until_s):
                for zoom, col, row in some_tiles(rng):
                    connection.request("GET", f"/api/maps/{NAME}/{zoom}/{col}/{row}")
                    connection.getresponse().read()
                    self.seen["tiles"] += 1
                self._is_over.wait(rng.uniform(1.0, 5.0))
        finally:
            connection.close()


def some_tiles(rng: random.Random) -> list[tuple[int, int, int]]:
    """Return zoom, column and row of tiles beside each other, at one of the map's zooms."""
    half_deg = SIDE_PX / 4 * PIXEL_DEG
    west, east = ORIGIN.longitude_deg - half_deg, ORIGIN.longitude_deg + half_deg
    south, north = ORIGIN.latitude_deg - half_deg, ORIGIN.latitude_deg + half_deg
    area = MapArea(((west, south), (east, south), (east, north), (west, north)))
    tiles = area.tiles(zoom := rng.choice(ZOOMS))
    assert tiles is not None  # the map has tiles at each of its zooms
    places = list(zip(tiles.cols.tolist(), tiles.rows.tolist(), strict=True))
    first = rng.randrange(len(places))
    return [(zoom, col, row) for col, row in places[first : first + TILES_AT_ONCE]]
