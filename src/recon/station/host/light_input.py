"""Loggers of light sensors: lines by TCP, or of a file that one appends to.

A logger is read as fast as its values may come, no faster: one that sends more waits in its own
socket, and nobody else does. What it sends becomes `LightRead` events, for display and the record.
"""

import asyncio
import time
from collections.abc import Callable
from contextlib import AsyncExitStack
from pathlib import Path
from urllib.parse import urlsplit

from recon.light.lines import LightLines
from recon.model.event import Event
from recon.model.geo import LocalFrame
from recon.station.audit.log_line import print_warning
from recon.station.host.http_servers import StartError, listen

OPTION, SCHEME = "--light-sensors", "tcp://"
VALUES_PER_S = 64.0
"""Two a second of each of the most sensors: clouds change light over a second and more."""
READ_BYTES, READ_EVERY_S = 1_024, 0.05
FILE_EVERY_S = 0.25
HEAD_BYTES = 16_384
"""Read of a file that is there already, for its head and places; its values are not of now."""
MOST_LOGGERS = 4
IDLE_S = 30.0
"""A logger without a reading for so long gives way to a new one."""
LOG_EVERY_S = 10.0


async def start_light_input(
    where: str, frame: LocalFrame | None, handle: Callable[[Event], None], stack: AsyncExitStack
) -> str:
    """Begin to listen or to follow a file; return where, in words. Raises `StartError`."""
    hand_over = _HandOver(handle)
    if not where.startswith(SCHEME):
        _expect_file(where)
        following = asyncio.create_task(_LightFile(Path(where), frame, hand_over).follow())
        stack.callback(following.cancel)
        return where
    server = _LightServer(frame, hand_over)
    host, port = _address(where)
    listener = await asyncio.start_server(
        server.serve, sock=listen(host, port, OPTION), limit=READ_BYTES
    )
    stack.push_async_callback(server.close, listener)
    bound = listener.sockets[0].getsockname()
    return f"{SCHEME}{bound[0]}:{bound[1]}"


def _expect_file(where: str) -> None:
    """Raise `StartError` for what no logger can append to; the file itself may come later."""
    path = Path(where)
    is_address = "://" in where or where.startswith("tcp:")
    if is_address or path.is_dir() or not path.parent.is_dir():
        raise StartError(
            f"{OPTION}: expected a CSV file in a folder that exists, or {SCHEME}HOST:PORT, got "
            f"{where!a:.80}"
        )


def _address(where: str) -> tuple[str, int]:
    try:
        parts = urlsplit(where)
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if host is None or port is None or parts.path:
        raise StartError(
            f"{OPTION}: expected a CSV file or an address to listen on, as {SCHEME}0.0.0.0:4002, "
            f"got {where!a:.80}"
        )
    return host, port


class _HandOver:
    """Gives the station what was read, and states what was wrong with it."""

    def __init__(self, handle: Callable[[Event], None]) -> None:
        self._handle = handle
        self._logged_at_s = -LOG_EVERY_S

    def of(self, source: str, lines: LightLines) -> tuple[int, list[str]]:
        """Hand over what a logger's lines gave; return how many values, and the problems."""
        read, problems = lines.taken(source)
        if read is not None:
            self._handle(read)
        if problems and time.monotonic() >= self._logged_at_s + LOG_EVERY_S:
            self._logged_at_s = time.monotonic()
            print_warning(f"light sensors of {source}: {problems[-1]}")
        return 0 if read is None else len(read.readings), problems


class _LightServer:
    """The open connections of loggers."""

    def __init__(self, frame: LocalFrame | None, hand_over: _HandOver) -> None:
        self._frame = frame
        self._hand_over = hand_over
        self._heard_s: dict[asyncio.StreamWriter, float] = {}
        """When each logger had its newest reading, or connected."""

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Read one logger until it closes."""
        if not self._has_room():
            writer.write(f"{MOST_LOGGERS} loggers are connected, and no more fit\n".encode())
            writer.close()
            return
        self._heard_s[writer] = time.monotonic()
        lines, source = LightLines(self._frame), str(writer.get_extra_info("peername")[0])
        try:
            while data := await reader.read(READ_BYTES):
                lines.push(data, time.time_ns())
                values, problems = self._hand_over.of(source, lines)
                if values:
                    self._heard_s[writer] = time.monotonic()
                if writer.transport.get_write_buffer_size() == 0:  # or it does not listen
                    writer.writelines(f"{each}\n".encode() for each in problems)
                await asyncio.sleep(max(READ_EVERY_S, values / VALUES_PER_S))
        except OSError:
            pass  # it has closed
        finally:
            self._heard_s.pop(writer, None)
            writer.close()

    async def close(self, listener: asyncio.Server) -> None:
        """Close everything."""
        listener.close()
        for writer in self._heard_s:
            writer.transport.abort()
        await asyncio.sleep(0)

    def _has_room(self) -> bool:
        if len(self._heard_s) < MOST_LOGGERS:
            return True
        quiet = min(self._heard_s, key=lambda each: self._heard_s[each])
        if time.monotonic() - self._heard_s[quiet] < IDLE_S:
            return False
        del self._heard_s[quiet]
        quiet.transport.abort()
        return True


class _LightFile:
    """A file that a logger appends to, also one that comes later or begins anew."""

    def __init__(self, path: Path, frame: LocalFrame | None, hand_over: _HandOver) -> None:
        self._path, self._frame, self._hand_over = path, frame, hand_over
        self._lines: LightLines | None = None
        self._file_id = self._offset = 0

    async def follow(self) -> None:
        """Read what is appended, until cancelled."""
        is_first = True
        while True:
            try:
                data = await asyncio.to_thread(self._appended, is_first=is_first)
            except OSError:
                data = b""  # not there yet, or not any more
            is_first, values = False, 0
            if data and self._lines is not None:
                self._lines.push(data, time.time_ns())
                values, _problems = self._hand_over.of(self._path.name, self._lines)
            await asyncio.sleep(max(FILE_EVERY_S, values / VALUES_PER_S))

    def _appended(self, *, is_first: bool) -> bytes:
        with self._path.open("rb") as file:
            found = self._path.stat()
            if self._lines is None or found.st_ino != self._file_id or found.st_size < self._offset:
                self._lines, self._file_id = LightLines(self._frame), found.st_ino
                self._offset = 0
                if is_first:
                    head = file.read(HEAD_BYTES)
                    self._lines.push(head[: head.rfind(b"\n") + 1], time.time_ns())
                    self._lines.taken("")
                    file.seek(max(0, found.st_size - HEAD_BYTES))
                    self._offset = file.tell() + file.read(HEAD_BYTES).rfind(b"\n") + 1
            file.seek(self._offset)
            data = file.read(READ_BYTES)
        self._offset += len(data)
        return data
