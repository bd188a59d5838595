"""The operator of a soak: two surveys flown again and again.

Once a second each region's newest survey is looked at: without one, or after its end, another is
requested; one that is planned is started with its half of the fleet; members without rows for
`IDLE_S` are started again, as after an all stop or a battery change.
"""

import http.client
import json
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from studies.soak.field import REGIONS_M
from studies.soak.world import World

LOOK_EVERY_S = 1.0
IDLE_S = 15.0
HEIGHT_M, SPEED_MPS = 60.0, 8.0
ENDED = ("done", "aborted", "refused")


class Surveyor:
    """Flies the surveys on a thread of its own, until it is ended."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._ids: dict[str, int] = {}
        self._started_s: dict[str, float] = {}
        self.requested = 0
        self.finished = 0
        self.refusals: list[str] = []
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def end(self) -> None:
        """End; the surveys fly on."""
        self._is_over.set()
        self._thread.join()

    def start_again_soon(self) -> None:
        """Start all members at the next look."""
        self._started_s.clear()

    def _run(self) -> None:
        while not self._is_over.wait(LOOK_EVERY_S):
            with suppress(OSError, http.client.HTTPException):
                surveys = {each["id"]: each for each in self._world.get("/api/surveys")}
                for number, region in enumerate(REGIONS_M):
                    self._look(region, self._world.serials[number :: len(REGIONS_M)], surveys)

    def _look(self, region: str, serials: Sequence[str], surveys: dict[int, Any]) -> None:
        survey = surveys.get(self._ids.get(region, -1))
        if survey is None or survey["phase"] in ENDED:
            self.finished += survey is not None and survey["phase"] == "done"
            self._request(region)
            return
        flying = {v["serial"] for v in survey["vehicles"] if v["is_flying_rows"]}
        idle = [serial for serial in serials if serial not in flying]
        if survey["phase"] != "planning" and idle and self._is_due(region):
            self._start(survey["id"], idle)

    def _request(self, region: str) -> None:
        facts = {"region": region, "height_above_takeoff_m": HEIGHT_M, "speed_mps": SPEED_MPS}
        answer = post(self._world.http_port, "/api/surveys", facts)
        self._note(answer)
        if answer.get("survey") is not None:
            self.requested += 1
            self._ids[region] = answer["survey"]["id"]
            self._started_s.pop(region, None)

    def _start(self, number: int, serials: Sequence[str]) -> None:
        facts = {"serials": serials, "takeoff": True, "given_at_unix_ms": round(1e3 * time.time())}
        self._note(post(self._world.http_port, f"/api/surveys/{number}/start", facts))

    def _is_due(self, region: str) -> bool:
        now_s = time.monotonic()
        if now_s - self._started_s.get(region, -IDLE_S) < IDLE_S:
            return False
        self._started_s[region] = now_s
        return True

    def _note(self, answer: dict[str, Any]) -> None:
        if answer.get("refusal") is not None:
            self.refusals.append(answer["refusal"]["reason"])


def post(http_port: int, path: str, facts: object = None) -> dict[str, Any]:
    """Send one request of the API, and return its answer."""
    connection = http.client.HTTPConnection("127.0.0.1", http_port, timeout=30.0)
    body = b"" if facts is None else json.dumps(facts).encode()
    connection.request("POST", path, body, {"Content-Type": "application/json"})
    answer: dict[str, Any] = json.loads(connection.getresponse().read())
    connection.close()
    return answer
