"""Login by token: who gets in, what wrong tokens cost, and streams of users that are removed."""

import asyncio
import re
from dataclasses import dataclass, field

import cv2
import numpy as np
import pytest
import websockets
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.api.serving import PATIENCE_S, serving
from tests.api.test_owners import read_on
from tests.examples import examples
from tests.patient_loop import run_patiently
from tests.persons import TOKEN, user

from recon.api import login as login_module
from recon.api.addresses import SharedAddress
from recon.api.login import FAILURES_OVERALL, FAILURES_PER_ADDRESS, WINDOW_S, Login, RefusedRequest
from recon.api.security import LOGIN_NEEDED, Access, AccessCheck
from recon.model.event import LoginAccepted, LoginRefused
from recon.model.person import Person, Role
from recon.station.api_views.app import create_app


def read_code(svg: str) -> str:
    """The text of a drawn QR code, as a camera reads it: rows of modules, drawn as strokes."""
    (path,) = re.findall(r'class="qrline"[^>]* d="([^"]+)"|d="(M[^"]+)" class="qrline"', svg)
    picture = np.full((60, 60), 255, np.uint8)
    x = y = 0.0
    for kind, first, second in re.findall(r"([Mmh])([\d.-]+)(?: ([\d.-]+))?", "".join(path)):
        if kind == "h":
            picture[int(y), int(x) : int(x + float(first))] = 0
            x += float(first)
        else:
            x, y = (0.0, 0.0) if kind == "M" else (x, y)
            x, y = x + float(first), y + float(second)
    text, _, _ = cv2.QRCodeDetector().detectAndDecode(np.kron(picture, np.ones((8, 8), np.uint8)))
    return str(text)


HERE, ELSEWHERE = "192.0.2.7", "192.0.2.8"


@dataclass
class Bench:
    """A login with a clock set by hand, and what it reported."""

    now_s: float = 1000.0
    reported: list[LoginAccepted | LoginRefused] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.login = Login([user()], self.reported.append, lambda: self.now_s)

    def status(self, token: str, address: str = HERE) -> int:
        answer = self.login.person(token, address)
        return answer.status if isinstance(answer, RefusedRequest) else 200


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_a_token_names_its_user_with_role_and_address(bench: Bench) -> None:
    assert bench.login.person(TOKEN, HERE) == Person("cleo", Role.OPERATOR, HERE)
    assert bench.login.person(TOKEN, HERE) == Person("cleo", Role.OPERATOR, HERE)
    assert bench.reported == [LoginAccepted(f"cleo ({HERE})", "operator")]


def test_wrong_tokens_are_limited_per_address(bench: Bench) -> None:
    assert [bench.status("wrong") for _ in range(8)] == [401] * FAILURES_PER_ADDRESS + [429] * 3
    assert len(bench.reported) == FAILURES_PER_ADDRESS
    assert bench.reported[-1] == LoginRefused(HERE, FAILURES_PER_ADDRESS, is_repeated=True)
    answer = bench.login.person("wrong", HERE)
    assert isinstance(answer, RefusedRequest)
    assert answer.retry_after_s == WINDOW_S
    bench.now_s += WINDOW_S
    assert bench.status("wrong") == 401


def test_a_right_token_gets_in_whatever_wrong_ones_came(bench: Bench) -> None:
    for number in range(2 * FAILURES_OVERALL):
        bench.status("wrong", f"192.0.2.{number}")
    for address in (HERE, ELSEWHERE, "192.0.2.1"):
        assert bench.status(TOKEN, address) == 200


def test_wrong_tokens_of_many_addresses_are_limited_together(bench: Bench) -> None:
    statuses = [bench.status("wrong", f"198.51.100.{number}") for number in range(60)]
    assert statuses == [401] * FAILURES_OVERALL + [429] * 10
    assert sum(isinstance(r, LoginRefused) and r.is_repeated for r in bench.reported) == 1


def test_one_computer_has_many_ipv6_addresses(bench: Bench) -> None:
    statuses = [bench.status("wrong", f"2001:db8::{number:x}") for number in range(7)]
    assert statuses == [401] * FAILURES_PER_ADDRESS + [429] * 2
    assert bench.status("wrong", "2001:db8:0:1::1") == 401


def test_memory_is_bounded(bench: Bench) -> None:
    for number in range(3 * login_module.MAX_ADDRESSES):
        bench.status("wrong", f"10.0.{number // 250}.{number % 250}")
        bench.status(TOKEN, f"10.1.{number // 250}.{number % 250}")
    assert len(bench.login._by_address._windows) == login_module.MAX_ADDRESSES
    assert len(bench.login._reported) == login_module.MAX_LOGINS


@settings(max_examples=examples(300), deadline=None)
@given(st.text(max_size=60), st.text(max_size=40))
def test_no_other_token_gets_in(token: str, address: str) -> None:
    bench = Bench()
    assert (bench.status(token, address) == 200) is (token == TOKEN)


