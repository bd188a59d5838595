"""A survey's station is killed in flight: the rest is flown when a person asks for it, not before.

Real processes and sockets: a station, a simulated drone, and the shell.
"""

import json
import signal
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from tests.cli.processes import started
from tests.cli.station_process import StationProcess, addresses
from tests.e2e.test_restart import free_port

from recon.geo import geo_from_enu
from recon.model.geo import GeoPoint, LocalFrame
from recon.site.new_site import NewSiteFields, make_site

HOME = GeoPoint(44.99, -93.2, 250.0)
FIELD_M = (0.0, 160.0, 0.0, 60.0)
FENCE_M = (-200.0, 400.0, -200.0, 300.0)


def write_layer(path: Path, west_east_south_north_m: tuple[float, ...]) -> None:
    """A file with one rectangle."""
    west, east, south, north = west_east_south_north_m
    corners_m = [(west, south, 0), (east, south, 0), (east, north, 0), (west, north, 0)]
    latitude_deg, longitude_deg, _ = geo_from_enu(LocalFrame(HOME), [*corners_m, corners_m[0]])
    ring = [list(each) for each in zip(longitude_deg.tolist(), latitude_deg.tolist(), strict=True)]
    geometry = {"type": "Polygon", "coordinates": [ring]}
    shape = {"type": "Feature", "properties": {"name": "north"}, "geometry": geometry}
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [shape]}))


def write_site(folder: Path) -> None:
    """A site with one region beside its drone's pad."""
    toml = make_site(folder, HOME, NewSiteFields(name="farm", drones=1, has_imager=False))
    write_layer(folder / "regions.geojson", FIELD_M)
    write_layer(folder / "boundary.geojson", FENCE_M)
    layers = '[layers]\nsurvey_regions = "regions.geojson"\nboundary = "boundary.geojson"\n'
    pad = "pad = { latitude_deg = 44.9899, longitude_deg = -93.2, altitude_m = 250.0 }\n"
    text = toml.read_text(encoding="utf-8").replace("[layers]\n", layers)
    toml.write_text(text + pad, encoding="utf-8")


def flown(here: StationProcess) -> list[dict[str, Any]]:
    regions: list[dict[str, Any]] = here.get("/api/flown-regions")["regions"]
    return regions


@pytest.fixture
def stack() -> Any:
    with ExitStack() as made:
        yield made


def test_the_rest_of_a_killed_stations_survey(stack: ExitStack, tmp_path: Path) -> None:
    site, audit, port = tmp_path / "site", tmp_path / "audit", free_port()
    write_site(site)

    def start() -> StationProcess:
        ports = ("--link-port", str(port), "--http-port", "0")
        more = ("--no-record", "--no-guard", "--site", str(site), "--audit", str(audit))
        station = stack.enter_context(started("run", *ports, *more))
        url, link_port = addresses(station)
        return StationProcess(station, None, url, link_port, audit)

    here = start()
    place = ("--station", f"127.0.0.1:{port}", "--site", str(site))
    stack.enter_context(started("sim", *place, "--vehicles", "1", "--no-imager", "--airborne"))
    here.until(lambda them: any(each["flight_mode"]["value"] for each in them))
    created = here.recon(
        "survey",
        "create",
        "north",
        "--height",
        "40",
        "--speed",
        "8",
        "--front-overlap",
        "0.5",
        "--json",
    )
    assert here.recon("survey", "start", created.json["id"], "SIM-1").code == 0
    here.until(lambda _: any(each["left_m2"] < each["reached_m2"] for each in flown(here)))
    here.station.send(signal.SIGKILL)
    here.station.wait()

    again = start()
    (region,) = flown(again)
    assert region["refusal"] is None
    assert 0.0 < region["left_m2"] < region["reached_m2"]
    again.until(lambda them: any(each["staleness"] == "live" for each in them))
    assert again.get("/api/surveys") == []
    assert f"{region['id']}  40 m above takeoff  simulated" in again.recon("survey", "flown").out
    resumed = again.recon("survey", "resume", "north", "SIM-1", "--json")
    assert resumed.code == 0, resumed.out
    survey = resumed.json
    assert survey["phase"] == "running"
    assert survey["rows_note"].startswith("Same rows as on ")
    figures = survey["figures"]
    assert figures["not_yet_m2"] == pytest.approx(region["left_m2"], abs=16.0)
    again.until(lambda _: again.get("/api/surveys")[0]["missions"] == 1)
    none_left = again.recon("survey", "resume", "south")
    assert none_left.code == 2
    assert "available: north" in none_left.err
