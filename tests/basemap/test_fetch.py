"""Tiles fetched from a server on loopback: polite, resumed, and unharmed by a hostile one."""

import asyncio
import gzip
import re
import sqlite3
import time
from contextlib import closing, suppress
from functools import lru_cache
from http.server import BaseHTTPRequestHandler
from pathlib import Path

import pytest
from tests.basemap.made_maps import FIELD, Key, colour_in, colour_of, keys_over, picture
from tests.basemap.tile_server import Answer, tile, tile_server
from tests.fetching.file_server import send

from recon.basemap import fetch as fetching
from recon.basemap.coverage import FULL
from recon.basemap.fetch import AT_ONCE, MOST_FAILURES, FetchCount, TileServer, needed_tiles
from recon.basemap.map_file import LARGEST_TILE_BYTES, BaseMapError
from recon.basemap.map_reader import MapReader
from recon.basemap.web_mercator import MapArea

ZOOMS = range(14, 18)
KEYS = keys_over(FIELD, ZOOMS)


def fetched(path: Path, template: str, keys: list[Key] = KEYS, **more) -> FetchCount:
    server = TileServer(template, "© tiles")
    return asyncio.run(fetching.fetch(server, keys, FIELD, path, pause_s=0.0, **more))


def in_file(path: Path) -> dict[Key, bytes]:
    with closing(sqlite3.connect(path)) as database:
        rows = database.execute("SELECT * FROM tiles").fetchall()
    return {(z, x, 2**z - 1 - y): data for z, x, y, data in rows}


def test_what_is_fetched_is_a_map_that_covers_the_site(tmp_path: Path) -> None:
    path, seen = tmp_path / "maps" / "a.mbtiles", []
    with tile_server() as server:
        count = fetched(path, server.template, progress=lambda c: seen.append(c.done))
    assert (count.fetched, count.failed, count.missing) == (len(KEYS), 0, 0)
    assert (seen[0], seen[-1]) == (0, len(KEYS))
    assert set(server.asked.values()) == {1}
    assert server.most_at_once <= AT_ONCE
    (agent,) = server.agents
    assert re.match(r"Recon/\d", agent)
    with closing(MapReader(path.parent)) as reader:
        known = reader.facts("a.mbtiles", FIELD)
        assert known.info is not None
        assert (known.info.attribution, known.info.title) == ("© tiles", "a")
        assert known.info.bounds_deg == pytest.approx(FIELD.bounds_deg, abs=1e-5)
        assert [level.zoom for level in known.coverage] == list(ZOOMS)
        assert min(level.share for level in known.coverage) >= FULL
        for key in KEYS:
            read, _ = reader.tile("a.mbtiles", *key)
            assert read is not None
            assert colour_in(read.data) == colour_of(*key)


def test_rows_may_count_from_the_south(tmp_path: Path) -> None:
    with tile_server() as server:
        fetched(tmp_path / "a.mbtiles", server.template.replace("{y}", "{-y}"), KEYS[-1:])
    zoom, col, row = KEYS[-1]
    assert list(server.asked) == [(zoom, col, 2**zoom - 1 - row)]


def test_a_fetch_goes_on_where_it_stopped(tmp_path: Path) -> None:
    def few(handler: BaseHTTPRequestHandler, key: Key) -> None:
        if len(server.asked) > 5:
            send(handler, b"", 403)
        else:
            tile(handler, key)

    path = tmp_path / "a.mbtiles"
    with tile_server(few) as server:
        with pytest.raises(BaseMapError, match="status 403"):
            fetched(path, server.template)
        kept = in_file(path)
        assert 3 <= len(kept) <= 5
        server.answer, before = tile, server.asked.copy()
        count = fetched(path, server.template)
        assert (count.present, count.fetched) == (len(kept), len(KEYS) - len(kept))
        assert all(server.asked[key] == before[key] for key in kept)
        assert fetched(path, server.template).fetched == 0
    assert in_file(path).keys() == set(KEYS)


