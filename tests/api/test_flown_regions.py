"""Flown regions by HTTP: what is kept of them, and their rest as a survey."""

from dataclasses import replace
from datetime import date, timedelta
from pathlib import Path

import numpy as np
import pytest
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.guidance.survey.fields import FLOWN_S, flown

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
