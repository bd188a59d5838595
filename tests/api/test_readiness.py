"""Authority and preflight over the API: words that are no orders."""

from typing import Any

import pytest
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.link.approved import core, extended

from recon import wire
from recon.api import schema
from recon.api.security import LOCAL_PERSON
from recon.model.control import AuthorityHolder
from recon.model.event import LinkOpened, PacketReceived
from recon.vehicles.reports import to_report


@pytest.fixture
def station() -> FakeStation:
    station = FakeStation()
    station.driver.handle(LinkOpened(1, "10.0.0.1:5"))
    for packet in (extended(b"A"), core()):
        station.driver.handle(PacketReceived(1, to_report(wire.decode(packet))))
    return station


@pytest.fixture
def client(station: FakeStation) -> Client:
    return Client(application(station))


def vehicle(client: Client) -> dict[str, Any]:
    found: dict[str, Any] = client.get("/api/vehicle?serial=A").json()
    return found


class TestAuthority:
    def take(self, client: Client, holder: str, serial: str = "A") -> dict[str, Any]:
        response = client.post(f"/api/vehicle/authority?serial={serial}", json={"holder": holder})
        assert response.status_code == 200
        answer: dict[str, Any] = response.json()
        return answer

    def test_at_first_the_operator_leads(self, client: Client) -> None:
        assert vehicle(client)["authority"] == {
            "holder": "operator",
            "holder_name": "",
            "age_s": None,
            "reason": "not yet transferred",
        }

    @pytest.mark.parametrize("holder", ["pilot", "guidance", "operator"])
    def test_a_word_changes_who_leads(
        self, client: Client, station: FakeStation, holder: str
    ) -> None:
        taken = self.take(client, holder)
        assert taken == {"accepted": True, "rule": None, "reason": None}
        authority = station.driver.station.control("A").authority
        assert (authority.holder, authority.holder_name) == (
            AuthorityHolder(holder),
            LOCAL_PERSON.label,
        )
        authority = vehicle(client)["authority"]
        assert (authority["holder"], authority["holder_name"], authority["age_s"]) == (
            holder,
            LOCAL_PERSON.label,
            0.0,
        )

    def test_a_refusal_is_an_answer(self, client: Client, station: FakeStation) -> None:
        self.take(client, "pilot")
        answer = self.take(client, "guidance")
        assert (answer["accepted"], answer["rule"]) == (False, "authority")
        assert "take control first" in answer["reason"]
        assert station.driver.station.control("A").authority.holder is AuthorityHolder.PILOT

    def test_an_unknown_vehicle_has_no_authority_to_take(self, client: Client) -> None:
        assert "X is unknown" in self.take(client, "operator", "X")["reason"]

    @pytest.mark.parametrize("body", [{}, {"holder": "cat"}, {"holder": "pilot", "by": "me"}])
    def test_another_form_is_not_taken(self, client: Client, body: dict[str, str]) -> None:
        assert client.post("/api/vehicle/authority?serial=A", json=body).status_code == 422


class TestPreflight:
    def test_the_list_shows_each_point_that_is_missing(self, client: Client) -> None:
        response = client.get("/api/vehicle/preflight?serial=A")
        checklist = schema.PreflightView.model_validate_json(response.text)
        assert (checklist.serial, checklist.name, checklist.is_passed, checklist.override) == (
            "A",
            "A",
            False,
            None,
        )
        points = {point.key: point for point in checklist.points}
        assert (points["fence"].state, points["fence"].holds_back) == ("fails", True)
        assert (points["gnss"].state, points["gnss"].to_do) == ("ok", "")
        assert "endurance_min" in points["endurance"].to_do

    def test_an_unknown_vehicle_has_no_checklist(self, client: Client) -> None:
        response = client.get("/api/vehicle/preflight?serial=X")
        assert response.status_code == 404
        assert response.json() == {"error": "No vehicle with serial 'X'"}

    def test_an_override_is_shown_everywhere(self, client: Client) -> None:
        assert vehicle(client)["preflight_override"] is None
        path = "/api/vehicle/preflight/override?serial=A"
        answer = client.post(path, json={"reason": "a test flight indoors"}).json()
        assert answer == {"accepted": True, "rule": None, "reason": None}
        given = {"by": LOCAL_PERSON.label, "reason": "a test flight indoors", "age_s": 0.0}
        assert vehicle(client)["preflight_override"] == given
        checklist = client.get("/api/vehicle/preflight?serial=A").json()
        assert checklist["override"] == given
        assert checklist["is_passed"] is False

    def test_no_reason_is_no_override(self, client: Client) -> None:
        path = "/api/vehicle/preflight/override?serial=A"
        answer = client.post(path, json={"reason": "  "}).json()
        assert (answer["accepted"], answer["rule"]) == (False, "preflight_override")
        assert "needs a reason" in answer["reason"]
        assert vehicle(client)["preflight_override"] is None
        assert client.post(path, json={}).status_code == 422
        assert client.post(path, json={"reason": "x" * 3000}).status_code == 422