def test_a_busy_server_is_asked_again_and_a_missing_tile_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pauses = []

    async def pause(seconds: float) -> None:
        pauses.append(seconds)

    def answer(handler: BaseHTTPRequestHandler, key: Key) -> None:
        if key == KEYS[0]:
            send(handler, b"", 404)
        elif key == KEYS[1] and server.asked[key] == 1:
            send(handler, b"", 429, retry_after="7")
        elif key == KEYS[2] and server.asked[key] == 1:
            send(handler, b"", 503, retry_after="999999")
        else:
            tile(handler, key)

    monkeypatch.setattr(fetching.asyncio, "sleep", pause)
    with tile_server(answer) as server:
        count = fetched(tmp_path / "a.mbtiles", server.template)
    assert (count.missing, count.failed, count.fetched) == (1, 0, len(KEYS) - 1)
    assert server.asked[KEYS[0]] == 1
    assert sorted(pauses) == [0.0, 7.0]


def test_a_tile_that_fails_three_times_is_counted_and_the_others_are_fetched(
    tmp_path: Path,
) -> None:
    def answer(handler: BaseHTTPRequestHandler, key: Key) -> None:
        send(handler, b"", 500) if key == KEYS[3] else tile(handler, key)

    with tile_server(answer) as server:
        count = fetched(tmp_path / "a.mbtiles", server.template)
    assert (count.failed, count.problems) == (1, {"status 500": 1})
    assert server.asked[KEYS[3]] == 3
    assert count.done == count.needed


def endless(handler: BaseHTTPRequestHandler, _: Key) -> None:
    handler.send_response(200)
    handler.end_headers()
    with suppress(OSError):
        while True:
            handler.wfile.write(b"\x89PNG" * 10_000)


def dripping(handler: BaseHTTPRequestHandler, _: Key) -> None:
    handler.send_response(200)
    handler.end_headers()
    with suppress(OSError):
        for _step in range(200):
            handler.wfile.write(b"x")
            time.sleep(0.05)


def page(handler: BaseHTTPRequestHandler, _: Key) -> None:
    send(handler, b"<html>log in</html>", content_type="image/png")


def vector(handler: BaseHTTPRequestHandler, _: Key) -> None:
    send(handler, b"\x1f\x8b\x08" + bytes(40), content_type="application/x-protobuf")


@lru_cache
def giant_picture() -> bytes:
    return picture((1, 2, 3), 10_000)


@lru_cache
def packed_zeros() -> bytes:
    return gzip.compress(bytes(50_000_000))


def giant(handler: BaseHTTPRequestHandler, _: Key) -> None:
    send(handler, giant_picture(), content_type="image/png")


def lying_length(handler: BaseHTTPRequestHandler, _: Key) -> None:
    handler.send_response(200)
    handler.send_header("content-length", "1000000")
    handler.end_headers()
    handler.wfile.write(b"short")
    handler.close_connection = True


def bomb(handler: BaseHTTPRequestHandler, _: Key) -> None:
    send(handler, packed_zeros(), content_encoding="gzip")


def no_http(handler: BaseHTTPRequestHandler, _: Key) -> None:
    handler.wfile.write(b"\0" * 100)
    handler.close_connection = True


