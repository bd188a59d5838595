"""HTTP requests to the station, never repeated.

No connection is kept alive: the station might close an idle one just as an order is written to it,
and the client could not tell whether the order arrived.
"""

import asyncio
import json
from typing import Any, TypeVar

import httpx

from recon.client.address import Address
from recon.client.errors import (
    LOGIN_ADVICE,
    BadAnswerError,
    MaybeSentError,
    OrderInvalidError,
    RequestRefusedError,
    StationUnreachableError,
)
from recon.client.messages import ProblemMessage, decode, shown
from recon.client.trust import CertificateTrust, is_untrusted

LONGEST_ANSWER_BYTES = 16 * 1024 * 1024
ORDER_INVALID = 422
LOGIN_NEEDED = 401
ROLE_TOO_LOW = 403
PICTURE_NUMBER, MOST_DIGITS = "X-Frame-Id", 18

M = TypeVar("M")


class Http:
    """Requests to one station."""

    def __init__(
        self, address: Address, answer_within_s: float, trust: CertificateTrust | None = None
    ) -> None:
        self._address = address
        self._trust = trust or CertificateTrust(address)
        self._answer_within_s = answer_within_s
        self._client = httpx.AsyncClient(
            base_url=address.http,
            headers={**address.headers, "Accept-Encoding": "identity"},
            verify=self._trust.context,
            timeout=answer_within_s,
            # Ignore proxy variables: the station is on the local network.
            trust_env=False,
            follow_redirects=False,
            limits=httpx.Limits(max_connections=None, max_keepalive_connections=0),
        )

    async def close(self) -> None:
        """Close all connections."""
        await self._client.aclose()

    async def get(self, path: str, kind: type[M], expected: str) -> M:
        """Return the decoded response to a GET request; raises `ClientError`."""
        _response, data = await self._get(path)
        return decode(data, kind, expected)

    async def get_picture(self, path: str) -> tuple[bytes, int]:
        """Return a picture or a map, and the number that the state shows for it."""
        response, data = await self._get(path)
        number = response.headers.get(PICTURE_NUMBER, "")
        if not (number.isascii() and number.isdigit() and len(number) <= MOST_DIGITS):
            raise BadAnswerError(f"{path}: expected a number in {PICTURE_NUMBER}, got {number!r}")
        return data, int(number)

    async def _get(self, path: str) -> tuple[httpx.Response, bytes]:
        try:
            response, data = await self._send("GET", path, None)
        except (httpx.HTTPError, httpx.InvalidURL, TimeoutError) as problem:
            raise self._unreachable(problem) from problem
        self._check_status(response.status_code, data, path)
        return response, data

    async def post(self, path: str, body: Any, kind: type[M], expected: str) -> M:
        """Send a POST request once and return the decoded response.

        Raises `StationUnreachableError` (nothing was sent), `RequestRefusedError` (not executed),
        or `MaybeSentError` (anything else).
        """
        try:
            content = None if body is None else json.dumps(body, allow_nan=False).encode()
        except ValueError as problem:
            raise OrderInvalidError(
                "expected finite numbers, got NaN or an infinite one; nothing was sent"
            ) from problem
        try:
            response, data = await self._send("POST", path, content)
        except (httpx.ConnectError, httpx.ConnectTimeout) as problem:
            raise self._unreachable(problem) from problem
        except (httpx.HTTPError, TimeoutError, BadAnswerError) as problem:
            raise self._maybe_sent(_reason(problem, self._answer_within_s)) from problem
        if response.status_code >= 500:
            raise self._maybe_sent(f"HTTP {response.status_code}: {shown(data)}")
        self._check_status(response.status_code, data, path)
        try:
            return decode(data, kind, expected)
        except BadAnswerError as problem:
            raise self._maybe_sent(str(problem)) from problem

    async def post_without_result(self, path: str) -> None:
        """Send a POST request whose response has no body; raises as `post` does."""
        try:
            response, data = await self._send("POST", path, None)
        except (httpx.ConnectError, httpx.ConnectTimeout) as problem:
            raise self._unreachable(problem) from problem
        except (httpx.HTTPError, TimeoutError, BadAnswerError) as problem:
            raise self._maybe_sent(_reason(problem, self._answer_within_s)) from problem
        self._check_status(response.status_code, data, path)

    async def _send(
        self, method: str, path: str, content: bytes | None
    ) -> tuple[httpx.Response, bytes]:
        await self._trusted()
        headers = {} if content is None else {"Content-Type": "application/json"}
        async with (
            asyncio.timeout(self._answer_within_s),
            self._client.stream(method, path, content=content, headers=headers) as response,
        ):
            data = bytearray()
            async for chunk in response.aiter_raw():
                data += chunk
                if len(data) > LONGEST_ANSWER_BYTES:
                    raise BadAnswerError(
                        f"expected an answer of up to {LONGEST_ANSWER_BYTES} bytes, got a longer "
                        "one: is this a Recon station?"
                    )
            return response, bytes(data)

    async def _trusted(self) -> None:
        try:
            await self._trust.prepare()
        except OSError as problem:
            raise self._unreachable(problem) from problem

    def _check_status(self, status: int, data: bytes, path: str) -> None:
        if 200 <= status < 300:
            return
        try:
            reason = decode(data, ProblemMessage, "a problem").error
        except BadAnswerError:
            reason = shown(data)
        if status == ORDER_INVALID:
            raise OrderInvalidError(reason)
        if status == ROLE_TOO_LOW:
            raise RequestRefusedError(f"refused (role): {reason}")
        if status == LOGIN_NEEDED:
            reason = f"{reason}; {LOGIN_ADVICE}"
        raise RequestRefusedError(
            f"{self._address.http}{path}: refused (HTTP {status}): {reason}; nothing was executed"
        )

    def _unreachable(self, problem: Exception) -> StationUnreachableError:
        if is_untrusted(problem):
            return self._trust.untrusted()
        return StationUnreachableError(
            f"expected a station at {self._address.http}, got none "
            f"({_reason(problem, self._answer_within_s)}); nothing was ordered: start it with "
            "`recon run`, or check the address"
        )

    def _maybe_sent(self, reason: str) -> MaybeSentError:
        return MaybeSentError(
            f"expected the station's answer to an order, got no valid one ({reason}); the order "
            "may have been sent and is not repeated: check the vehicle before sending it again"
        )


def _reason(problem: Exception, answer_within_s: float) -> str:
    if isinstance(problem, TimeoutError | httpx.TimeoutException):
        return f"nothing within {answer_within_s:g} s"
    return str(problem) or type(problem).__name__
