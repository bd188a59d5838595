"""One flight for the same arguments, and a world of its own for each call."""

from collections.abc import Callable

from tests.flown_once import flown_once

flights: list[str] = []


@flown_once
def world(*names: str, end: Callable[[], int] | None = None) -> dict[str, list[int]]:
    flights.append(" ".join(names))
    return {name: [] for name in names}


def test_the_same_arguments_are_flown_once_and_every_call_has_its_own_world() -> None:
    flights.clear()
    one, other = world("a", "b"), world("a", "b")
    one["a"].append(1)
    assert other == world("a", "b") == {"a": [], "b": []}
    assert world("a") == {"a": []}
    assert flights == ["a b", "a"]


def test_arguments_without_a_pickle_are_flown_each_time() -> None:
    flights.clear()
    assert world("c", end=lambda: 1) == world("c", end=lambda: 2)
    assert flights == ["c", "c"]
