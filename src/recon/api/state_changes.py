"""States as changes: what a reader of the stream has already is not sent again.

A change is an object with `since`, the base's `time_ns`; `time_ns`, the state's; and `state`, which
says how the base becomes the state:

- a member that is absent stays, and an age (a member whose name ends in `age_s`) grows by the time
  between the two, in whole milliseconds;
- a number, text, null or array replaces what was there; an object changes the members it names;
- `{"=": value}` replaces an object by another;
- `{"#": {"3": ...}}` changes these items of an array, each of them as above;
- `{"+": [n, ...]}` keeps the last n items of an array, and puts these after them;
- `"@": [[was, is], ...]` in the change of an array's item, or of the whole: of its ages, those that
  were `was` milliseconds are `is` now. One packet of telemetry renews twenty values of a vehicle;
  said once, all of them are a few bytes. It does not reach into items of further arrays.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import msgspec

from recon.api.schema import StationState
from recon.api.schema.message import Message
from recon.model.units import NS_PER_MS

MOST_DROPPED = 8
"""Points that leave a track between two states; a track adds about two a second."""

_SAME = object()
_PLAIN = frozenset((float, int, str, bool, type(None)))


def change_text(base: StationState, state: StationState) -> str:
    """Return the JSON text that turns `base` into `state`."""
    grown_ms = state.time_ns // NS_PER_MS - base.time_ns // NS_PER_MS
    change = _item_change(base, state, grown_ms)
    change.pop("time_ns", None)
    whole = {"since": base.time_ns, "time_ns": state.time_ns, "state": change}
    return msgspec.json.encode(whole).decode()


def kept_items(before: Sequence[object], now: Sequence[object]) -> int:
    """Return how many of the last items of `before` the array `now` begins with; 0 for none."""
    for dropped in range(min(len(before), MOST_DROPPED)):
        number = len(before) - dropped
        if before[dropped:] == now[:number]:
            return number
    return 0


def _item_change(was: Message, now: Message, grown_ms: int) -> dict[str, Any]:
    """Return the change of what has ages of its own: the state, or an array's item."""
    ages = _Ages(grown_ms)
    change = _members_change(was, now, ages)
    renewed = ages.renewed_ms()
    return {"@": renewed, **change} if renewed else change


class _Ages:
    """What the ages of one item have become. They are of whole milliseconds, so equal or not."""

    def __init__(self, grown_ms: int) -> None:
        self.grown_ms = grown_ms
        self.known: dict[float, float] = {}

    def renewed_ms(self) -> list[tuple[int, int]]:
        """Return those that a reader does not find by letting them grow."""
        pairs = ((round(was_s * 1e3), round(now_s * 1e3)) for was_s, now_s in self.known.items())
        return [(was_ms, now_ms) for was_ms, now_ms in pairs if now_ms != was_ms + self.grown_ms]


def _members_change(was: Message, now: Message, ages: _Ages) -> dict[str, Any]:
    change: dict[str, Any] = {}
    before, aged, known = was.__dict__, _names_of_ages(type(now)), ages.known
    for name, value in now.__dict__.items():
        old = before[name]
        if type(value) in _PLAIN:
            # An age is as said where all ages that were its own have become the same.
            is_aged = name in aged and old is not None and value is not None
            same = known.setdefault(old, value) == value if is_aged else old == value
            if not same:
                change[name] = value
        elif (found := _value_change(old, value, ages)) is not _SAME:
            change[name] = found
    return change


@lru_cache
def _names_of_ages(kind: type[Message]) -> frozenset[str]:
    return frozenset(name for name in kind.model_fields if name.endswith("age_s"))


def _value_change(was: Any, now: Any, ages: _Ages) -> Any:
    """Return the change of one value; `_SAME` for none."""
    if isinstance(now, Message):
        if type(was) is not type(now):
            return {"=": _plain(now)}
        return _members_change(was, now, ages) or _SAME
    if isinstance(now, list | tuple):
        return _array_change(was, now, ages.grown_ms)
    if was == now:
        return _SAME
    return {"=": now} if isinstance(now, dict) else now


def _array_change(was: Any, now: Sequence[Any], grown_ms: int) -> Any:
    if not isinstance(was, list | tuple):
        return _plain(now)
    if now and isinstance(now[0], Message):
        if [type(item) for item in was] != [type(item) for item in now]:
            return _plain(now)
        items = (_item_change(old, new, grown_ms) for old, new in zip(was, now, strict=True))
        changed = {str(number): item for number, item in enumerate(items) if item}
        return {"#": changed} if changed else _SAME
    if was is now or was == now:
        return _SAME
    kept = kept_items(was, now)
    return {"+": [kept, *now[kept:]]} if kept else now


def _plain(value: Any) -> Any:
    if isinstance(value, Message):
        return value.model_dump(mode="json")
    return [_plain(item) for item in value] if isinstance(value, list | tuple) else value
