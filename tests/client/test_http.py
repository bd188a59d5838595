"""Requests to faulty servers: one request each, and one error that states what is certain."""

import socket
from math import inf, nan

import pytest
from tests.client.raw_server import server
from tests.patient_loop import run_patiently

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

PROMPT_S = 60.0
"""Reached only by a broken client."""

SHORT_S = 0.5
"""In time that waits for this process: enough to be sent in."""

BODY = {"serials": ["SIM-1"], "order": {"kind": "land"}, "takeoff": False}


def response(status: str, body: bytes = b"", *headers: str) -> bytes:
    lines = [f"HTTP/1.1 {status}", f"Content-Length: {len(body)}", *headers]
    return ("\r\n".join(lines) + "\r\n\r\n").encode() + body


def problem_of(method: str, answer: bytes | None, within_s: float = PROMPT_S) -> ClientError:
    """Send one request and return the error; exactly one request was made."""

    async def main() -> ClientError:
        async with server(answer) as raw:
            http = Http(parse_address(raw.url), within_s)
            if method == "POST":
                request = http.post("/api/orders", BODY, OrderMessage, "results")
            else:
                request = http.get("/api/state", OrderMessage, "results")
            with pytest.raises(ClientError) as problem:
                await request
            await http.close()
            assert len(raw.requests) == 1
            return problem.value

    return run_patiently(main())


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"HTTP/1.1 200 OK\r\nContent-Length: 50\r\n\r\nhalf of it",
        b"SSH-2.0-something\r\n",
        response("500 Internal Server Error", b"Traceback"),
        response("503 Service Unavailable"),
        response("200 OK", b"<html>"),
        response("200 OK", b'{"results": 3}'),
        response("200 OK", b'{"results": [{}]}'),
        response("200 OK", b"\xff\xfe"),
        response("200 OK", b"\x1f\x8b\x08", "Content-Encoding: gzip"),
    ],
)
def test_an_order_without_a_valid_answer_may_have_been_sent(answer: bytes) -> None:
    problem = problem_of("POST", answer)
    assert isinstance(problem, MaybeSentError)
    assert "may have been sent and is not repeated" in str(problem)
    assert len(str(problem)) < 600


def test_an_order_that_is_not_answered_may_have_been_sent() -> None:
    problem = problem_of("POST", None, SHORT_S)
    assert isinstance(problem, MaybeSentError)
    assert "nothing within 0.5 s" in str(problem)


@pytest.mark.parametrize("method", ["GET", "POST"])
def test_an_oversized_answer_is_rejected(method: str) -> None:
    huge = b" " * (LONGEST_ANSWER_BYTES + 1)
    problem = problem_of(method, response("200 OK", huge))
    assert isinstance(problem, MaybeSentError if method == "POST" else BadAnswerError)
    assert f"up to {LONGEST_ANSWER_BYTES} bytes" in str(problem)


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize(
    ("answer", "sentence"),
    [
        (response("401 Unauthorized", b'{"error": "a token is needed"}'), "a token is needed"),
        (response("404 Not Found", b"nothing here"), "nothing here"),
        (response("307 Temporary", b"", "Location: http://127.0.0.1:9/"), "HTTP 307"),
    ],
)
def test_a_rejected_request_states_the_reason(method: str, answer: bytes, sentence: str) -> None:
    problem = problem_of(method, answer)
    assert isinstance(problem, RequestRefusedError)
    assert sentence in str(problem)


def test_an_invalid_order_raises_its_own_error() -> None:
    problem = problem_of("POST", response("422 Unprocessable", b'{"error": "speed: too fast"}'))
    assert isinstance(problem, OrderInvalidError)
    assert str(problem) == "speed: too fast"


def test_numbers_that_are_not_finite_are_not_sent() -> None:
    async def main() -> None:
        http = Http(parse_address("http://127.0.0.1:9"), PROMPT_S)
        try:
            for value in (nan, inf):
                with pytest.raises(OrderInvalidError, match="expected finite numbers"):
                    await http.post("/x", {"height_m": value}, OrderMessage, "an answer")
        finally:
            await http.close()

    run_patiently(main())


@pytest.mark.parametrize("answer", [b"", b"SSH-2.0-x\r\n", None])
def test_a_get_request_without_an_answer(answer: bytes | None) -> None:
    assert isinstance(problem_of("GET", answer, SHORT_S), StationUnreachableError)


def test_without_a_listener_nothing_was_sent() -> None:
    async def main() -> None:
        with socket.create_server(("127.0.0.1", 0)) as unused:
            url = f"http://127.0.0.1:{unused.getsockname()[1]}"
        http = Http(parse_address(url), PROMPT_S)
        with pytest.raises(StationUnreachableError, match="nothing was ordered"):
            await http.post("/api/orders", BODY, OrderMessage, "results")
        await http.close()

    run_patiently(main())


def test_proxy_variables_are_ignored(monkeypatch: pytest.MonkeyPatch) -> None:
    async def main() -> None:
        async with server(response("200 OK", b'{"results": []}')) as raw:
            http = Http(parse_address(raw.url, "secret-1"), PROMPT_S)
            assert await http.post("/api/orders", BODY, OrderMessage, "x") == OrderMessage(())
            await http.close()
            assert b"Authorization: Bearer secret-1" in raw.requests[0]

    for name in ("HTTP_PROXY", "ALL_PROXY", "http_proxy", "all_proxy"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    run_patiently(main())
