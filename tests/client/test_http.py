"""Requests to servers that misbehave: one request each, and one sentence that says what is sure."""

import asyncio
import socket

import pytest
from tests.client.misbehaving import server

from recon.client import (
    BadAnswerError,
    ClientError,
    MaybeSentError,
    RequestRefusedError,
    StationUnreachableError,
)
from recon.client.address import parse_address
from recon.client.errors import OrderInvalidError
from recon.client.http import LONGEST_ANSWER_BYTES, Http
from recon.client.messages import OrderMessage

PROMPT_S = 5.0
SHORT_S = 0.2
BODY = {"serials": ["SIM-1"], "order": {"kind": "land"}, "takeoff": False}


def said(status: str, body: bytes = b"", *headers: str) -> bytes:
    lines = [f"HTTP/1.1 {status}", f"Content-Length: {len(body)}", *headers]
    return ("\r\n".join(lines) + "\r\n\r\n").encode() + body


def problem_of(method: str, answer: bytes | None, within_s: float = PROMPT_S) -> ClientError:
    """Ask once; return what is raised. However it ends, one request was made."""

    async def main() -> ClientError:
        async with server(answer) as here:
            http = Http(parse_address(here.url), within_s)
            if method == "POST":
                asking = http.post("/api/orders", BODY, OrderMessage, "results")
            else:
                asking = http.get("/api/state", OrderMessage, "results")
            with pytest.raises(ClientError) as problem:
                await asking
            await http.close()
            assert len(here.requests) == 1
            return problem.value

    return asyncio.run(main())


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"HTTP/1.1 200 OK\r\nContent-Length: 50\r\n\r\nhalf of it",
        b"SSH-2.0-something\r\n",
        said("500 Internal Server Error", b"Traceback"),
        said("503 Service Unavailable"),
        said("200 OK", b"<html>"),
        said("200 OK", b'{"results": 3}'),
        said("200 OK", b'{"results": [{}]}'),
        said("200 OK", b"\xff\xfe"),
        said("200 OK", b"\x1f\x8b\x08", "Content-Encoding: gzip"),
    ],
)
def test_an_order_without_a_usable_answer_may_have_been_sent(answer: bytes) -> None:
    problem = problem_of("POST", answer)
    assert isinstance(problem, MaybeSentError)
    assert "may have been sent and is not repeated" in str(problem)
    assert len(str(problem)) < 600


def test_an_order_that_is_not_answered_may_have_been_sent() -> None:
    problem = problem_of("POST", None, SHORT_S)
    assert isinstance(problem, MaybeSentError)
    assert "nothing within 0.2 s" in str(problem)


@pytest.mark.parametrize("method", ["GET", "POST"])
def test_an_endless_answer_is_not_kept(method: str) -> None:
    huge = b" " * (LONGEST_ANSWER_BYTES + 1)
    problem = problem_of(method, said("200 OK", huge))
    assert isinstance(problem, MaybeSentError if method == "POST" else BadAnswerError)
    assert f"up to {LONGEST_ANSWER_BYTES} bytes" in str(problem)


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize(
    ("answer", "sentence"),
    [
        (said("401 Unauthorized", b'{"error": "a token is needed"}'), "a token is needed"),
        (said("404 Not Found", b"nothing here"), "nothing here"),
        (said("307 Temporary", b"", "Location: http://127.0.0.1:9/"), "HTTP 307"),
    ],
)
def test_a_refused_request_says_why(method: str, answer: bytes, sentence: str) -> None:
    problem = problem_of(method, answer)
    assert isinstance(problem, RequestRefusedError)
    assert sentence in str(problem)


def test_an_order_of_a_wrong_form_is_its_own_case() -> None:
    problem = problem_of("POST", said("422 Unprocessable", b'{"error": "speed: too fast"}'))
    assert isinstance(problem, OrderInvalidError)
    assert str(problem) == "speed: too fast"


@pytest.mark.parametrize("answer", [b"", b"SSH-2.0-x\r\n", None])
def test_a_question_without_an_answer(answer: bytes | None) -> None:
    assert isinstance(problem_of("GET", answer, SHORT_S), StationUnreachableError)


def test_where_nothing_listens_nothing_was_sent() -> None:
    async def main() -> None:
        with socket.create_server(("127.0.0.1", 0)) as taken:
            url = f"http://127.0.0.1:{taken.getsockname()[1]}"
        http = Http(parse_address(url), PROMPT_S)
        with pytest.raises(StationUnreachableError, match="nothing was ordered"):
            await http.post("/api/orders", BODY, OrderMessage, "results")
        await http.close()

    asyncio.run(main())


def test_proxies_of_the_environment_do_not_get_orders(monkeypatch: pytest.MonkeyPatch) -> None:
    async def main() -> None:
        async with server(said("200 OK", b'{"results": []}')) as here:
            http = Http(parse_address(here.url, "secret-1"), PROMPT_S)
            assert await http.post("/api/orders", BODY, OrderMessage, "x") == OrderMessage(())
            await http.close()
            assert b"Authorization: Bearer secret-1" in here.requests[0]

    for name in ("HTTP_PROXY", "ALL_PROXY", "http_proxy", "all_proxy"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    asyncio.run(main())
