"""One server, asked politely: a few requests at once, each bounded, again after a pause.

Answers are read as they are: no redirect is followed, nothing is unpacked.
"""

import asyncio
import re
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import TypeVar

import httpx

from recon import version
from recon.model.errors import ReconError
from recon.model.foreign_text import one_line

AT_ONCE = 2
"""Requests at once, as the usage policies of public servers require."""
SILENT_S = 20.0
"""Longest wait for the next byte."""
TRIES = 3
PAUSE_S = 1.0
"""Pause before a second try, doubled before the third."""
LONGEST_PAUSE_S = 60.0
"""Longest pause, whatever a busy server asks for."""
USER_AGENT = f"Recon/{version()} (ground control station; offline data of one field)"
OK, NO_CONTENT, PARTIAL, NOT_FOUND, GONE = 200, 204, 206, 404, 410
REFUSED = frozenset({401, 402, 403})

T = TypeVar("T")


class FetchError(ReconError):
    """Something cannot be fetched; the text states what was expected, what came, what to do."""

    is_failure = True


class AskFailedError(Exception):
    """One request failed; perhaps another try succeeds, `after_s` from now."""

    def __init__(
        self, problem: str, after_s: float = 0.0, tries_again: bool = True, status: int = 0
    ) -> None:
        super().__init__(problem)
        self.after_s = after_s
        self.tries_again = tries_again
        self.status = status
        """Status of the answer; 0 without one."""


@dataclass(frozen=True, slots=True)
class AskedServer:
    """Whom errors name, and what is expected of it."""

    host: str
    """The name alone: an address may hold a key."""
    expected: str
    """In the plural, or without number: tiles, weather."""
    error: type[ReconError] = FetchError
    """What a refusal raises, which no other try changes."""

    def has(self, answer: httpx.Response) -> bool:
        """Return whether the answer has what was asked for; False where it does not exist.

        Raises `AskFailedError`, or the server's error where it refuses.
        """
        status = answer.status_code
        if status in (OK, PARTIAL):
            return True
        if status in (NO_CONTENT, NOT_FOUND, GONE):
            return False
        if status in REFUSED:
            raise self.error(
                f"{self.host}: expected {self.expected}, got status {status}: it refuses; is its "
                "key in the address, and does its licence allow offline use?"
            )
        if answer.is_redirect:
            place = one_line(answer.headers.get("location", "nowhere"))
            raise self.error(
                f"{self.host}: expected {self.expected}, got a redirect to {place!a}; if that is "
                "right, give its address"
            )
        raise AskFailedError(f"status {status}", _asked_pause_s(answer), status=status)


@asynccontextmanager
async def polite_client(accept: str) -> AsyncIterator[httpx.AsyncClient]:
    """Give a client that states who asks, and takes answers of these media types."""
    headers = {"User-Agent": USER_AGENT, "Accept-Encoding": "identity", "Accept": accept}
    limits = httpx.Limits(max_connections=AT_ONCE)
    async with httpx.AsyncClient(
        headers=headers, timeout=SILENT_S, follow_redirects=False, limits=limits
    ) as client:
        yield client


async def with_tries(ask: Callable[[], Awaitable[T]], pause_s: float = PAUSE_S) -> T:
    """Return what one of a few tries gives; raises the last one's `AskFailedError`."""
    for left in reversed(range(TRIES)):
        try:
            return await ask()
        except AskFailedError as problem:
            if left == 0 or not problem.tries_again:
                raise
            await asyncio.sleep(min(LONGEST_PAUSE_S, max(pause_s, problem.after_s)))
            pause_s *= 2.0
    raise AssertionError("the last try returns or raises")


@asynccontextmanager
async def answered(
    client: httpx.AsyncClient,
    url: str,
    server: AskedServer,
    within_s: float,
    headers: Mapping[str, str] | None = None,
) -> AsyncIterator[httpx.Response | None]:
    """Give a server's answer, not yet read; None where it has nothing under the address.

    Raises `AskFailedError`, also while the answer is read, or the server's error.
    """
    try:
        async with (
            asyncio.timeout(within_s),
            client.stream("GET", url, headers=headers) as answer,
        ):
            yield answer if server.has(answer) else None
    except TimeoutError as problem:
        raise AskFailedError(f"no answer within {within_s:g} s") from problem
    except (httpx.HTTPError, httpx.InvalidURL) as problem:
        raise AskFailedError(one_line(problem) or type(problem).__name__) from problem


async def body_of(answer: httpx.Response, largest_bytes: int, what: str) -> bytes:
    """Return an answer's body, at most so long; raises `AskFailedError` for a longer one."""
    parts, length = [], 0
    async for part in answer.aiter_raw():
        parts.append(part)
        length += len(part)
        if length > largest_bytes:
            raise AskFailedError(
                f"expected {what} of at most {largest_bytes} bytes, got more", tries_again=False
            )
    return b"".join(parts)


def _asked_pause_s(answer: httpx.Response) -> float:
    text = answer.headers.get("retry-after", "")
    return float(text) if re.fullmatch(r"\d{1,4}", text) else 0.0
