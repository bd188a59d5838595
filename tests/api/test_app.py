"""The HTTP API: what is let in, what is answered, and how refusals read."""

import io
import json
from collections.abc import AsyncIterator
from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import rasterio
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.api.client import BASE, Client
from tests.api.fake_station import FakeStation, application, rgb_frame
from tests.examples import examples
from tests.persons import TOKEN, user

from recon.api import schema
from recon.api.app import SECURITY_HEADERS
from recon.api.login import Login
from recon.api.security import LOGIN_NEEDED, PROTOCOL, TOKEN_PROTOCOL_PREFIX, Access
from recon.model.command import FlyMission, Hover, VirtualStick
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, Frame, GroundImage

HOVER = {"serials": ["A"], "order": {"kind": "hover"}}
WAYPOINT = {
    "latitude_deg": 41.9,
    "longitude_deg": -93.6,
    "height_above_takeoff_m": 30.0,
    "speed_mps": 5.0,
}


@pytest.fixture
def station() -> FakeStation:
    return FakeStation()


@pytest.fixture
def client(station: FakeStation) -> Client:
    return Client(application(station))


@cache
def same_client() -> Client:
    """Return one for all examples of a property: to make an application takes 0.1 s."""
    return Client(application(FakeStation()))


def post(client: Client, text: str) -> Any:
    return client.post("/api/orders", content=text, headers={"content-type": "application/json"})


class TestState:
    def test_what_is_served_matches_the_schema(self, client: Client) -> None:
        response = client.get("/api/state")
        assert response.status_code == 200
        state = schema.StationState.model_validate_json(response.text)
        assert schema.StationState.model_validate_json(state.model_dump_json()) == state
        assert state.time_ns == 1_000_000_000

    def test_lists_are_served(self, client: Client) -> None:
        assert client.get("/api/vehicles").json() == []
        assert client.get("/api/commands").json() == []

    @pytest.mark.parametrize(
        "path", ["/api/vehicle?serial=none", "/api/commands/3", "/api/nothing", "/nothing.js"]
    )
    def test_what_is_not_there_is_one_sentence(self, client: Client, path: str) -> None:
        response = client.get(path)
        assert response.status_code == 404
        assert list(response.json()) == ["error"]

    def test_a_wrong_method_is_one_sentence(self, client: Client) -> None:
        response = client.ask("DELETE", "/api/state")
        assert response.status_code == 405
        assert list(response.json()) == ["error"]

    def test_the_api_is_described(self, client: Client) -> None:
        described = client.get("/openapi.json").json()
        assert "/api/orders" in described["paths"]
        assert "StationState" in described["components"]["schemas"]


