"""A replay orders nothing: every route of the API's document, and whatever a stream is sent."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import pytest
import websockets
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.api.serving import serving
from tests.patient_loop import run_patiently
from tests.replay.flights import FOLDER

from recon.api.permissions import LEAST_ROLE, STREAM
from recon.api.replay_routes import NO_ORDERS, NO_REPLAY, TRANSPORT
from recon.api.security import Access, AccessCheck
from recon.station.api_views.app import create_app
from recon.station.host.replay_run import ReplayStation, replay_service
from recon.station.recording.playback import Playback

FLIGHT = FOLDER / "survey.mcap"


@dataclass(frozen=True)
class Scene:
    """A replay with its application."""

    replay: ReplayStation
    app: AccessCheck

    @property
    def client(self) -> Client:
        return Client(self.app)


@pytest.fixture
def scene() -> Iterator[Scene]:
    playback = Playback(FLIGHT)
    replay = ReplayStation(FLIGHT, playback, lambda: 0.0)
    app = create_app(replay_service(replay), None, "1.2.3", replay=replay)
    yield Scene(replay, AccessCheck(app, Access()))
    playback.close()


def requests() -> list[tuple[str, str]]:
    """Every method and path of the document, with names and numbers of the recorded flight."""
    document = create_app(FakeStation(), None, "1.2.3").openapi()
    return [
        (method.upper(), re.sub(r"\{\w+\}", "1", path))
        for path, methods in document["paths"].items()
        for method in methods
    ]


def test_every_route_that_does_not_read_is_refused_with_one_sentence(scene: Scene) -> None:
    before = scene.replay.station
    changing = [each for each in requests() if each[0] != "GET" and each[1] != TRANSPORT]
    assert len(changing) >= 20
    for method, path in [*changing, ("DELETE", "/api/state"), ("PUT", "/api/orders")]:
        answers = [scene.client.ask(method, path, json={}), scene.client.ask(method, path)]
        for answer in answers:
            assert answer.status_code == 409, (method, path)
            assert answer.json() == {"error": NO_ORDERS}
    assert scene.replay.station is before


def test_every_route_that_reads_answers_and_changes_nothing(scene: Scene) -> None:
    scene.client.post(TRANSPORT, json={"position_s": 30.0})
    before = scene.replay.station
    for method, path in requests():
        if method == "GET":
            answer = scene.client.get(f"{path}?serial=SIM-1&latitude_deg=45&longitude_deg=9")
            assert answer.status_code in (200, 404, 422), path
    assert scene.replay.station is before


def test_no_stream_takes_anything(scene: Scene) -> None:
    """Also as the owner of steered orders; a stream that the table does not name is none."""
    streams = [path for method, path in LEAST_ROLE if method == STREAM]
    before = scene.replay.station

    async def main(url: str) -> None:
        for path in (*streams, "/api/stream?owner=a-name-of-a-owner-01"):
            async with websockets.connect(url.replace("http", "ws", 1) + path) as socket:
                for message in ('{"order": {"kind": "goto"}}', "keepalive", b"\x00\xff", "{}"):
                    await socket.send(message)
                if "audit" not in path:
                    await socket.recv()

    async def served() -> None:
        async with serving(scene.app) as url:
            await main(url)

    run_patiently(served())
    assert scene.replay.station is before


def test_the_transport_moves_the_state(scene: Scene) -> None:
    first = scene.client.get("/api/state").json()
    assert first["replay"] == {
        "file": "survey.mcap",
        "duration_s": 48.5,
        "position_s": 0.0,
        "speed": 1.0,
        "is_playing": False,
        "trouble": None,
    }
    answer = scene.client.post(TRANSPORT, json={"position_s": 20, "speed": 2, "is_playing": True})
    assert answer.json() == {
        **first["replay"],
        "position_s": 20.0,
        "speed": 2.0,
        "is_playing": True,
    }
    state = scene.client.get("/api/state").json()
    assert state["time_ns"] - first["time_ns"] == 20_000_000_000
    assert [each["serial"] for each in state["vehicles"]] == ["SIM-1", "SIM-2"]
    for wrong in ({"speed": 0.05}, {"speed": 51}, {"position_s": -1}, {"is_playing": "yes"}):
        assert scene.client.post(TRANSPORT, json=wrong).status_code == 422
    assert scene.replay.view().speed == 2.0


def test_a_live_station_replays_nothing() -> None:
    client = Client(application(FakeStation()))
    for answer in (client.get("/api/replay/marks"), client.post(TRANSPORT, json={})):
        assert answer.status_code == 404
        assert answer.json() == {"error": NO_REPLAY}
    assert client.get("/api/state").json()["replay"] is None
