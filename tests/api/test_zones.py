"""Temporary zones by HTTP: drawn, seen in every state, ended; and what cannot be drawn."""

import json
from typing import Any

import pytest
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.ready import ready_site

from recon.api.security import LOCAL_PERSON
from recon.model.geo import GeoPoint

HOME = GeoPoint(42.0, -93.6, 270.0)
CIRCLE = {"latitude_deg": 42.001, "longitude_deg": -93.6, "radius_m": 20.0}
PERSON = {"kind": "person", "circle": CIRCLE, "reason": "checks a sprinkler"}


@pytest.fixture
def client() -> Client:
    return Client(application(FakeStation(ready_site(HOME, ()))))


def drawn(client: Client, **changes: Any) -> dict[str, Any]:
    answer: dict[str, Any] = client.post("/api/zones", json=PERSON | changes).json()
    return answer


def test_one_that_is_drawn_is_in_the_answer_and_in_the_next_state(client: Client) -> None:
    answer = drawn(client, lasts_s=600.0)
    zone = answer["zone"]
    assert (answer["accepted"], answer["reason"]) == (True, None)
    assert (zone["id"], zone["name"], zone["radius_m"]) == (1, "person 1 (temporary)", 20.0)
    assert (zone["by"], zone["ends_in_s"]) == (LOCAL_PERSON.label, 600.0)
    assert zone["ring"][0] == zone["ring"][-1]
    north_deg = max(latitude for _, latitude in zone["ring"])
    assert (north_deg - 42.001) * 111_070.0 == pytest.approx(20.0, abs=0.2)
    assert client.get("/api/state").json()["temporary_zones"] == [zone]
    assert client.get("/api/zones").json() == [zone]


@pytest.mark.parametrize(
    ("kind", "ceiling_m"), [("person", 30.0), ("tractor", 30.0), ("crewed_aircraft", None)]
)
def test_each_kind_has_its_usual_heights(
    client: Client, kind: str, ceiling_m: float | None
) -> None:
    assert drawn(client, kind=kind)["zone"]["ceiling_m"] == ceiling_m
    zone = drawn(client, kind=kind, floor_m=5.0, ceiling_m=60.0)["zone"]
    assert (zone["floor_m"], zone["ceiling_m"]) == (5.0, 60.0)


def test_an_outline_is_drawn_as_it_is(client: Client) -> None:
    corners = [(42.0, -93.6), (42.001, -93.6), (42.001, -93.599)]
    outline = [{"latitude_deg": lat, "longitude_deg": lon} for lat, lon in corners]
    zone = drawn(client, circle=None, outline=outline)["zone"]
    assert zone["radius_m"] is None
    assert [(lat, lon) for lon, lat in zone["ring"]] == [*corners, corners[0]]


def test_it_is_ended_once(client: Client) -> None:
    drawn(client)
    assert client.post("/api/zones/1/end").json()["accepted"]
    assert client.get("/api/zones").json() == []
    again = client.post("/api/zones/1/end").json()
    assert (again["accepted"], again["rule"]) == (False, "temporary_zone")
    assert again["reason"] == "no temporary zone 1 is in force; those in force are: none"


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"reason": " "}, "a reason of 1 to 200 characters is needed"),
        ({"circle": CIRCLE | {"radius_m": 5_000.0}}, "1 to 2000 m are possible"),
        ({"circle": CIRCLE | {"latitude_deg": -93.6}}, "is not on the globe"),
        ({"circle": CIRCLE | {"latitude_deg": 41.0}}, "km from the site's origin"),
        ({"lasts_s": 1.0}, "10 to 86400 s are possible"),
        ({"floor_m": 40.0}, "is not above its floor"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_a_sentence(
    client: Client, changes: dict[str, Any], sentence: str
) -> None:
    answer = drawn(client, **changes)
    assert (answer["accepted"], answer["zone"]) == (False, None)
    assert sentence in answer["reason"]
    assert client.get("/api/zones").json() == []


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity"])
def test_numbers_that_are_none_are_refused(client: Client, number: str) -> None:
    body = json.dumps(PERSON).replace("20.0", number)
    headers = {"content-type": "application/json"}
    answer = client.post("/api/zones", content=body, headers=headers).json()
    assert not answer["accepted"]
    assert "its radius is" in answer["reason"]


@pytest.mark.parametrize(
    "changes",
    [{"circle": None}, {"outline": []}, {"kind": "bird"}, {"reason": 7}, {"circle": {}}, {"x": 1}],
)
def test_what_is_no_zone_is_a_bad_request(client: Client, changes: dict[str, Any]) -> None:
    assert client.post("/api/zones", json=PERSON | changes).status_code == 422


def test_without_a_site_there_is_no_place_for_one() -> None:
    answer = drawn(Client(application(FakeStation())))
    assert "needs a site with an origin" in answer["reason"]