class TestOrders:
    def test_an_unknown_serial_is_refused_as_a_result(self, client: Client) -> None:
        (result,) = client.post("/api/orders", json=HOVER).json()["results"]
        assert result["accepted"] is False
        assert result["serial"] == "A"
        assert result["rule"] == "reachable"
        assert "is unknown" in result["reason"]

    def test_each_vehicle_is_ordered_once(self, client: Client) -> None:
        asked = {"serials": ["A", "B", "A"], "order": {"kind": "land"}}
        results = client.post("/api/orders", json=asked).json()["results"]
        assert [r["serial"] for r in results] == ["A", "B"]
        assert len({r["command_id"] for r in results}) == 2

    def test_as_many_as_are_allowed_all_get_an_answer(self, client: Client) -> None:
        """More than the orders that are kept."""
        serials = [f"S{number}" for number in range(256)]
        response = client.post("/api/orders", json={**HOVER, "serials": serials})
        assert response.status_code == 200
        assert [r["serial"] for r in response.json()["results"]] == serials

    @pytest.mark.parametrize("kind", ["land", "return_home", "camera_stop"])
    def test_takeoff_is_no_word_for_an_order_that_never_takes_off(
        self, client: Client, station: FakeStation, kind: str
    ) -> None:
        for path in ("/api/orders", "/api/orders/check"):
            asked = {"serials": ["A"], "order": {"kind": kind}, "takeoff": True}
            response = client.post(path, json=asked)
            assert response.status_code == 422
            assert f"takeoff is not possible with {kind}" in response.text
        assert station.asked == []

    def test_the_order_reaches_the_station_as_asked(
        self, client: Client, station: FakeStation
    ) -> None:
        mission = {"kind": "mission", "waypoints": [WAYPOINT, WAYPOINT], "land_at_end": True}
        client.post("/api/orders", json={"serials": ["A"], "order": mission, "takeoff": True})
        stick = {
            "kind": "stick",
            "yaw_deg": 1.0,
            "velocity_x_mps": 2.0,
            "velocity_y_mps": 3.0,
            "height_above_takeoff_m": 4.0,
        }
        client.post("/api/orders", json={"serials": ["B"], "order": stick})
        client.post("/api/orders", json=HOVER)
        assert [order.takeoff for order in station.asked] == [True, False, False]
        flown, pushed, held = (order.body for order in station.asked)
        assert isinstance(flown, FlyMission)
        assert flown.mission.land_at_end
        assert flown.mission.waypoints[0].loiter_s is None
        assert isinstance(pushed, VirtualStick)
        assert (pushed.yaw_deg, pushed.velocity_x_mps, pushed.velocity_y_mps) == (1.0, 2.0, 3.0)
        assert isinstance(held, Hover)

    @pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999", "1" + "0" * 400])
    def test_numbers_that_are_none_are_never_accepted(self, client: Client, number: str) -> None:
        texts = [
            json.dumps(asked).replace("12345", number)
            for asked in (
                {"serials": ["A"], "order": {"kind": "camera_start", "fps_hz": 12345}},
                {
                    "serials": ["A"],
                    "order": {"kind": "mission", "waypoints": [{**WAYPOINT, "speed_mps": 12345}]},
                },
            )
        ]
        for text in texts:
            response = post(client, text)
            assert response.status_code in (200, 422)
            if response.status_code == 200:
                assert response.json()["results"][0]["accepted"] is False
            else:
                assert isinstance(response.json()["error"], str)

    @pytest.mark.parametrize(
        ("text", "sentence"),
        [
            ("", "body"),
            ("{", "JSON"),
            ("[]", "dictionary"),
            ('{"serials": [], "order": {"kind": "hover"}}', "serials"),
            ('{"serials": ["A"], "order": {"kind": "explode"}}', "order"),
            ('{"serials": ["A"], "order": {"kind": "hover", "now": 1}}', "now"),
            ('{"serials": ["A"], "takeoff": "yes", "order": {"kind": "hover"}}', "takeoff"),
            ('{"serials": ["A"], "takeoff": 1, "order": {"kind": "hover"}}', "takeoff"),
            ('{"serials": ["A"], "order": {"kind": "camera_start", "fps_hz": "1"}}', "fps_hz"),
            ('{"serials": ["A"], "order": {"kind": "camera_start"}}', "fps_hz"),
            ('{"serials": [1], "order": {"kind": "hover"}}', "serials"),
            ('{"serials": ["%s"], "order": {"kind": "hover"}}' % ("x" * 3000), "2048"),
        ],
    )
    def test_a_malformed_request_is_answered_in_one_sentence(
        self, client: Client, text: str, sentence: str
    ) -> None:
        response = post(client, text)
        assert response.status_code == 422
        assert sentence in response.json()["error"]

    @settings(max_examples=examples(100), deadline=None)
    @given(st.text(max_size=60))
    def test_any_serial_is_answered(self, serial: str) -> None:
        client = same_client()
        text = json.dumps({**HOVER, "serials": [serial]})
        response = post(client, text)
        assert response.status_code in (200, 422)
        state = client.get("/api/state")
        assert state.status_code == 200

    @settings(max_examples=examples(200), deadline=None)
    @given(
        st.recursive(
            st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=8),
            lambda inner: (
                st.lists(inner, max_size=3)
                | st.dictionaries(
                    st.sampled_from(["serials", "order", "kind", "takeoff", "waypoints", "x"]),
                    inner,
                    max_size=4,
                )
            ),
            max_leaves=12,
        )
    )
    def test_no_body_is_an_error_of_the_server(self, body: object) -> None:
        client = same_client()
        assert post(client, json.dumps(body)).status_code in (200, 422)

    def test_lone_surrogates_are_no_error_of_the_server(self, client: Client) -> None:
        response = post(client, '{"serials": ["\\ud800"], "order": {"kind": "hover"}}')
        assert response.status_code in (200, 422)
        assert client.get("/api/state").status_code == 200

    def test_a_long_body_is_refused_unread(self, client: Client) -> None:
        response = post(client, " " * (1024 * 1024 + 1))
        assert response.status_code == 413

    def test_a_body_of_unsaid_length_is_refused(self, client: Client) -> None:
        async def pieces() -> AsyncIterator[bytes]:
            yield b"{}"

        response = client.post("/api/orders", content=pieces())
        assert response.status_code == 411

    def test_all_stop_without_vehicles(self, client: Client) -> None:
        assert client.post("/api/all-stop").json() == {"results": []}

    def test_an_all_stop_is_released_by_a_request_of_its_own(self, client: Client) -> None:
        client.post("/api/all-stop")
        assert client.get("/api/state").json()["stop_latch"]["released"] == []
        assert client.post("/api/all-stop/release", json={}).status_code == 422
        asked = client.post("/api/all-stop/release", json={"serials": ["X"]}).json()
        assert (asked["accepted"], asked["rule"]) == (False, "stop_latch")
        assert client.post("/api/all-stop/release", json={"serials": None}).json()["accepted"]
        assert client.get("/api/state").json()["stop_latch"] is None

    @pytest.mark.parametrize("given", [-1, 2**53 + 1, "yesterday", 1.5])
    def test_a_time_that_is_none_is_refused(self, client: Client, given: object) -> None:
        assert (
            client.post("/api/orders", json=HOVER | {"given_at_unix_ms": given}).status_code == 422
        )

    def test_the_time_at_which_an_order_was_given_is_taken(self, client: Client) -> None:
        late = HOVER | {"takeoff": True, "given_at_unix_ms": 0}
        (answer,) = client.post("/api/orders", json=late).json()["results"]
        assert answer["rule"] == "reachable"

    @pytest.mark.parametrize("alarm_id", ["7", "-1", "9" * 40])
    def test_an_alarm_that_is_not_there(self, client: Client, alarm_id: str) -> None:
        response = client.post(f"/api/alarms/{alarm_id}/acknowledge")
        assert response.status_code in (404, 422)
        assert "error" in response.json()


