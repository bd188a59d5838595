"""Base maps by the API: a real folder behind the routes, and requests for what is not there."""

import asyncio
import os
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.api.client import Client
from tests.api.fake_station import FakeStation
from tests.basemap.made_maps import FIELD, colour_in, colour_of, keys_over, write_mbtiles

from recon.api.map_routes import MapFolder, MapsBusyError
from recon.api.security import Access, AccessCheck
from recon.basemap.map_reader import MapReader
from recon.model.airspace import FlightLimits
from recon.model.geo import GeoPoint, LocalFrame
from recon.site import Site, demo_site_folder
from recon.station.api_views.app import create_app
from recon.station.host import base_maps
from recon.station.host.base_maps import NO_FOLDER, SiteMaps, maps_of

SITE = Site(
    "field",
    LocalFrame(GeoPoint(41.9015, -93.602, 275.0)),
    limits=FlightLimits(max_distance_from_home_m=50.0),
)
KEYS = keys_over(FIELD, range(15, 19))


def application(maps: MapFolder | None) -> Client:
    app = create_app(FakeStation(), None, "1.2.3", maps=maps)
    return Client(AccessCheck(app, Access()))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "maps"
    made.mkdir()
    write_mbtiles(made / "ortho 2025.mbtiles", KEYS, {"attribution": "© survey"})
    (made / "broken.mbtiles").write_bytes(b"no map")
    return made


@pytest.fixture
def maps(folder: Path) -> Iterator[SiteMaps]:
    made = SiteMaps(folder, lambda: SITE, MapReader)
    yield made
    made.close()


def test_maps_are_listed_with_what_they_cover_or_why_they_are_refused(maps: SiteMaps) -> None:
    listed = application(maps).get("/api/maps").json()
    assert listed["note"] is None
    broken, good = listed["maps"]
    assert broken["name"] == "broken.mbtiles"
    assert broken["problem"].startswith("expected an MBTiles file")
    assert (good["name"], good["problem"]) == ("ortho 2025.mbtiles", None)
    assert (good["min_zoom"], good["max_zoom"], good["tile_px"]) == (15, 18, 256)
    assert (good["title"], good["attribution"]) == ("ortho 2025", "© survey")
    assert good["covers"]["zoom"] == 18
    assert good["covers"]["share"] == pytest.approx(1.0)
    assert [level["zoom"] for level in good["coverage"]] == [15, 16, 17, 18]


def test_a_tile_is_kept_by_the_browser_as_long_as_its_map_is_the_same(maps: SiteMaps) -> None:
    client = application(maps)
    version = client.get("/api/maps").json()["maps"][1]["version"]
    zoom, col, row = KEYS[-1]
    path = f"/api/maps/ortho%202025.mbtiles/{zoom}/{col}/{row}"
    kept = client.get(f"{path}?v={version}")
    assert (kept.status_code, kept.headers["content-type"]) == (200, "image/png")
    assert colour_in(kept.content) == colour_of(zoom, col, row)
    assert "immutable" in kept.headers["cache-control"]
    other = client.get(f"{path}?v=old")
    assert "no-cache" in other.headers["cache-control"]
    same = client.get(path, headers={"If-None-Match": other.headers["etag"]})
    assert (same.status_code, same.content) == (304, b"")


@pytest.mark.parametrize(
    ("path", "status", "sentence"),
    [
        ("ortho%202025.mbtiles/18/0/0", 404, "No tile 18/0/0"),
        ("ortho%202025.mbtiles/3/0/0", 404, "No tile"),
        ("none.mbtiles/15/0/0", 404, "No tile"),
        ("..%2Fmaps%2Fortho%202025.mbtiles/15/0/0", 404, "Not Found"),
        ("../15/0/0", 404, ""),
        ("%2e%2e/15/0/0", 404, "No tile"),
        ("broken.mbtiles/15/0/0", 422, "broken.mbtiles: expected an MBTiles file"),
        ("ortho%202025.mbtiles/25/0/0", 422, "zoom"),
        ("ortho%202025.mbtiles/15/-1/0", 422, "col"),
        ("ortho%202025.mbtiles/15/0/99999999999999", 422, "row"),
        ("x" * 300 + "/15/0/0", 422, "name"),
    ],
)
def test_what_is_not_there_is_refused_with_a_sentence(
    maps: SiteMaps, path: str, status: int, sentence: str
) -> None:
    answer = application(maps).get(f"/api/maps/{path}")
    assert answer.status_code == status
    assert sentence in answer.json()["error"]


