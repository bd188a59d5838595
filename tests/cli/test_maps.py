"""`recon maps`: tiles are fetched for a site, and what its maps cover is printed."""

import json
from pathlib import Path
from shutil import copytree

import pytest
from tests.basemap.made_maps import keys_over, write_mbtiles
from tests.basemap.tile_server import tile_server
from tests.fetching.file_server import send
from typer.testing import CliRunner, Result

from recon.basemap.web_mercator import area_around
from recon.cli.maps import maps_app
from recon.cli.site import site_app
from recon.model.errors import ReconError
from recon.site import load_site

RING = [[-93.604, 41.901], [-93.602, 41.901], [-93.602, 41.902], [-93.604, 41.902]]


def run(*words: str) -> Result:
    return CliRunner().invoke(maps_app, words, catch_exceptions=False)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A site of 166 by 111 m."""
    folder = tmp_path_factory.mktemp("made") / "west field"
    place = ("--at", "41.9015,-93.603", "--ground-altitude-m", "275")
    CliRunner().invoke(site_app, ["new", str(folder), *place], catch_exceptions=False)
    layer = folder.parent / "boundary.geojson"
    shape = {"type": "Polygon", "coordinates": [[*RING, RING[0]]]}
    feature = {"type": "Feature", "properties": {"name": "b"}, "geometry": shape}
    layer.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    words = ["import", str(folder), str(layer), "--as", "boundary"]
    assert CliRunner().invoke(site_app, words, catch_exceptions=False).exit_code == 0
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    """The site, in a folder of the test's own."""
    return copytree(made, tmp_path / made.name)


def test_tiles_are_fetched_for_the_boundary_and_checked_without_the_server(folder: Path) -> None:
    with tile_server() as server:
        words = ("--url", server.template, "--zoom", "15-18", "--name", "field")
        found = run("fetch", str(folder), *words)
        again = run("fetch", str(folder), *words)
    assert found.exit_code == again.exit_code == 0
    count = len(server.asked)
    assert f"{count} fetched, 0 there already" in found.output
    assert f"0 fetched, {count} there already" in again.output
    assert f"{count} of {count} tiles" in found.stderr
    checked = run("check", str(folder))
    assert checked.exit_code == 0
    head = "field.mbtiles: MBTiles, 0.0 MB, fetched just now: covers 100 % of the site to zoom 18"
    assert f"{head} (0.44 m a pixel)" in checked.output
    assert "  zoom 15:  100 %  3.56 m a pixel" in checked.output


def test_check_fails_until_a_map_shows_all_of_the_site(folder: Path) -> None:
    empty = run("check", str(folder))
    assert empty.exit_code == 1
    assert "no map in" in empty.output
    site = load_site(folder)
    assert site.frame is not None
    area = area_around(site.frame, site.layers.boundary, 1_000.0)
    keys = keys_over(area, [17])
    (folder / "maps").mkdir()
    write_mbtiles(folder / "maps" / "half.mbtiles", keys[: len(keys) // 2])
    (folder / "maps" / "broken.mbtiles").write_bytes(b"x")
    half = run("check", str(folder))
    assert half.exit_code == 1
    assert "broken.mbtiles: not used: expected an MBTiles file" in half.output
    assert "no map shows all of the site" in half.output
    assert "covers 100 %" not in half.output
    write_mbtiles(folder / "maps" / "whole.mbtiles", keys)
    assert run("check", str(folder)).exit_code == 0


def test_without_a_boundary_it_is_what_flights_may_reach(tmp_path: Path) -> None:
    made = tmp_path / "bare"
    place = ("--at", "41.9015,-93.603", "--ground-altitude-m", "275")
    CliRunner().invoke(site_app, ["new", str(made), *place], catch_exceptions=False)
    assert (
        "no boundary: 500 m around the origin with margin from 41.89"
        in run("check", str(made)).output
    )


def test_the_server_may_stand_in_the_sites_file(folder: Path) -> None:
    site_file = folder / "site.toml"
    text = site_file.read_text()
    with tile_server() as server:
        table = f'[tile_server]\nurl = "{server.template}"\nattribution = "© county"\n\n'
        site_file.write_text(text.replace("[[vehicles]]", f"{table}[[vehicles]]", 1))
        assert run("fetch", str(folder), "--zoom", "15").exit_code == 0
    assert len(server.asked) > 0
    assert "127.0.0.1.mbtiles: MBTiles" in run("check", str(folder)).output
    for wrong in ("[tile_server]\nurl = 5\n", "[tile_server]\naddress = 'x'\n"):
        site_file.write_text(text.replace("[[vehicles]]", f"{wrong}[[vehicles]]", 1))
        with pytest.raises(ReconError, match="tile_server"):
            load_site(folder)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ((), "expected the address of a tile server, got none: give --url"),
        (("--url", "http://x/{z}"), "with {z}, {x} and {y} in it"),
        (("--url", "http://x/{z}/{x}/{y}", "--zoom", "12-22", "--most-tiles", "50"), "at most 50"),
        (("--url", "http://x/{z}/{x}/{y}", "--zoom", "high"), "like 12-19, got 'high'"),
        (("--url", "http://x/{z}/{x}/{y}", "--zoom", "19-12"), "like 12-19, got '19-12'"),
        (("--url", "http://x/{z}/{x}/{y}", "--zoom", "12-25"), "levels of 0 to 24"),
        (("--url", "http://x/{z}/{x}/{y}", "--name", "../../etc"), "--name: expected letters"),
    ],
)
def test_what_cannot_be_fetched_is_refused_before_anything_is_asked(
    folder: Path, words: tuple[str, ...], sentence: str
) -> None:
    with pytest.raises(ReconError) as found:
        run("fetch", str(folder), *words)
    assert sentence in str(found.value)
    assert not (folder / "maps").exists()


def test_failed_tiles_are_counted_and_the_command_states_it(folder: Path) -> None:
    with tile_server(lambda handler, _: send(handler, b"no picture")) as server:
        words = ("--url", server.template, "--zoom", "15")
        failed = run("fetch", str(folder), *words)
    assert failed.exit_code == 1
    count = len(server.asked)
    assert f"{count} failed" in failed.output
    assert f"failed {count} times: expected tiles as PNG" in failed.output
