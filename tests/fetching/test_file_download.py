"""Large files fetched from a server on loopback: resumed, whole or not at all, bounded."""

import asyncio
from http.server import BaseHTTPRequestHandler
from pathlib import Path

import pytest
from tests.fetching.file_server import Answer, RunningFileServer, file_server, send, whole

from recon.fetching import file_download
from recon.fetching.file_download import download
from recon.fetching.polite_client import AskedServer, AskFailedError, FetchError, polite_client
from recon.fetching.source_address import local_path, shown_source

DATA = bytes(range(256)) * 1_000
MOST = 300_000


def fetched(server: RunningFileServer, path: Path, name: str = "/a.tif") -> bool:
    async def run() -> bool:
        async with polite_client("image/tiff") as client:
            asked = AskedServer("127.0.0.1", "tiles")
            return await download(client, server.address + name, asked, path, MOST, pause_s=0.0)

    return asyncio.run(run())


def half(handler: BaseHTTPRequestHandler, data: bytes) -> None:
    """Break off in the middle, once a whole length was promised."""
    handler.send_response(200)
    handler.send_header("content-length", str(len(data)))
    handler.send_header("etag", f'"{len(data)}"')
    handler.end_headers()
    handler.wfile.write(data[: len(data) // 2])
    handler.close_connection = True


def test_a_file_comes_whole_and_is_not_asked_for_again(tmp_path: Path) -> None:
    path = tmp_path / "a.tif"
    with file_server({"/a.tif": DATA}) as server:
        assert fetched(server, path)
        assert fetched(server, path)
        assert not fetched(server, tmp_path / "b.tif", "/b.tif")
    assert path.read_bytes() == DATA
    assert server.asked == ["/a.tif", "/b.tif"]
    assert [each.name for each in tmp_path.iterdir()] == ["a.tif"]


def test_an_interrupted_file_goes_on_at_the_byte_where_it_stopped(tmp_path: Path) -> None:
    path = tmp_path / "a.tif"
    with file_server({"/a.tif": DATA}, half) as server:
        with pytest.raises(AskFailedError):
            fetched(server, path)
        assert not path.exists()
        server.answer = whole
        assert fetched(server, path)
    assert server.ranges[-1] == f"bytes={len(DATA) // 2}-"
    assert path.read_bytes() == DATA


def test_a_file_that_changed_meanwhile_begins_again(tmp_path: Path) -> None:
    path, other = tmp_path / "a.tif", DATA[::-1] + b"more"
    with file_server({"/a.tif": DATA}, half) as server:
        with pytest.raises(AskFailedError):
            fetched(server, path)
        server.files, server.answer = {"/a.tif": other}, whole
        assert fetched(server, path)
    assert path.read_bytes() == other


def endless(handler: BaseHTTPRequestHandler, _: bytes) -> None:
    handler.send_response(200)
    handler.end_headers()
    while True:
        handler.wfile.write(bytes(50_000))


def claims_much(handler: BaseHTTPRequestHandler, data: bytes) -> None:
    send(handler, data, content_length="9" * 14)


def other_part(handler: BaseHTTPRequestHandler, data: bytes) -> None:
    send(handler, data, 206, content_range=f"bytes 7-{len(data)}/{len(data)}")


def drips(handler: BaseHTTPRequestHandler, _: bytes) -> None:
    handler.send_response(200)
    handler.end_headers()
    while True:
        handler.wfile.write(b"x")


@pytest.mark.parametrize(
    ("answer", "sentence"),
    [
        (endless, f"expected a file of at most {MOST} bytes, got more"),
        (claims_much, f"expected a file of at most {MOST} bytes, got more"),
        (other_part, "got another part of it"),
        (drips, "less than"),
        (lambda handler, _: send(handler, b"", 416), "status 416"),
    ],
)
def test_a_hostile_server_leaves_a_sentence_and_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: Answer, sentence: str
) -> None:
    if answer is drips:
        monkeypatch.setattr(file_download, "SLOW_S", 0.01)
        monkeypatch.setattr(file_download, "LEAST_BYTES", 10**9)
    path = tmp_path / "a.tif"
    with (
        file_server({"/a.tif": DATA}, answer) as server,
        pytest.raises(AskFailedError, match=sentence),
    ):
        fetched(server, path)
    assert not path.exists()


def test_a_refusal_and_a_redirect_end_it(tmp_path: Path) -> None:
    with file_server({"/a.tif": DATA}, lambda handler, _: send(handler, b"", 403)) as server:
        with pytest.raises(FetchError, match="status 403"):
            fetched(server, tmp_path / "a.tif")
        server.answer = lambda handler, _: send(handler, b"", 302, location="http://elsewhere/")
        with pytest.raises(FetchError, match="got a redirect to 'http://elsewhere/'"):
            fetched(server, tmp_path / "a.tif")
    assert len(server.asked) == 2


def test_a_source_is_a_server_a_file_url_or_a_path() -> None:
    assert local_path("https://host/a?key=1") is None
    assert shown_source("https://user:word@host/a?key=hunter2") == "host"
    assert local_path("file:///srv/a%20b.tif") == Path("/srv/a b.tif")
    assert local_path("tiles/N52.tif") == Path("tiles/N52.tif")
    for wrong in ("ftp://host/a", "http:///a", "file://other/a", "https://host/a b", "http://[x/"):
        with pytest.raises(FetchError, match="expected a path, or an address"):
            local_path(wrong)