class TestDoor:
    @pytest.mark.parametrize(
        "host", ["evil.example", "127.0.0.1.evil.example", "[", "[::1", "", "a@b:c:d"]
    )
    def test_a_foreign_name_is_refused(self, client: Client, host: str) -> None:
        response = client.get("/api/state", headers={"host": host})
        assert response.status_code == 400
        assert "is not this station's" in response.json()["error"]

    @pytest.mark.parametrize("host", ["127.0.0.1", "localhost:1", "[::1]:8080"])
    def test_our_names_are_let_in(self, client: Client, host: str) -> None:
        assert client.get("/api/state", headers={"host": host}).status_code == 200

    @pytest.mark.parametrize(
        "origin",
        ["http://evil.example", "null", "http://127.0.0.1:9999", "http://[", "", "127.0.0.1:8080"],
    )
    def test_a_foreign_page_is_refused(self, client: Client, origin: str) -> None:
        response = client.post("/api/all-stop", headers={"origin": origin})
        assert response.status_code == 403
        refused = client.open_stream("/api/stream", origin=origin)
        assert not refused.is_served
        assert refused.close_code == 1008

    def test_our_own_page_is_let_in(self, client: Client) -> None:
        response = client.post("/api/all-stop", headers={"origin": BASE})
        assert response.status_code == 200

    def test_a_token_guards_every_call(self, station: FakeStation) -> None:
        client = Client(application(station, access=Access.network(Login([user()]))))
        bad = [
            {},
            {"authorization": "Bearer wrong"},
            {"authorization": TOKEN},
            {"authorization": "Bearer"},
        ]
        for headers in bad:
            for path in ("/api/state", "/api/ground-image.png", "/%61pi/state"):
                assert client.get(path, headers=headers).status_code in (401, 429)
            assert client.post("/api/all-stop", headers=headers).status_code in (401, 429)
        good = {"authorization": f"Bearer {TOKEN}"}
        assert client.get("/api/state", headers=good).status_code == 200

    def test_a_token_guards_the_stream(self, station: FakeStation) -> None:
        client = Client(application(station, access=Access.network(Login([user()]))))
        wrong = TOKEN_PROTOCOL_PREFIX + "wrong"
        for protocols in ((), (PROTOCOL,), (PROTOCOL, wrong)):
            refused = client.open_stream("/api/stream", protocols=protocols)
            assert not refused.is_served
            assert refused.close_code == LOGIN_NEEDED
            assert refused.close_reason.startswith(("token missing", "token wrong"))
        offered = (PROTOCOL, TOKEN_PROTOCOL_PREFIX + TOKEN)
        opened = client.open_stream("/api/stream", protocols=offered)
        assert opened.subprotocol == PROTOCOL
        schema.StationState.model_validate_json(opened.first_text)

    def test_every_answer_keeps_foreign_content_out(self, client: Client) -> None:
        for path in ("/", "/api/state", "/nothing", "/openapi.json"):
            headers = client.get(path).headers
            for name, value in SECURITY_HEADERS.items():
                assert headers[name] == value
        policy = SECURITY_HEADERS["Content-Security-Policy"]
        assert "default-src 'self'" in policy
        assert "script-src" not in policy
        assert client.get("/api/state").headers["cache-control"] == "no-store"

    def test_another_websocket_path_is_refused(self, client: Client) -> None:
        assert not client.open_stream("/elsewhere").is_served


