"""A station that costs nearly nothing: states of many vehicles ten times a second, quick answers.

    python -m benches.gateway.quick_station VEHICLES

The states are of the API's models with full tracks. Prints its address. What a gateway takes and
adds is measured beside it, and not how busy a real station is.
"""

import asyncio
import json
import socket
import sys
import time
from typing import Any

import uvicorn
from tests.client import fake_state

TRACK = [(-93.6 + 1e-5 * number, 41.9) for number in range(300)]
INTERVAL_S = 0.1


class QuickStation:
    """An ASGI application: the stream, every order accepted, and nothing to read."""

    def __init__(self, vehicles: int) -> None:
        views = tuple(
            fake_state.vehicle(f"SIM-{n}").model_copy(update={"number": n, "track": TRACK})
            for n in range(1, vehicles + 1)
        )
        text = fake_state.state_text(0, 0, vehicles=views)
        self._before, _, rest = text.partition('"time_ns":0')
        self._between, _, self._after = rest.partition('"uptime_s":0.0')
        assert self._after
        self._begun_ns = time.monotonic_ns()

    def text(self) -> str:
        """Return the state of now: every sample is 50 ms old."""
        uptime_ns = time.monotonic_ns() - self._begun_ns
        uptime = f'"uptime_s":{uptime_ns / 1e9}'
        return f'{self._before}"time_ns":{uptime_ns}{self._between}{uptime}{self._after}'

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Serve one request or one stream."""
        if scope["type"] == "http" and scope["method"] == "GET":
            await send({"type": "http.response.start", "status": 404, "headers": []})
            await send({"type": "http.response.body", "body": b'{"error":"none"}'})
        elif scope["type"] == "http":
            request = json.loads((await receive())["body"])
            result = {"serial": request["serials"][0], "link_id": 1, "vehicle_name": "one"}
            result |= {"accepted": True, "command_id": 1, "rule": None, "reason": None}
            body = json.dumps({"results": [result]}).encode()
            await send({"type": "http.response.start", "status": 200, "headers": []})
            await send({"type": "http.response.body", "body": body})
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.accept"})
            while True:
                await send({"type": "websocket.send", "text": self.text()})
                await asyncio.sleep(INTERVAL_S)


def main() -> None:
    listening = socket.create_server(("127.0.0.1", 0))
    print(f"console: http://127.0.0.1:{listening.getsockname()[1]}", flush=True)
    application = QuickStation(int(sys.argv[1]))
    config = uvicorn.Config(application, log_level="error", ws_per_message_deflate=False)
    uvicorn.Server(config).run([listening])


if __name__ == "__main__":
    main()
