"""docs/how-to/bring-a-map.md: its commands run, and print what the page shows."""

import json
import re
import shlex
import tomllib
from pathlib import Path

import pytest
from tests.basemap.tile_server import tile_server
from typer.testing import CliRunner

from recon.basemap import fetch
from recon.basemap.fetch import TileServer
from recon.cli.commands import app

PAGE = (Path(__file__).parents[2] / "docs/how-to/bring-a-map.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
COMMANDS = [block.strip() for _, block in BLOCKS if block.startswith("recon maps")]
RING = [[-93.6054, 41.9], [-93.6014, 41.9], [-93.6014, 41.9024], [-93.6054, 41.9024]]


def run(command: str) -> str:
    result = CliRunner().invoke(app, shlex.split(command)[1:], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.stdout


def make_site(folder: Path) -> None:
    run(f"recon site new {folder} --at 41.9012,-93.6034 --ground-altitude-m 275")
    shape = {"type": "Polygon", "coordinates": [[*RING, RING[0]]]}
    feature = {"type": "Feature", "properties": {}, "geometry": shape}
    layer = folder / "drawn.json"
    layer.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    run(f"recon site import {folder} {layer} --as boundary")


def test_the_commands_fetch_a_map_and_print_what_the_page_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    make_site(Path("my-field"))
    fetching, checking = COMMANDS
    with tile_server() as server:
        real = TileServer.url

        def on_loopback(named: TileServer, zoom: int, col: int, row: int) -> str:
            assert real(named, zoom, col, row).startswith("https://tiles.example.org/")
            return server.template.format(z=zoom, x=col, y=row)

        monkeypatch.setattr(fetch.TileServer, "url", on_loopback)
        assert "0 failed" in run(fetching)
        assert len(server.asked) > 50
    shown = next(block for _, block in BLOCKS if block.startswith("site my-field"))
    assert run(checking) == shown


def test_the_table_for_the_sites_file_is_the_address_of_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    make_site(Path("my-field"))
    (text,) = (block for language, block in BLOCKS if language == "toml")
    table = tomllib.loads(text)["tile_server"]
    assert f'--url "{table["url"]}"' in COMMANDS[0]
    site = tmp_path / "my-field" / "site.toml"
    site.write_text(site.read_text().replace("[[vehicles]]", f"{text}\n[[vehicles]]", 1))
    assert "site my-field" in run("recon site check my-field")


def test_the_pages_limits_are_the_programs() -> None:
    from recon.basemap.geotiff_map import LARGEST_SIDE_PX, MOST_READ_PX
    from recon.basemap.map_file import LARGEST_TILE_BYTES, LARGEST_TILE_PX, SUFFIXES

    for number in (MOST_READ_PX, LARGEST_SIDE_PX, LARGEST_TILE_PX, fetch.MOST_FETCHED):
        assert f"{number:,}" in PAGE
    assert f"{LARGEST_TILE_BYTES // 1024**2} MiB" in PAGE
    assert set(re.findall(r"`(\.\w+)`", PAGE)) == SUFFIXES
    assert (fetch.AT_ONCE, fetch.MOST_FAILURES) == (2, 10)
