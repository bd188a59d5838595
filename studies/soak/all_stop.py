"""All stops of a soak: pressed from a process of their own, timed by the audit.

    python -m studies.soak.all_stop HTTP_PORT

presses once for each line that it reads, and answers with a line. In the soak's own process the
press would wait for the threads of its clients.
"""

import json
import subprocess
import sys
import time
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from studies.soak.figures import AllStop
from studies.soak.surveyor import post
from studies.soak.world import World

SENT_WITHIN_S = 2.5
"""Longer than telemetry takes to become stale: a link that broke just before shows by then."""


@dataclass(slots=True)
class AuditTail:
    """Reads on in the newest file of an audit: when each order's packet was first sent."""

    folder: Path
    sent_utc_s: dict[int, float] = field(default_factory=dict)
    _path: Path | None = None
    _at: int = 0

    def read_on(self) -> None:
        """Read the whole lines that were added since."""
        newest = max(self.folder.glob("*.jsonl"))
        if newest != self._path:
            self._path, self._at = newest, 0
        with newest.open("rb") as file:
            file.seek(self._at)
            data = file.read()
        whole = data[: data.rfind(b"\n") + 1]
        self._at += len(whole)
        for line in whole.splitlines():
            if b'"order.sent"' in line:
                entry = json.loads(line)
                moment = datetime.fromisoformat(entry["utc"]).timestamp()
                self.sent_utc_s.setdefault(entry["details"]["id"], moment)

    def lacks(self, numbers: set[int]) -> set[int]:
        """Read on, and return the orders of these that no packet was sent of."""
        self.read_on()
        return numbers - self.sent_utc_s.keys()


class AllStops:
    """Stops all and releases them, again and again.

    A vehicle without a link cannot be told: one whose telemetry was not live before and after is
    not timed. Its packet is owed until the next press: faults of a link are shorter than that.
    """

    def __init__(self, world: World) -> None:
        self._world, self._tail = world, AuditTail(world.audit)
        self._owed: set[int] = set()
        self._button = subprocess.Popen(
            [sys.executable, "-m", "studies.soak.all_stop", str(world.http_port)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def end(self) -> None:
        """End the process that presses."""
        self._button.communicate()

    def press(self, at_s: float) -> AllStop | None:
        """Stop all, and release them; None if nothing was in the air.

        The time is that until the last packet was handed to its socket, as the audit says.
        """
        unsent = len(self._tail.lacks(self._owed))
        live = self._world.live_serials()
        pressed_utc_s, answer = self._pressed()
        numbers = {e["command_id"]: e["serial"] for e in answer["results"] if e["accepted"]}
        self._owed = set(numbers)
        end_s = time.monotonic() + SENT_WITHIN_S
        while self._tail.lacks(self._owed) and time.monotonic() < end_s:
            time.sleep(0.05)
        live &= self._world.live_serials()
        post(self._world.http_port, "/api/all-stop/release", {"serials": None})
        timed = {number for number, serial in numbers.items() if serial in live}
        if not timed and not unsent:
            return None
        never_s = pressed_utc_s + SENT_WITHIN_S
        sent = [self._tail.sent_utc_s.get(number, never_s) - pressed_utc_s for number in timed]
        return AllStop(at_s, 1e3 * max(sent, default=0.0), unsent, len(numbers) - len(timed))

    def _pressed(self) -> tuple[float, dict[str, Any]]:
        assert self._button.stdin is not None
        assert self._button.stdout is not None
        self._button.stdin.write("\n")
        self._button.stdin.flush()
        found: tuple[float, dict[str, Any]] = json.loads(self._button.stdout.readline())
        return found


def _press_for_each_line(http_port: int) -> None:
    for _ in sys.stdin:
        pressed_utc_s = time.time()
        answer = post(http_port, "/api/all-stop")
        print(json.dumps([pressed_utc_s, answer]), flush=True)


if __name__ == "__main__":
    _press_for_each_line(int(sys.argv[1]))
