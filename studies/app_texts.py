"""Hostile texts of the extension `recon 1`, through the station's whole step.

    python -m studies.app_texts                      # a million texts
    python -m studies.app_texts --count 2000 --seed 1

Each text is made of a vector by changes of bytes and of values, or is random bytes. It is read as a
message's text and stepped by a station with one vehicle. Nothing may be raised, no fault may be
isolated by the station, and memory must not grow with the number of texts.
"""

import argparse
import gc
import json
import resource
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

from recon import wire
from recon.fleet.state import Fleet
from recon.model.event import Event, LinkOpened, PacketReceived, Tick
from recon.model.report import ExtendedReport, IgnoredReport, MessageReport
from recon.station.kernel.step import step
from recon.station.state.station import Station
from recon.vehicles.reports import to_report

FOLDER = Path(__file__).parents[1] / "vectors" / "app_texts"
PREFIX = "recon 1 "
PERIOD_NS = 10_000_000
MOST_GROWTH_KB = 16_384
"""Growth of the process between a tenth of the texts and all of them: the allocator's."""
EXTENDED = ExtendedReport("A", 14, 4, False, False, 0.9, None, None, None, None, 0)
NASTY: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 2**31, 2**63, 10**300, -0.0, 1e308, 5e-324, 0.5, "", "x" * 300,
    "\x1b[2J", "\ud800", "\u202e", [], [[]], {}, {"a": {}}, [None] * 20, [0.5] * 60, [1] * 17,
)  # fmt: skip
Vectors = tuple[bytes, ...]


def vectors() -> Vectors:
    """Return the texts of all vectors."""
    found: list[bytes] = []
    for name in ("valid", "refused", "other"):
        cases = json.loads((FOLDER / f"{name}.json").read_text("utf-8"))
        found += (case["text"].encode() for case in cases.values())
    return tuple(found)


def hostile(random: Random, known: Vectors) -> bytes:
    """Return one text."""
    kind = random.random()
    if kind < 0.1:
        return PREFIX.encode() + random.randbytes(random.randrange(200))
    text = random.choice(known)
    if kind < 0.5:
        return _changed_bytes(random, text)
    return _changed_values(random, text)


def _changed_bytes(random: Random, text: bytes) -> bytes:
    changed = bytearray(text)
    for _ in range(random.randrange(1, 5)):
        at = random.randrange(len(changed) + 1)
        change = random.randrange(4)
        if change == 0:
            changed[at:at] = random.randbytes(random.randrange(1, 4))
        elif change == 1:
            del changed[at : at + random.randrange(1, 8)]
        elif change == 2:
            changed[at:at] = changed[: random.randrange(64)]
        elif at < len(changed):
            changed[at] = random.randrange(256)
    return bytes(changed)


def _changed_values(random: Random, text: bytes) -> bytes:
    try:
        value = json.loads(text[len(PREFIX) :])
    except ValueError:
        return _changed_bytes(random, text)
    if not isinstance(value, dict):
        return text
    for _ in range(random.randrange(3)):
        inside = random.choice([value, *_objects(value)])
        if inside:
            inside[random.choice(list(inside))] = random.choice(NASTY)
    if isinstance(value.get("photos"), list):
        for photo in _objects(value):
            photo["index"] = random.randrange(1, 2**32)
            value["series"] = random.randrange(4)
    return PREFIX.encode() + json.dumps(value).encode("utf-8", "surrogatepass")


def _objects(value: Mapping[str, Any]) -> list[dict[str, Any]]:
    photos = value.get("photos")
    return [each for each in photos if isinstance(each, dict)] if isinstance(photos, list) else []


class HostileRun:
    """A station with one vehicle, and what its texts were taken for."""

    def __init__(self, seed: int) -> None:
        self.random, self.vectors = Random(seed), vectors()
        self.counts: Counter[str] = Counter()
        self.station = replace(Station(), fleet=Fleet())
        self.now_ns = 0
        self._step(LinkOpened(1, "10.0.0.1:5000"))
        self._step(PacketReceived(1, EXTENDED))

    def take(self, count: int) -> None:
        """Step so many texts, with a tick after each hundred."""
        for number in range(count):
            raw = hostile(self.random, self.vectors)
            report = to_report(wire.MessageString(type=0, text=raw))
            self.counts[type(report).__name__] += 1
            if not isinstance(report, IgnoredReport | MessageReport) or number % 20 == 0:
                self._step(PacketReceived(1, report))
            if number % 100 == 0:
                self._step(Tick())
        assert self.station.faults == {}

    def _step(self, event: Event) -> None:
        self.now_ns += PERIOD_NS
        self.station, _ = step(self.station, event, self.now_ns)


def memory_kb() -> int:
    """Return the greatest memory of this process so far."""
    gc.collect()
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def main() -> None:
    """Print what the texts were taken for, and how memory grew."""
    options = argparse.ArgumentParser()
    options.add_argument("--count", type=int, default=1_000_000)
    options.add_argument("--seed", type=int, default=0)
    given = options.parse_args()
    run = HostileRun(given.seed)
    run.take(given.count // 10)
    before_kb = memory_kb()
    run.take(given.count - given.count // 10)
    grown_kb = memory_kb() - before_kb
    for name, number in run.counts.most_common():
        print(f"{name:16} {number:9,}")
    print(f"{given.count:,} texts, nothing raised; memory grew by {grown_kb:,} kB")
    assert grown_kb <= MOST_GROWTH_KB


if __name__ == "__main__":
    main()
