"""Which role each request needs: every route is in the table, and the table is obeyed."""

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest
from fastapi.routing import APIRoute, APIWebSocketRoute
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application

from recon.api.permissions import LEAST_ROLE, STREAM
from recon.api.security import LOCAL_PERSON, Access, AccessCheck
from recon.model.person import Role
from recon.station.api_views.app import create_app

HOVER = {"serials": ["A"], "order": {"kind": "hover"}}
NUDGE = {
    "serials": ["A"],
    "order": {"kind": "nudge", "north_m": 1.0},
    "owner": "a-name-of-a-owner-01",
}
ZONE = {
    "kind": "person",
    "circle": {"latitude_deg": 42.0, "longitude_deg": -93.6, "radius_m": 20.0},
    "reason": "checks a sprinkler",
}
RELIEF = {"serial": "A", "spare": "B"}
START = {"serials": ["A"], "takeoff": False}

BODIES: dict[str, tuple[str, object, Role]] = {
    "all stop": ("/api/all-stop", None, Role.OBSERVER),
    "hold": ("/api/orders", HOVER, Role.PILOT),
    "land": ("/api/orders", {**HOVER, "order": {"kind": "land"}}, Role.PILOT),
    "return": ("/api/orders", {**HOVER, "order": {"kind": "return_home"}}, Role.PILOT),
    "nudge": ("/api/orders", NUDGE, Role.OPERATOR),
    "camera": ("/api/orders", {**HOVER, "order": {"kind": "camera_stop"}}, Role.OPERATOR),
    "check a hold": ("/api/orders/check", HOVER, Role.PILOT),
    "check a nudge": ("/api/orders/check", NUDGE, Role.OPERATOR),
    "to the pilot": ("/api/vehicle/authority?serial=A", {"holder": "pilot"}, Role.PILOT),
    "take": ("/api/vehicle/authority?serial=A", {"holder": "operator"}, Role.OPERATOR),
    "to guidance": ("/api/vehicle/authority?serial=A", {"holder": "guidance"}, Role.OPERATOR),
    "pause": ("/api/surveys/1/pause", None, Role.PILOT),
    "abort": ("/api/surveys/1/abort", None, Role.PILOT),
    "draw a zone": ("/api/zones", ZONE, Role.PILOT),
    "end a zone": ("/api/zones/1/end", None, Role.OPERATOR),
    "start": ("/api/surveys/1/start", START, Role.OPERATOR),
    "release": ("/api/all-stop/release", {"serials": None}, Role.OPERATOR),
    "fleet return": ("/api/fleet-return", {"serials": None}, Role.OPERATOR),
    "side-step": ("/api/side-step", {}, Role.OPERATOR),
    "relieve": ("/api/imager-relief", RELIEF, Role.OPERATOR),
    "dismiss": ("/api/vehicle/hazard/dismiss?serial=A", None, Role.OPERATOR),
    "acknowledge": ("/api/alarms/1/acknowledge", None, Role.OPERATOR),
    "holds on": ("/api/separation-hold/on", None, Role.OPERATOR),
    "holds off": ("/api/separation-hold/off", None, Role.ADMIN),
    "override": ("/api/vehicle/preflight/override?serial=A", {"reason": "indoors"}, Role.ADMIN),
}


def app_for(role: Role, station: FakeStation | None = None) -> AccessCheck:
    access = Access(local=replace(LOCAL_PERSON, role=role))
    return application(station or FakeStation(), access=access)


def routes() -> set[tuple[str, str]]:
    found = set[tuple[str, str]]()
    for route in create_app(FakeStation(), None, "1.2.3").routes:
        if isinstance(route, APIRoute):
            found |= {(method, route.path) for method in route.methods or ()}
        elif isinstance(route, APIWebSocketRoute):
            found.add((STREAM, route.path))
    return {(method, path) for method, path in found if path.startswith("/api/")}


def test_every_route_is_in_the_table_and_nothing_else() -> None:
    assert routes() == set(LEAST_ROLE)


@pytest.mark.parametrize("role", Role)
@pytest.mark.parametrize("name", BODIES)
def test_a_request_is_refused_below_its_role_only(name: str, role: Role) -> None:
    path, body, needed = BODIES[name]
    station = FakeStation()
    response = Client(app_for(role, station)).post(path, json=body)
    assert (response.status_code == 403) is not role.includes(needed)
    if response.status_code == 403:
        assert f"has the role {role.value}; this needs" in response.json()["error"]
        assert station.asked == []


@pytest.mark.parametrize("role", Role)
def test_every_role_sees(role: Role) -> None:
    client = Client(app_for(role))
    for method, path in LEAST_ROLE:
        if method == "GET" and "{" not in path:
            assert client.get(f"{path}?serial=A&latitude_deg=1&longitude_deg=2").status_code in (
                200,
                404,
            )
    assert client.open_stream("/api/stream").is_served


def test_a_malformed_request_is_refused_by_role_first() -> None:
    response = Client(app_for(Role.OBSERVER)).post("/api/fleet-return", json=7)
    assert response.status_code == 403


def test_a_route_without_a_row_is_an_administrators() -> None:
    for role in Role:
        app = create_app(FakeStation(), None, "1.2.3")

        @app.get("/api/new")
        async def new() -> int:
            return 1

        access = Access(local=replace(LOCAL_PERSON, role=role))
        assert Client(AccessCheck(app, access)).get("/api/new").status_code == (
            200 if role is Role.ADMIN else 403
        )


def test_roles_are_ordered() -> None:
    for low, high in pairwise(Role):
        assert high.includes(low)
        assert not low.includes(high)


def test_the_page_on_security_has_every_request_in_the_row_of_its_role() -> None:
    page = (Path(__file__).parents[2] / "SECURITY.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (observer|pilot|operator|admin) \| [^|]* \| (.*) \|$", page, re.M)
    named: dict[str, set[str]] = {role.value: set() for role in Role}
    for role, text in rows:
        named[role] |= set(re.findall(r"`(/api/[^`]*)`", text))
    expected: dict[str, set[str]] = {role.value: set() for role in Role}
    for (method, path), role in LEAST_ROLE.items():
        if method == "POST":
            expected[role.value].add(path)
    assert named == expected