class TestConsole:
    @pytest.fixture
    def with_console(self, station: FakeStation, tmp_path: Path) -> Client:
        (tmp_path / "secret.txt").write_text("secret")
        console = tmp_path / "console"
        console.mkdir()
        (console / "index.html").write_text("<!doctype html>the console")
        (console / "app.js").write_text("1")
        (console / "link").symlink_to(tmp_path / "secret.txt")
        return Client(application(station, console=console))

    def test_files_are_served(self, with_console: Client) -> None:
        assert "the console" in with_console.get("/").text
        assert with_console.get("/app.js").status_code == 200
        assert with_console.get("/api/state").status_code == 200

    @pytest.mark.parametrize(
        "path",
        [
            "/../secret.txt",
            "/%2e%2e/secret.txt",
            "/..%2fsecret.txt",
            "/....//secret.txt",
            "/%2e%2e%5csecret.txt",
            "/app.js/../../secret.txt",
            "/link",
            "/%00",
            "/" + "a" * 5000,
        ],
    )
    def test_nothing_outside_is(self, with_console: Client, path: str) -> None:
        response = with_console.get(path)
        assert response.status_code == 404
        assert "secret" not in response.text.replace("secret.txt", "")

    def test_a_websocket_to_a_file_is_refused(self, with_console: Client) -> None:
        assert not with_console.open_stream("/app.js").is_served

    def test_without_one_a_page_describes_how_to_build_it(self, client: Client) -> None:
        assert "make web" in client.get("/").text


