"""The console's files: compressed and cached, and the same bytes for every client."""

from pathlib import Path

import pytest
from starlette.applications import Starlette
from starlette.routing import Mount
from tests.api.client import Client

from recon.api.console_files import ASK_AGAIN, FOR_EVER, ConsoleFiles

SCRIPT = "console.log('station');\n" * 2_000


@pytest.fixture
def client(tmp_path: Path) -> Client:
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("<!doctype html>" + "x" * 2_000)
    (tmp_path / "assets" / "index-Cc8pS0IZ.js").write_text(SCRIPT)
    (tmp_path / "assets" / "picture.png").write_bytes(bytes(4_000))
    files = ConsoleFiles(directory=tmp_path, html=True)
    return Client(Starlette(routes=[Mount("/", files)]))


def test_text_is_compressed_for_who_takes_it(client: Client) -> None:
    path = "/assets/index-Cc8pS0IZ.js"
    answer = client.get(path, headers={"Accept-Encoding": "gzip, br"})
    assert answer.headers["content-encoding"] == "gzip"
    assert answer.text == SCRIPT
    assert int(answer.headers["content-length"]) < len(SCRIPT) / 20
    plain = client.get(path, headers={"Accept-Encoding": "identity"})
    assert "content-encoding" not in plain.headers
    assert plain.text == SCRIPT
    assert plain.headers["vary"] == "Accept-Encoding"


def test_hashed_names_are_cached_and_the_page_is_asked_for_again(client: Client) -> None:
    assert client.get("/assets/index-Cc8pS0IZ.js").headers["cache-control"] == FOR_EVER
    assert client.get("/").headers["cache-control"] == ASK_AGAIN
    assert client.get("/").headers["content-type"].startswith("text/html")


def test_an_unchanged_file_is_not_sent_again(client: Client) -> None:
    first = client.get("/")
    again = client.get("/", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


def test_a_changed_file_is_sent_as_it_is_now(client: Client, tmp_path: Path) -> None:
    before = client.get("/").text
    (tmp_path / "index.html").write_text("<!doctype html>" + "y" * 3_000)
    assert client.get("/").text != before


def test_pictures_ranges_and_absent_files_are_left_alone(client: Client) -> None:
    assert "content-encoding" not in client.get("/assets/picture.png").headers
    part = client.get("/assets/index-Cc8pS0IZ.js", headers={"Range": "bytes=0-9"})
    assert (part.status_code, part.text) == (206, SCRIPT[:10])
    assert client.get("/absent.js").status_code == 404


def test_what_makes_it_installable_has_its_type_and_is_asked_for_again(
    client: Client, tmp_path: Path
) -> None:
    (tmp_path / "manifest.webmanifest").write_text("{}")
    (tmp_path / "sw.js").write_text("self.skipWaiting()")
    (tmp_path / "icon-192.png").write_bytes(b"\x89PNG")
    kinds = {
        "manifest.webmanifest": "application/manifest+json",
        "sw.js": "text/javascript",
        "icon-192.png": "image/png",
    }
    for name, kind in kinds.items():
        answer = client.get(f"/{name}")
        assert answer.headers["content-type"].partition(";")[0] == kind
        assert answer.headers["cache-control"] == ASK_AGAIN