@settings(max_examples=examples(200), deadline=None)
@given(st.binary(max_size=80))
def test_any_token_header_is_answered(value: bytes) -> None:
    client = Client(application(FakeStation(), access=Access.network(Login([user()]))))
    for header in (b"Bearer " + value, value):
        response = client.get("/api/state", headers=[(b"authorization", header)])
        assert response.status_code == 401
        assert isinstance(response.json()["error"], str)


class TestRequests:
    def test_without_a_token_nothing_of_the_api_is_answered(self) -> None:
        login = Login([user()])
        client = Client(application(FakeStation(), access=Access.network(login)))
        for _ in range(3 * FAILURES_PER_ADDRESS):
            response = client.get("/api/state")
            assert response.status_code == 401
            assert response.json()["error"].startswith("token missing")
        assert client.get("/").status_code == 200

    def test_beyond_the_limit_it_states_when_to_come_again(self) -> None:
        client = Client(application(FakeStation(), access=Access.network(Login([user()]))))
        wrong = {"authorization": "Bearer wrong"}
        for _ in range(FAILURES_PER_ADDRESS):
            assert client.get("/api/state", headers=wrong).status_code == 401
        response = client.get("/api/state", headers=wrong)
        assert response.status_code == 429
        assert 0 < int(response.headers["retry-after"]) <= WINDOW_S
        assert response.headers["connection"] == "close"
        right = {"authorization": f"Bearer {TOKEN}"}
        assert client.post("/api/all-stop", headers=right).status_code == 200

    def test_it_states_the_person_and_the_address_for_other_computers(self) -> None:
        shared = SharedAddress(("https://192.0.2.5:8443",), ":".join(["AB"] * 32))
        app = create_app(FakeStation(), None, "1.2.3", shared)
        client = Client(AccessCheck(app, Access(Login([user()]))))
        local = client.get("/api/access").json()
        assert (local["role"], local["is_logged_in"]) == ("admin", False)
        named = client.get("/api/access", headers={"authorization": f"Bearer {TOKEN}"}).json()
        assert named == {
            "name": "cleo",
            "role": "operator",
            "is_logged_in": True,
            "urls": ["https://192.0.2.5:8443"],
            "fingerprint": shared.fingerprint,
        }
        assert shared.login_url == f"https://192.0.2.5:8443/#fingerprint={'AB' * 32}"
        code = client.get("/api/access/qr.svg")
        assert code.headers["content-type"] == "image/svg+xml"
        assert b"<svg" in code.content
        alone = Client(application(FakeStation()))
        assert alone.get("/api/access/qr.svg").status_code == 404
        assert alone.get("/api/access").json()["urls"] == []

    def test_the_address_for_apps_is_a_code_that_a_phone_reads(self) -> None:
        station = FakeStation()
        client = Client(application(station))
        nothing = client.get("/api/apps/qr.svg")
        assert nothing.status_code == 404
        assert "--link-host" in nothing.json()["error"]
        station.app_url = "recon://192.0.2.5:3001"
        assert client.get("/api/state").json()["station"]["app_url"] == "recon://192.0.2.5:3001"
        code = client.get("/api/apps/qr.svg")
        assert code.headers["content-type"] == "image/svg+xml"
        assert read_code(code.text) == "recon://192.0.2.5:3001"

    def test_over_loopback_a_token_that_is_given_is_checked(self) -> None:
        access = Access(Login([user(role=Role.OBSERVER)]))
        client = Client(application(FakeStation(), access=access))
        off = "/api/separation-hold/off"
        assert client.post(off).status_code == 204
        assert client.post(off, headers={"authorization": "Bearer wrong"}).status_code == 401
        named = client.post(off, headers={"authorization": f"Bearer {TOKEN}"})
        assert named.status_code == 403
        assert "cleo has the role observer" in named.json()["error"]


@pytest.mark.parametrize("after", [[], [user(token="another")], [user(role=Role.OBSERVER)]])
def test_a_stream_ends_when_its_user_is_removed_renewed_or_changed(after: list[object]) -> None:
    async def main() -> None:
        login = Login([user()])
        app = application(FakeStation(), access=Access.network(login))
        async with asyncio.timeout(PATIENCE_S), serving(app) as url:
            stream = url.replace("http", "ws") + "/api/stream"
            headers = {"Authorization": f"Bearer {TOKEN}"}
            async with websockets.connect(stream, additional_headers=headers) as reader:
                await reader.recv()
                login.users = tuple(after)  # type: ignore[assignment]
                with pytest.raises(websockets.ConnectionClosed) as closed:
                    await read_on(reader)
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == LOGIN_NEEDED
            assert closed.value.rcvd.reason.startswith("logged out")

    run_patiently(main())
