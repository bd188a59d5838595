"""What a fork shares and what it copies."""

import threading
from collections import defaultdict, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from random import Random

import numpy as np
import pytest

from recon import wire
from recon.sim.fork import fork

ACK = wire.Acknowledgment(positive=1, source_pid=253)


@dataclass(frozen=True, slots=True)
class Settled:
    """Cannot change."""

    numbers: tuple[int, ...] = (1, 2)


@dataclass(slots=True)
class Counter:
    """Changes."""

    settled: Settled = field(default_factory=Settled)
    count: int = 0

    def add(self, more: int = 1) -> int:
        self.count += more
        return self.count


@dataclass(frozen=True, slots=True)
class Act:
    """Cannot change, but what it does may."""

    now: Callable[[], int]


def test_frozen_values_packets_and_fixed_arrays_are_shared() -> None:
    fixed = np.arange(3)
    fixed.flags.writeable = False
    original = {"frozen": Settled(), "packet": ACK, "array": fixed, "function": fork}
    forked = fork(original)
    assert forked is not original
    assert all(forked[name] is value for name, value in original.items())


def test_collections_and_arrays_are_copied() -> None:
    original = [deque([1], maxlen=2), defaultdict(list, a=[1]), {3}, bytearray(b"x"), np.zeros(2)]
    before = repr(original)
    queue, by_name, numbers, data, array = fork(original)
    queue.append(2)
    by_name["b"].append(1)
    numbers.add(4)
    data += b"y"
    array += 1.0
    assert repr(original) == before
    assert queue.maxlen == 2


def test_two_names_of_one_thing_are_two_names_of_one_thing_again() -> None:
    counter = Counter()
    one, other, settled = fork((counter, [counter], counter.settled))
    assert other[0] is one is not counter
    assert settled is one.settled is counter.settled


def test_generators_go_on_where_they_are() -> None:
    originals = Random(3), np.random.default_rng(3)
    originals[0].gauss(0.0, 1.0)
    forked = fork(originals)
    drawn = [forked[0].gauss(0.0, 1.0), forked[1].random()]
    assert [originals[0].gauss(0.0, 1.0), originals[1].random()] == drawn


def test_methods_partials_and_closures_act_on_the_fork() -> None:
    counter = Counter()
    step = 1

    def closure(more: int = 2, *, times: int = 3) -> int:
        return counter.add(more * times * step)

    forked, *acts = fork((counter, counter.add, partial(counter.add, 10), closure))
    assert [act() for act in acts] == [1, 11, 17]
    assert (forked.count, counter.count) == (17, 0)


def test_a_frozen_value_with_a_closure_is_copied_with_what_the_closure_captured() -> None:
    counter = Counter()
    forked, act = fork((counter, Act(lambda: counter.add())))
    assert act.now() == forked.count == 1
    assert counter.count == 0
    assert fork([fixed := Act(int)])[0] is fixed


def test_a_closure_that_names_itself_is_copied() -> None:
    def factorial(number: int) -> int:
        return 1 if number == 0 else number * factorial(number - 1)

    assert fork(factorial)(5) == 120


def test_half_a_packet_stays_half_a_packet() -> None:
    data = wire.encode(ACK)
    original = wire.Deframer()
    original.feed(data[:5], 7)
    one, same = fork([original, original])
    assert one is same
    assert one.feed(data[5:], 9) == [ACK]
    assert original.pending_bytes == 5


def test_what_has_no_copy_is_refused() -> None:
    with pytest.raises(TypeError, match="lock"):
        fork([threading.Lock()])
