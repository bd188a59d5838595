"""Forks of a world in virtual time: equal to the bit under the same input, and never in touch."""

import random
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import partial
from io import BytesIO
from types import FunctionType, MethodType

import pytest
from tests.oracles.run_digest import RunDigest
from tests.station.returning_world import ReturningWorld, returning_world
from tests.station.station_world import World, square_mission, world

from recon.link.session import Session
from recon.link.tap import Direction
from recon.model.command import FlyMission, Hover, LandNow, ReturnHome
from recon.sim.app.app import SimulatedApp
from recon.sim.fake_link import FakeLink
from recon.sim.fork import _Code, _Pickler, fork
from recon.station.kernel.virtual import JobEnd, VirtualDriver

RUNS_S = 6.0


def damage(chunk: bytes, rng: random.Random) -> bytes:
    """Cut or change some chunks: half a packet then waits for its rest."""
    drawn = rng.random()
    if drawn < 0.1 and len(chunk) > 1:
        return chunk[: rng.randrange(1, len(chunk))]
    place = rng.randrange(len(chunk))
    changed = chunk[:place] + bytes([chunk[place] ^ 0x10]) + chunk[place + 1 :]
    return changed if drawn < 0.15 else chunk


def troubled(seed: int) -> World:
    """Three vehicles over bad links, with faults of links, apps and aircraft."""
    w = world(
        3,
        seed=seed,
        faults=(
            *("restart:1:7:2", "second-link:2:8:6", "half-open:3:9:5", "gusts:1:4:20"),
            *("bursts:2:3:9", "slow-reader:3:2:20", "delayed-acks:1:3:20", "pilot-takes:2:12:4"),
        ),
        make_link=lambda: FakeLink(jitter_s=0.05, damage=damage, seed=seed),
        wanders=True,
    )
    w.run_for(2.0)
    w.order("SIM-1", FlyMission(square_mission()))
    return w


def ordered() -> World:
    """A vehicle that is ordered to fly a mission."""
    w = world()
    w.run_for(3.0)
    w.order("SIM-1", FlyMission(square_mission()))
    return w


def recalled() -> ReturningWorld:
    """Two vehicles whose fleet return is ordered."""
    w = returning_world([(0.0, 30.0, 40.0), (40.0, 30.0, 50.0)], [(0.0, -40.0), (40.0, -40.0)])
    w.call("SIM-1", "SIM-2")
    return w


class Watched:
    """All that a driver's world is from now on: events, bytes of every link, and states."""

    def __init__(self, driver: VirtualDriver) -> None:
        self.bytes: list[tuple[int, Direction, bytes, int]] = []
        self._digest = RunDigest(driver)
        driver.tap = lambda *given: self.bytes.append(given)

    def value(self) -> tuple[str, int, list[tuple[int, Direction, bytes, int]]]:
        return self._digest.value(), self._digest.events, self.bytes


def flown(w: World) -> object:
    """Give the input that all get, and return what came of it."""
    watched = Watched(w.driver)
    w.order("SIM-2", LandNow())
    w.run_for(RUNS_S / 2.0)
    w.order("SIM-3", ReturnHome())
    w.run_for(RUNS_S / 2.0)
    motions = [app.aircraft.motion for app in w.apps]
    return watched.value(), motions, [app.take_log() for app in w.apps]


def until(w: World, is_so: Callable[[], bool]) -> None:
    assert w.run_until(is_so, 20.0)


@pytest.mark.parametrize(("seed", "seconds"), [(1, 0.0), (2, 5.13), (3, 9.4)])
def test_the_same_input_gives_the_same_to_the_bit(seed: int, seconds: float) -> None:
    """The original is flown last: whatever a fork had touched of it would show."""
    original = troubled(seed)
    original.run_for(seconds)
    one, other = fork(original), fork(original)
    of_one = flown(one)
    of_fork = fork(other)
    assert flown(other) == flown(of_fork) == of_one
    assert flown(original) == of_one


def test_other_input_gives_another_world_and_changes_no_other() -> None:
    original = troubled(1)
    one, other, third = fork(original), fork(original), fork(original)
    one.order("SIM-2", Hover())
    different = flown(one)
    assert flown(other) == flown(third) == flown(original) != different


class TestInTheMiddle:
    """Forks while something is half done."""

    def test_of_a_packet(self) -> None:
        original = troubled(5)
        wires = original.driver._wires
        until(
            original,
            lambda: any(wire.session.is_waiting_for_bytes for wire in wires.values()),
        )
        assert flown(fork(original)) == flown(original)

    @pytest.mark.parametrize("step", ["_pending", "_start"])
    def test_of_a_mission_that_its_app_takes(self, step: str) -> None:
        original = ordered()
        until(original, lambda: bool(getattr(original.app("SIM-1"), step)))
        other = fork(original)
        ends = []
        for each in (other, original):
            watched = Watched(each.driver)
            each.run_for(15.0)
            ends.append((watched.value(), each.app("SIM-1").aircraft.motion))
        assert ends[0] == ends[1]
        assert other.app("SIM-1").aircraft.motion.north_m > 3.0

    def test_of_bytes_under_way(self) -> None:
        original = troubled(5)
        until(original, lambda: len(original.driver._due) > 1)
        assert flown(fork(original)) == flown(original)

    @pytest.mark.parametrize("pending", [1, 2])
    def test_of_a_fault_of_a_link(self, pending: int) -> None:
        original = troubled(5)
        until(original, lambda: len(original._later) == pending)
        assert flown(fork(original)) == flown(original)

    def test_of_a_job(self) -> None:
        original = recalled()
        due = original.world.driver._due
        until(
            original.world,
            lambda: any(isinstance(what, JobEnd) for _at_ns, _number, what in due),
        )
        other = fork(original)
        ends = []
        for each in (other, original):
            watched = Watched(each.world.driver)
            each.runs(8.0)
            ends.append((watched.value(), each.heights_m, each.nearest))
        assert ends[0] == ends[1]
        assert set(original.stages()) == {"SIM-1", "SIM-2"}


def test_what_forks_share_holds_nothing_that_changes() -> None:
    original = ordered()
    until(original, lambda: bool(original.app("SIM-1")._start))
    pickler = _Pickler(BytesIO())
    pickler.dump(original)
    changing = (random.Random, deque, bytearray, MethodType, partial, Session, SimulatedApp)
    shared = [each for each in pickler.aside if not isinstance(each, _Code)]
    for value in parts(shared, set()):
        assert not isinstance(value, changing), value
        assert not (isinstance(value, FunctionType) and value.__closure__), value


def parts(value: object, seen: set[int]) -> Iterator[object]:
    """Yield a value, and all values in its fields and items."""
    if id(value) in seen:
        return
    seen.add(id(value))
    yield value
    if isinstance(value, Mapping):
        value = list(value.items())
    if isinstance(value, tuple | list | frozenset | set):
        for each in value:
            yield from parts(each, seen)
    elif is_dataclass(value) and not isinstance(value, type):
        for each in fields(value):
            yield from parts(getattr(value, each.name), seen)


def test_what_a_test_puts_elsewhere_in_a_fork_stays_there() -> None:
    original = recalled()
    other = fork(original)
    other.put("SIM-1", (5.0, 5.0, 33.0))
    other.heights_m.clear()
    assert original.place_m("SIM-1") != other.place_m("SIM-1")
    assert original.heights_m
    assert fork(other).place_m("SIM-1") == other.place_m("SIM-1")
