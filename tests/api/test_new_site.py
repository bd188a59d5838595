"""The page that makes a site: a real folder behind the routes, and what it refuses."""

import json
from pathlib import Path

import numpy as np
import pytest
from tests.api.client import Client

from recon.api.new_site_app import PAGE, create_new_site_app
from recon.api.security import Access, AccessCheck
from recon.geo import Polygon, enu_from_points
from recon.site import load_site
from recon.site.drawing import read_drawing
from recon.site.load import read_rehearsal
from recon.station.api_views.site_service import feature_view
from recon.station.host.new_site import NewSite, awaits_site

ASKED = {
    "name": "North field",
    "latitude_deg": 41.9012,
    "longitude_deg": -93.6034,
    "ground_above_sea_level_m": 275.0,
    "simulated_drones": 2,
}
FIELD = {
    "type": "Feature",
    "properties": {"name": "north"},
    "geometry": {
        "type": "Polygon",
        "coordinates": [[[-93.61, 41.9], [-93.6, 41.9], [-93.6, 41.91], [-93.61, 41.9]]],
    },
}


EAST = {
    "type": "Polygon",
    "coordinates": [[[-93.598, 41.9], [-93.595, 41.9], [-93.595, 41.905], [-93.598, 41.9]]],
}


@pytest.fixture
def new_site(tmp_path: Path) -> NewSite:
    return NewSite(tmp_path / "field")


@pytest.fixture
def client(new_site: NewSite, tmp_path: Path) -> Client:
    console = tmp_path / "console"
    console.mkdir()
    (console / PAGE).write_text("<!doctype html><title>a page</title>")
    return Client(AccessCheck(create_new_site_app(new_site, console, "1.2.3"), Access()))


def test_the_first_page_is_the_one_that_asks(client: Client) -> None:
    answer = client.get("/")
    assert answer.status_code == 307
    assert answer.headers["location"] == PAGE
    page = client.get(f"/{PAGE}")
    assert "a page" in page.text
    assert "frame-ancestors 'none'" in page.headers["Content-Security-Policy"]


def test_it_names_the_folder(client: Client, new_site: NewSite) -> None:
    about = client.get("/api/site/new").json()
    assert about == {"folder": str(new_site.folder.resolve()), "name": "field"}


def test_a_site_is_made_that_a_station_starts_with(client: Client, new_site: NewSite) -> None:
    answer = client.post("/api/site/new", json=ASKED)
    assert answer.json() == {"accepted": True, "rule": None, "reason": None}
    assert new_site.made.is_set()
    site = load_site(new_site.folder)
    assert site.name == "North field"
    assert site.frame is not None
    assert site.frame.origin.latitude_deg == 41.9012
    # Sea level is about 30 m below the ellipsoid there.
    assert site.frame.origin.ellipsoid_height_m == pytest.approx(244.9, abs=1.0)
    assert list(site.profiles) == ["SIM-1", "SIM-2", "SIM-IMAGER"]


def test_the_shapes_of_a_file_are_kept_and_pads_are_beside_the_crop(
    client: Client, new_site: NewSite
) -> None:
    regions = [
        {"name": "north", "geometry": FIELD["geometry"]},
        {"name": "north", "geometry": EAST},
    ]
    asked = {**ASKED, "regions": regions, "margin_m": 40.0}
    shown = client.post("/api/site/new/shapes", json=asked).json()
    assert shown["accepted"] is True
    assert not new_site.folder.exists()
    assert client.post("/api/site/new", json=asked).json()["accepted"] is True
    site = load_site(new_site.folder)
    assert list(site.layers.survey_regions) == ["north", "north 2"]
    drawn = [feature_view(each).model_dump(mode="json") for each in read_drawing(new_site.folder)]
    assert sorted(map(str, drawn)) == sorted(map(str, shown["features"]))
    assert site.frame is not None
    assert site.layers.boundary is not None
    crops = [Polygon(region) for region in site.layers.survey_regions.values()]
    corners_m = np.vstack([each.outline_m for each in site.layers.survey_regions.values()])
    rooms_m = Polygon(site.layers.boundary).distance_to_edge_m(corners_m)
    assert rooms_m.min() == pytest.approx(40.0, abs=2.0)
    pads_m = enu_from_points(site.frame, [pad.place for pad in site.layers.landing_pads])[:, :2]
    assert len(pads_m) == 3
    gaps_m = np.hypot(*(pads_m[:, None] - pads_m).T) + 1e3 * np.eye(3)
    assert gaps_m.min() > 24.9
    off_m = -np.array([crop.distance_to_edge_m(pads_m) for crop in crops]).max(axis=0)
    assert off_m == pytest.approx(np.full(3, 15.0), abs=0.5)
    assert Polygon(site.layers.boundary).distance_to_edge_m(pads_m).min() > 20.0