class TestPictures:
    def test_a_raw_frame_comes_as_jpeg(self, client: Client, station: FakeStation) -> None:
        station.put_frame("A/ü <b>", rgb_frame("A"))
        assert client.get("/api/vehicle/frame.jpg?serial=B").status_code == 404
        station.put_frame("A", rgb_frame("A"))
        response = client.get("/api/vehicle/frame.jpg?serial=A")
        assert response.headers["content-type"] == "image/jpeg"
        assert response.headers["x-frame-id"] == "7"
        bgr = cv2.imdecode(np.frombuffer(response.content, np.uint8), cv2.IMREAD_COLOR)
        assert bgr is not None
        assert bgr.shape == (32, 64, 3)
        assert bgr[16, 8, 2] > 200
        assert bgr[16, 56, 0] > 200

    def test_an_apps_own_jpeg_is_passed_on(self, client: Client, station: FakeStation) -> None:
        """Even if it is something else: the browser must not guess."""
        station.put_frame("A", Frame(1, "A", 0, 0, 0.25, jpeg=b"<script>"))
        response = client.get("/api/vehicle/frame.jpg?serial=A")
        assert response.content == b"<script>"
        assert response.headers["content-type"] == "image/jpeg"
        assert response.headers["x-content-type-options"] == "nosniff"

    def test_the_ground_image_is_transparent_where_nothing_was_seen(
        self, client: Client, station: FakeStation
    ) -> None:
        assert client.get("/api/ground-image.png").status_code == 404
        station.image = ground_image()
        response = client.get("/api/ground-image.png")
        assert response.headers["x-frame-id"] == "5"
        bgra = cv2.imdecode(np.frombuffer(response.content, np.uint8), cv2.IMREAD_UNCHANGED)
        assert bgra is not None
        assert bgra.shape == (20, 30, 4)
        assert bgra[0, 0].tolist() == [30, 20, 10, 255]
        assert bgra[19, 29, 3] == 0

    def test_the_geotiff_opens_at_its_place(self, client: Client, station: FakeStation) -> None:
        station.image = ground_image()
        response = client.get("/api/ground-image.tif")
        assert response.headers["content-type"] == "image/tiff"
        assert "recon-ground-5.tif" in response.headers["content-disposition"]
        with rasterio.open(io.BytesIO(response.content)) as opened:
            assert (opened.width, opened.height) == (30, 20)
            assert opened.crs is not None


def ground_image() -> GroundImage:
    grid = GroundGrid(LocalFrame(GeoPoint(41.9, -93.6, 275.0)), -15.0, 10.0, 1.0, 20, 30)
    rgb = np.full((20, 30, 3), (10, 20, 30), np.uint8)
    valid = np.ones((20, 30), np.bool_)
    valid[10:] = False
    pose = CameraPose(np.eye(3), np.array([0.0, 0.0, 100.0]))
    return GroundImage(grid, 5, 1_700_000_000_000_000_000, rgb, valid, pose)


class TestFleetReturn:
    def test_unknown_serials_are_refused_as_results_once_each(self, client: Client) -> None:
        response = client.post("/api/fleet-return", json={"serials": ["A", "B", "A"]})
        results = response.json()["results"]
        assert [(r["serial"], r["accepted"], r["rule"]) for r in results] == [
            ("A", False, "reachable"),
            ("B", False, "reachable"),
        ]

    def test_more_than_the_station_remembers_are_all_answered(self, client: Client) -> None:
        serials = [f"S{number}" for number in range(256)]
        results = client.post("/api/fleet-return", json={"serials": serials}).json()["results"]
        assert [result["serial"] for result in results] == serials

    def test_without_names_all_vehicles_are_called_and_here_are_none(self, client: Client) -> None:
        assert client.post("/api/fleet-return", json={}).json() == {"results": []}
        assert client.get("/api/state").json()["fleet_return"] is None

    @pytest.mark.parametrize("asked", [{"serials": []}, {"serials": "A"}, {"all": True}, [1]])
    def test_a_malformed_request_calls_no_vehicle(self, client: Client, asked: object) -> None:
        response = client.post("/api/fleet-return", json=asked)
        assert response.status_code == 422
        assert client.get("/api/commands").json() == []


class TestWatching:
    def test_only_a_hazard_area_can_be_dismissed(self, client: Client) -> None:
        response = client.post("/api/vehicle/hazard/dismiss?serial=A")
        assert response.status_code == 404
        assert "No hazard area" in response.json()["error"]

    def test_the_separation_holds_are_switched_and_shown(self, client: Client) -> None:
        assert client.get("/api/state").json()["station"]["separation_hold_on"] is True
        assert client.post("/api/separation-hold/off").status_code == 204
        assert client.get("/api/state").json()["station"]["separation_hold_on"] is False
        assert client.post("/api/separation-hold/on").status_code == 204
        assert client.get("/api/state").json()["station"]["separation_hold_on"] is True
        assert client.post("/api/separation-hold/maybe").status_code == 422
