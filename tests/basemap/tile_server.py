"""A tile server on loopback that answers as a test wants, in a thread of its own."""

import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from tests.basemap.made_maps import Key, colour_of, picture
from tests.fetching.file_server import send

Answer = Callable[[BaseHTTPRequestHandler, Key], None]


def tile(handler: BaseHTTPRequestHandler, key: Key) -> None:
    """Answer with the tile whose colour states its place."""
    send(handler, picture(colour_of(*key)), content_type="image/png")


@dataclass
class RunningTileServer:
    """What was asked, and how it answers."""

    template: str
    answer: Answer = tile
    asked: Counter[Key] = field(default_factory=Counter)
    agents: set[str] = field(default_factory=set)
    under_way: set[BaseHTTPRequestHandler] = field(default_factory=set)
    most_at_once: int = 0


@contextmanager
def tile_server(answer: Answer = tile) -> Iterator[RunningTileServer]:
    lock = threading.Lock()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            zoom, col, row = (int(part) for part in self.path[1:].split(".")[0].split("/")[:3])
            with lock:
                running.asked[zoom, col, row] += 1
                running.agents.add(self.headers["User-Agent"])
                running.under_way.add(self)
                running.most_at_once = max(running.most_at_once, len(running.under_way))
            try:
                running.answer(self, (zoom, col, row))
            except OSError:
                pass  # The client has closed it.
            finally:
                with lock:
                    running.under_way.discard(self)

        def end_headers(self) -> None:
            # Before the client can have all of it, and ask for the next.
            with lock:
                running.under_way.discard(self)
            super().end_headers()

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    port = server.server_address[1]
    running = RunningTileServer(f"http://127.0.0.1:{port}/{{z}}/{{x}}/{{y}}.png", answer)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        yield running
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