def test_facts_are_read_again_when_the_file_or_the_boundary_changes(folder: Path) -> None:
    site = SITE
    asked = []

    class Counting(MapReader):
        def facts(self, name, area):
            asked.append(name)
            return super().facts(name, area)

    maps = SiteMaps(folder, lambda: site, Counting)
    client = application(maps)
    try:
        client.get("/api/maps")
        client.get("/api/maps")
        assert asked == ["broken.mbtiles", "ortho 2025.mbtiles"]
        os.utime(folder / "broken.mbtiles", ns=(1, 1))
        client.get("/api/maps")
        assert asked[2:] == ["broken.mbtiles"]
        site = Site("far", SITE.frame, limits=FlightLimits(max_distance_from_home_m=5_000.0))
        covers = client.get("/api/maps").json()["maps"][1]["covers"]
        assert len(asked) == 5
        assert covers["share"] < 0.5
    finally:
        maps.close()


def test_a_station_without_maps_states_why(tmp_path: Path) -> None:
    assert application(None).get("/api/maps").json()["maps"] == []
    assert application(maps_of(None, lambda: SITE)).get("/api/maps").json()["note"] == NO_FOLDER
    assert "note" in application(maps_of(demo_site_folder(), lambda: SITE)).get("/api/maps").json()
    own = maps_of(tmp_path, lambda: SITE)
    assert isinstance(own, SiteMaps)
    try:
        assert "put MBTiles" in application(own).get("/api/maps").json()["note"]
    finally:
        own.close()
    assert application(None).get("/api/maps/a.mbtiles/15/0/0").status_code == 404


async def stays() -> bool:
    return False


async def has_gone() -> bool:
    return True


def test_nothing_is_read_for_a_client_that_has_gone(folder: Path) -> None:
    asked = []

    class Counting(MapReader):
        def tile(self, *key):
            asked.append(key)
            return super().tile(*key)

    maps = SiteMaps(folder, lambda: SITE, Counting)
    try:
        assert asyncio.run(maps.tile("ortho 2025.mbtiles", *KEYS[0], has_gone)) is None
        assert asked == []
        assert asyncio.run(maps.tile("ortho 2025.mbtiles", *KEYS[0], stays)) is not None
    finally:
        maps.close()


SLOW = """
import sys, json
for line in sys.stdin:
    open(sys.argv[1] + "/asked", "a").write("x")
    while not __import__("os").path.exists(sys.argv[1] + "/go"):
        __import__("time").sleep(0.01)
    print(json.dumps({"missing": True, "length": 0}), flush=True)
"""


def test_a_slow_map_holds_up_neither_the_loop_nor_more_than_its_places(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(base_maps, "MOST_WAITING", 3)
    maps = SiteMaps(tmp_path, lambda: SITE, lambda f: MapReader(f, (sys.executable, "-c", SLOW)))

    async def asked() -> None:
        waiting = [asyncio.create_task(maps.tile("a.mbtiles", 15, 0, 0, stays)) for _ in range(3)]
        while not (tmp_path / "asked").exists():
            await asyncio.sleep(0.01)
        with pytest.raises(MapsBusyError, match="try again"):
            await maps.tile("a.mbtiles", 15, 0, 0, stays)
        # The loop has run all the while; the answers come when the map does.
        assert not any(task.done() for task in waiting)
        (tmp_path / "go").touch()
        assert await asyncio.gather(*waiting) == [None, None, None]

    try:
        asyncio.run(asked())
    finally:
        maps.close()
    assert not [t for t in threading.enumerate() if t.name.startswith("map-") and t.is_alive()]
