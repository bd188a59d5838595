"""The page that makes a site: a real folder behind the routes, and what it refuses."""

import json
from pathlib import Path

import pytest
from tests.api.client import Client

from recon.api.new_site_app import PAGE, create_new_site_app
from recon.api.security import Access, AccessCheck
from recon.site import load_site
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
    assert list(site.profiles) == ["SIM-1", "SIM-2"]


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"latitude_deg": 91.0}, "expected a latitude of -90 to 90, got 91"),
        ({"longitude_deg": -181.0}, "expected a longitude of -180 to 180, got -181"),
        ({"simulated_drones": 65}, "expected 0 to 64 drones, got 65"),
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
