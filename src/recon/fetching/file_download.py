"""A large file of a server, fetched into a file: resumed by the byte, there only when whole.

What has come is in `NAME.part`, with the server's mark of the version (its ETag) in `NAME.etag`. A
later try asks for the rest of the same version; without a mark it begins again.
"""

import os
import re
import time
from collections.abc import Callable
from pathlib import Path

import httpx

from recon.fetching.polite_client import (
    PARTIAL,
    PAUSE_S,
    AskedServer,
    AskFailedError,
    answered,
    with_tries,
)

FILE_WITHIN_S = 3_600.0
"""Half a gigabyte at 140 kB/s."""
SLOW_S, LEAST_BYTES = 30.0, 64 * 1024
"""Each such time must bring so much: a server that drips is left."""
RANGE_NOT_SATISFIABLE = 416

Received = Callable[[int], None]
"""Is given how many bytes of the file are there."""


async def download(
    client: httpx.AsyncClient,
    url: str,
    server: AskedServer,
    path: Path,
    largest_bytes: int,
    received: Received = lambda _: None,
    pause_s: float = PAUSE_S,
) -> bool:
    """Fetch a file if it is not there yet; return False where the server has none.

    Raises `AskFailedError` or the server's error; what has come by then is kept for a later call.
    """

    async def once() -> bool:
        return await _Part(path).rest(client, url, server, largest_bytes, received)

    return path.exists() or await with_tries(once, pause_s)


class _Part:
    """A file that is not whole yet."""

    def __init__(self, path: Path) -> None:
        self._whole = path
        self._data = path.with_name(path.name + ".part")
        self._etag = path.with_name(path.name + ".etag")

    async def rest(
        self,
        client: httpx.AsyncClient,
        url: str,
        server: AskedServer,
        largest_bytes: int,
        received: Received,
    ) -> bool:
        """Fetch what is missing; return False where the server has no such file."""
        etag = self._etag.read_text(encoding="ascii") if self._etag.exists() else ""
        present = self._data.stat().st_size if etag and self._data.exists() else 0
        headers = {"Range": f"bytes={present}-", "If-Range": etag} if present else {}
        try:
            async with answered(client, url, server, FILE_WITHIN_S, headers) as answer:
                if answer is None:
                    return False
                begins = self._begins_at(answer, present)
                await self._append(answer, begins, largest_bytes, received)
        except AskFailedError as problem:
            if not problem.tries_again or problem.status == RANGE_NOT_SATISFIABLE:
                self._forget()
            raise
        os.replace(self._data, self._whole)
        self._etag.unlink(missing_ok=True)
        return True

    def _begins_at(self, answer: httpx.Response, present: int) -> int:
        """Return the first byte of an answer; what is there beyond it is dropped."""
        if answer.status_code != PARTIAL:
            self._note(answer.headers.get("etag", ""))
            return 0
        stated = answer.headers.get("content-range", "")
        if not present or not stated.startswith(f"bytes {present}-"):
            self._forget()
            raise AskFailedError("expected the rest of the file, got another part of it")
        return present

    def _note(self, etag: str) -> None:
        # A weak mark (W/) names files that only mean the same: their bytes do not fit together.
        if re.fullmatch(r'"[!#-~]{1,200}"', etag):
            self._etag.write_text(etag, encoding="ascii")
        else:
            self._etag.unlink(missing_ok=True)

    async def _append(
        self, answer: httpx.Response, begins: int, largest_bytes: int, received: Received
    ) -> None:
        stated = answer.headers.get("content-length", "")
        length = begins + (int(stated) if re.fullmatch(r"\d{1,15}", stated) else 0)
        _refuse_larger(length, largest_bytes)
        length, since_s, at_then = begins, time.monotonic(), begins
        with self._data.open("r+b" if begins else "wb") as file:
            file.seek(begins)
            file.truncate()
            async for part in answer.aiter_raw():
                length += len(part)
                _refuse_larger(length, largest_bytes)
                file.write(part)
                received(length)
                if time.monotonic() - since_s > SLOW_S:
                    if length - at_then < LEAST_BYTES:
                        raise AskFailedError(f"less than {LEAST_BYTES} bytes in {SLOW_S:g} s")
                    since_s, at_then = time.monotonic(), length

    def _forget(self) -> None:
        for path in (self._data, self._etag):
            path.unlink(missing_ok=True)


def _refuse_larger(length: int, largest_bytes: int) -> None:
    if length > largest_bytes:
        raise AskFailedError(
            f"expected a file of at most {largest_bytes} bytes, got more", tries_again=False
        )
