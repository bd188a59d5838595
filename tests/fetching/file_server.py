"""A server of files on loopback: with ranges and marks of versions, or as a test wants."""

import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

Answer = Callable[[BaseHTTPRequestHandler, bytes], None]


def send(handler: BaseHTTPRequestHandler, data: bytes, status: int = 200, **headers: str) -> None:
    handler.send_response(status)
    for name, value in {"content_length": str(len(data)), **headers}.items():
        handler.send_header(name.replace("_", "-"), value)
    handler.end_headers()
    handler.wfile.write(data)


def whole(handler: BaseHTTPRequestHandler, data: bytes) -> None:
    """Answer as object stores do: a range of the version that is named, else all of it."""
    etag, stated = f'"{len(data)}"', handler.headers.get("Range")
    if stated is None or handler.headers.get("If-Range") != etag:
        send(handler, data, etag=etag)
        return
    first = int(stated.removeprefix("bytes=").rstrip("-"))
    span = f"bytes {first}-{len(data) - 1}/{len(data)}"
    send(handler, data[first:], 206, etag=etag, content_range=span)


@dataclass
class RunningFileServer:
    """Files by path, what was asked for, and how it answers."""

    address: str
    files: Mapping[str, bytes]
    answer: Answer = whole
    asked: list[str] = field(default_factory=list)
    ranges: list[str | None] = field(default_factory=list)


@contextmanager
def file_server(files: Mapping[str, bytes], answer: Answer = whole) -> Iterator[RunningFileServer]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            running.asked.append(self.path)
            running.ranges.append(self.headers.get("Range"))
            data = running.files.get(self.path)
            with suppress(OSError):  # The client has closed it.
                send(self, b"", 404) if data is None else running.answer(self, data)

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    running = RunningFileServer(f"http://127.0.0.1:{server.server_address[1]}", files, answer)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        yield running
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