def test_a_place_alone_is_a_square_field_with_an_imaging_drone(
    client: Client, new_site: NewSite
) -> None:
    asked = {**ASKED, "cloud_cover_percent": 70.0, "wind_mps": 6.0, "wind_from_deg": 180.0}
    assert client.post("/api/site/new", json=asked).json()["accepted"] is True
    site = load_site(new_site.folder)
    (region,) = site.layers.survey_regions.values()
    assert Polygon(region).area_m2 == pytest.approx(40_000.0, rel=1e-3)
    assert list(site.imagers) == ["SIM-IMAGER"]
    assert all(profile.pad is not None for profile in site.profiles.values())
    sky = read_rehearsal(new_site.folder)
    assert (sky.cloud_cover_percent, sky.wind_mps, sky.wind_from_deg) == (70.0, 6.0, 180.0)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"latitude_deg": 91.0}, "expected a latitude of -90 to 90, got 91"),
        ({"longitude_deg": -181.0}, "expected a longitude of -180 to 180, got -181"),
        ({"simulated_drones": 65}, "expected 0 to 63 drones, got 65"),
        ({"margin_m": 5.0}, "expected a margin of 20 to 300 m, got 5 m"),
        (
            {"simulated_drones": 60},
            "expected at most 35 vehicles, got 61: the field's edge has no room for more pads "
            "25 m apart",
        ),
        (
            {"cloud_cover_percent": 101.0},
            "rehearsal: cloud_cover_percent: expected a number of 0 to 100, got 101.0",
        ),
        ({"wind_mps": -1.0}, "rehearsal: wind_mps: expected a number of 0 to 15, got -1.0"),
        ({"name": ""}, "expected a name of 1 to 64 printable letters, got ''"),
        ({"name": "a\nb"}, "expected a name of 1 to 64 printable letters, got 'a\\nb'"),
    ],
)
def test_wrong_values_are_refused_with_a_sentence(
    client: Client, new_site: NewSite, changes: dict[str, object], reason: str
) -> None:
    answer = client.post("/api/site/new", json={**ASKED, **changes}).json()
    assert (answer["accepted"], answer["reason"]) == (False, reason)
    assert not new_site.made.is_set()
    assert awaits_site(new_site.folder)


@pytest.mark.parametrize("altitude", ["NaN", "Infinity", '"high"', "null"])
def test_what_is_no_number_is_refused(client: Client, new_site: NewSite, altitude: str) -> None:
    body = json.dumps(ASKED).replace("275.0", altitude)
    answer = client.post("/api/site/new", content=body)
    assert answer.status_code == 422 or answer.json()["accepted"] is False
    assert not new_site.made.is_set()


def test_a_second_site_in_one_folder_is_refused(client: Client, new_site: NewSite) -> None:
    assert client.post("/api/site/new", json=ASKED).json()["accepted"] is True
    answer = client.post("/api/site/new", json=ASKED).json()
    assert answer["accepted"] is False
    assert "exists already" in answer["reason"]


def test_shapes_of_a_file_are_read_to_find_the_field_by(client: Client) -> None:
    read = client.post("/api/site/import?name=north.geojson", content=json.dumps(FIELD)).json()
    assert [each["name"] for each in read["features"]] == ["north"]
    read = client.post("/api/site/import?name=north.geojson", content=b"\0\1").json()
    assert read["features"] == []
    assert "north.geojson" in read["reason"]


def test_pages_of_other_sites_reach_nothing(client: Client, new_site: NewSite) -> None:
    headers = {"origin": "http://elsewhere.example"}
    answer = client.post("/api/site/new", json=ASKED, headers=headers)
    assert answer.status_code == 403
    assert not new_site.made.is_set()


def test_only_an_empty_or_missing_folder_awaits_a_site(tmp_path: Path) -> None:
    assert awaits_site(tmp_path)
    assert awaits_site(tmp_path / "missing")
    (tmp_path / "photo.jpg").touch()
    assert not awaits_site(tmp_path)
    assert not awaits_site(tmp_path / "photo.jpg")