@pytest.mark.parametrize(
    ("answer", "sentence"),
    [
        (endless, f"at most {LARGEST_TILE_BYTES} bytes, got more"),
        (dripping, "no answer within 0.3 s"),
        (page, "expected tiles as PNG, JPEG or WebP"),
        (vector, "got vector tiles"),
        pytest.param(giant, "got 10000 x 10000", marks=pytest.mark.flight),
        (bomb, "got vector tiles"),
        (lying_length, "failures in a row"),
        (no_http, "failures in a row"),
    ],
)
def test_a_hostile_server_leaves_a_sentence_and_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: Answer, sentence: str
) -> None:
    if answer is dripping:
        monkeypatch.setattr(fetching, "TILE_WITHIN_S", 0.3)
        monkeypatch.setattr(fetching, "MOST_FAILURES", 1)
    path = tmp_path / "a.mbtiles"
    with (
        tile_server(answer) as server,
        pytest.raises(BaseMapError, match=re.escape(sentence)) as found,
    ):
        fetched(path, server.template)
    assert str(found.value).startswith("127.0.0.1: expected tiles")
    assert len(server.asked) <= MOST_FAILURES + AT_ONCE
    assert not path.exists()


def test_a_redirect_is_not_followed(tmp_path: Path) -> None:
    with tile_server() as other:

        def redirect(handler: BaseHTTPRequestHandler, key: Key) -> None:
            zoom, col, row = key
            place = other.template.format(z=zoom, x=col, y=row)
            send(handler, b"", 302, location=place)

        with tile_server(redirect) as server, pytest.raises(BaseMapError, match="got a redirect"):
            fetched(tmp_path / "a.mbtiles", server.template)
    assert not other.asked


def test_nothing_listens(tmp_path: Path) -> None:
    with tile_server() as server:
        template = server.template
    with pytest.raises(BaseMapError, match="in a row"):
        fetched(tmp_path / "a.mbtiles", template)


def test_a_file_of_another_source_is_not_mixed_with_this_one(tmp_path: Path) -> None:
    path = tmp_path / "a.mbtiles"
    with tile_server() as server:
        fetched(path, server.template, KEYS[:1])
        with pytest.raises(BaseMapError, match="another one; choose another --name"):
            fetched(path, server.template + "?key=secret", KEYS[:1])
        path.write_bytes(b"no database")
        with pytest.raises(BaseMapError, match="cannot be written"):
            fetched(path, server.template, KEYS[:1])


def test_the_key_in_an_address_is_neither_stored_nor_shown(tmp_path: Path) -> None:
    path = tmp_path / "a.mbtiles"
    with tile_server() as server:
        fetched(path, server.template + "?key=hunter2", KEYS[:1])
        server.answer = lambda handler, _: send(handler, b"", 401)
        with pytest.raises(BaseMapError) as found:
            fetched(path, server.template + "?key=hunter2")
    assert "hunter2" not in str(found.value)
    assert b"hunter2" not in path.read_bytes()


@pytest.mark.parametrize(
    "template",
    [
        "",
        "ftp://host/{z}/{x}/{y}",
        "http:///{z}/{x}/{y}",
        "http://host/{z}/{x}",
        "http://host/{z}/{x}/{y}/{y}",
        "http://host/{z}/{x}/{y}/{key}",
        "http://host/{z}/{x}/{y}\r\nHost: other",
        "file:///etc/{z}/{x}/{y}",
        "http://host/ {z}/{x}/{y}",
    ],
)
def test_an_address_that_is_none_is_refused(template: str) -> None:
    with pytest.raises(BaseMapError, match="expected the address of a tile server"):
        TileServer(template)


def test_too_many_tiles_are_refused_with_the_zoom_that_fits() -> None:
    fits = needed_tiles(FIELD, range(12, 18), most=100)
    assert fits == keys_over(FIELD, range(12, 18))
    with pytest.raises(BaseMapError, match=r"at most 100 tiles.*fetch zoom 12-1\d, or allow"):
        needed_tiles(FIELD, range(12, 22), most=100)
    world = MapArea(((-180.0, -80.0), (180.0, -80.0), (180.0, 80.0), (-180.0, 80.0)))
    with pytest.raises(BaseMapError, match="begin coarser"):
        needed_tiles(world, range(18, 24))
    for zooms in (range(5, 3), range(20, 30)):
        with pytest.raises(BaseMapError, match="expected zoom levels"):
            needed_tiles(FIELD, zooms)
