"""Flown regions by HTTP: what is kept of them, and their rest as a survey."""

import json
from dataclasses import replace
from datetime import date, timedelta
from pathlib import Path

import numpy as np
import pytest
import shapely
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.guidance.survey.fields import FLOWN_S, flown

from recon.geo import geojson_geometry
from recon.record.files.flown_region_file import write_region
from recon.site import demo_site_folder, load_site
from recon.station.recovery.flown_regions import FlownRegions

REGION = "west field"
ASKED = {"region": REGION, "height_above_takeoff_m": 40.0, "speed_mps": 5.0}
DAY = date.fromtimestamp(FLOWN_S)


@pytest.fixture
def station(tmp_path: Path) -> FakeStation:
    """A station at whose site the western half of a region was flown in an earlier run."""
    made = FakeStation(load_site(demo_site_folder()))
    Client(application(made)).post("/api/surveys", json=ASKED)
    (record,) = made.driver.station.surveys.records.values()
    assert record.state is not None
    plan = record.state.plan
    is_west = np.zeros(plan.cells.is_reached.shape, dtype=np.bool_)
    is_west[:, : is_west.shape[1] // 2] = True
    write_region(tmp_path, flown(plan, is_west))
    made.flown = FlownRegions(tmp_path)
    return made


@pytest.fixture
def client(station: FakeStation) -> Client:
    return Client(application(station))


def test_they_are_listed_with_their_days_and_what_is_left(client: Client) -> None:
    known = client.get("/api/flown-regions").json()
    (region,) = known["regions"]
    assert (region["region"], region["refusal"], region["changes"]) == (REGION, None, [])
    assert 0.3 * region["reached_m2"] < region["left_m2"] < 0.7 * region["reached_m2"]
    (day,) = region["days"]
    assert day["day"] == DAY.isoformat()
    assert day["imaged_m2"] == pytest.approx(region["reached_m2"] - region["left_m2"])
    assert known["unreadable"] == []


def test_the_same_request_gets_the_rows_of_then(client: Client, station: FakeStation) -> None:
    first, second = (
        client.post("/api/surveys", json={**ASKED, "rows": rows}).json()["survey"]
        for rows in ("auto", "new")
    )
    assert first["rows_note"] == f"Same rows as on {DAY.isoformat()}"
    assert second["rows_note"] == "New rows: asked for"
    assert first["figures"]["sun_unknown_m2"] == first["figures"]["in_sun_m2"] == 0.0
    other = client.post("/api/surveys", json={**ASKED, "height_above_takeoff_m": 50.0}).json()
    assert "the height was 40 m above takeoff and is 50 m" in other["survey"]["rows_note"]


def test_the_rest_is_planned_from_any_day_on(client: Client) -> None:
    (region,) = client.get("/api/flown-regions").json()["regions"]

    def planned(**asked: object) -> dict[str, object]:
        answer = client.post("/api/surveys/again", json={"id": region["id"], **asked}).json()
        assert answer["accepted"], answer
        assert answer["survey"]["phase"] == "created"
        figures: dict[str, object] = answer["survey"]["figures"]
        return figures

    left_m2 = pytest.approx(region["left_m2"], abs=17.0)
    assert planned()["not_yet_m2"] == left_m2
    assert planned(since=DAY.isoformat())["not_yet_m2"] == left_m2
    whole = planned(all_again=True)
    later = planned(since=(DAY + timedelta(days=1)).isoformat())
    assert whole["not_yet_m2"] == later["not_yet_m2"] == whole["region_m2"]


def test_what_cannot_be_flown_again_is_a_sentence(client: Client, station: FakeStation) -> None:
    unknown = client.post("/api/surveys/again", json={"id": "0"}).json()
    assert not unknown["accepted"]
    assert f"({REGION})" in unknown["reason"]
    (region,) = client.get("/api/flown-regions").json()["regions"]
    site = station.site
    gone = replace(site, layers=replace(site.layers, survey_regions={}))
    station._edited.site = gone
    answer = client.post("/api/surveys/again", json={"id": region["id"]}).json()
    assert "the site has no survey region 'west field' any more" in answer["reason"]
    assert client.get("/api/flown-regions").json()["regions"][0]["refusal"] == answer["reason"]


def test_a_day_that_is_none_is_refused_by_its_form(client: Client) -> None:
    answer = client.post("/api/surveys/again", json={"id": "0", "since": "yesterday"})
    assert answer.status_code == 422


def test_only_the_gaps_of_the_photos_are_planned(
    client: Client, station: FakeStation, tmp_path: Path
) -> None:
    (region,) = client.get("/api/flown-regions").json()["regions"]
    assert region["gaps_m2"] is None
    asked = {"id": region["id"], "gaps": True}
    refused = client.post("/api/surveys/again", json=asked).json()
    assert (
        refused["reason"] == f"no gap of the photos lies in region {REGION}: nothing is left of it"
    )
    frame = station.site.frame
    assert frame is not None
    outline_m = station.site.layers.survey_regions[REGION].outline_m
    # In the western half, which the survey itself counts as imaged in sun.
    (west, south), (east, north) = outline_m.min(axis=0), outline_m.max(axis=0)
    gap = shapely.box(west, south, west + 0.3 * (east - west), north)
    file = tmp_path / "fly-again.geojson"
    file.write_text(json.dumps(geojson_geometry(frame, gap)))
    station.gaps_file = lambda: file
    (region,) = client.get("/api/flown-regions").json()["regions"]
    assert 0.1 * region["reached_m2"] < region["gaps_m2"] < 0.5 * region["reached_m2"]
    planned = client.post("/api/surveys/again", json=asked).json()
    assert planned["survey"]["figures"]["not_yet_m2"] == pytest.approx(region["gaps_m2"], abs=17.0)
    assert planned["survey"]["rows_note"] == f"Same rows as on {DAY.isoformat()}"
    file.write_text("{}")
    assert client.get("/api/flown-regions").json()["regions"][0]["gaps_m2"] is None
