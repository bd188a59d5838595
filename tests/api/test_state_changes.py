"""Changes of states: applied to their base they give the state, whatever the tracks did."""

import json
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.link.approved import core, extended
from tests.persons import ANN
from tests.station.api_views.test_service import Bench

from recon.api.schema import AgedNumber, LeaseView, StationState, VehicleView
from recon.api.schema.message import Message
from recon.api.state_changes import change_text, kept_items

ABSENT: Any = object()
POINTS = st.lists(
    st.tuples(st.integers(-9, 9).map(float), st.integers(-9, 9).map(float)), max_size=30
)


def applied(base: dict[str, Any], change: dict[str, Any]) -> dict[str, Any]:
    """A reader's part, as the console has it in TypeScript."""
    assert change["since"] == base["time_ns"]
    grown_ms = change["time_ns"] // 1_000_000 - base["time_ns"] // 1_000_000
    state: dict[str, Any] = item_after(base, change["state"], grown_ms)
    return state | {"time_ns": change["time_ns"]}


def item_after(was: Any, change: Any, grown_ms: int) -> Any:
    renewed = dict(change.get("@", ())) if isinstance(change, dict) else {}
    return value_after(was, change, grown_ms, renewed)


def value_after(was: Any, change: Any, grown_ms: int, renewed: dict[int, int]) -> Any:
    if change is not ABSENT and not isinstance(change, dict):
        return change
    given = {} if change is ABSENT else change
    if "=" in given:
        return given["="]
    if "+" in given:
        kept, *added = given["+"]
        return [*was[-kept:], *added]
    if isinstance(was, list):
        changes = given.get("#", {})
        return [
            item_after(item, changes.get(str(number), {}), grown_ms)
            if isinstance(item, dict)
            else item
            for number, item in enumerate(was)
        ]
    if not isinstance(was, dict):
        return was
    return {
        name: age_after(value, grown_ms, renewed)
        if name.endswith("age_s") and value is not None and name not in given
        else value_after(value, given.get(name, ABSENT), grown_ms, renewed)
        for name, value in was.items()
    }


def age_after(was_s: float, grown_ms: int, renewed: dict[int, int]) -> float:
    was_ms = round(was_s * 1e3)
    return renewed.get(was_ms, was_ms + grown_ms) / 1e3


@given(POINTS, st.integers(0, 12), POINTS)
@settings(max_examples=examples(150))
def test_a_track_that_slides_keeps_its_points(
    before: list[tuple[float, float]], dropped: int, added: list[tuple[float, float]]
) -> None:
    now = before[dropped:] + added
    kept = kept_items(before, now)
    assert before[len(before) - kept :] == now[:kept]
    if before[dropped:] and dropped < 8:
        assert kept >= len(before) - dropped


@given(POINTS, POINTS)
@settings(max_examples=examples(150))
def test_any_track_is_restored(
    before: list[tuple[float, float]], now: list[tuple[float, float]]
) -> None:
    kept = kept_items(before, now)
    assert before[len(before) - kept :] + now[kept:] == now


@pytest.fixture(scope="module")
def first() -> StationState:
    """A state of three vehicles with orders and links."""
    bench = Bench()
    bench.open(1, extended(b"A"), core())
    bench.open(2, extended(b"B"), core(is_flying=0))
    bench.open(3, core())
    bench.now_ns += 123_456_789
    bench.hear(1, core())
    bench.service.orders.all_stop(ANN)
    bench.now_ns += 1_500_000_000
    state = bench.state()
    assert all(map(len, (state.vehicles, state.links, state.commands)))
    return state


def test_what_only_grew_older_is_not_sent(first: StationState) -> None:
    assert json.loads(change_text(first, older(first, 250)))["state"] == {}


def test_a_packet_is_a_few_bytes_when_it_says_nothing_new() -> None:
    bench = Bench()
    bench.open(1, extended(b"A"), core())
    bench.now_ns += 10_000_000
    bench.hear(1, core())
    bench.now_ns += 90_000_000
    base = bench.state()
    bench.now_ns += 10_000_000
    bench.hear(1, core())
    bench.now_ns += 90_000_000
    change = json.loads(change_text(base, bench.state()))["state"]
    vehicle = change["vehicles"]["#"]["0"]
    assert vehicle["@"] == [[90, 90]]
    assert len(json.dumps(vehicle)) < 200, vehicle


@given(st.data())
@settings(max_examples=examples(100), suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_state_follows_from_the_one_before(first: StationState, data: st.DataObject) -> None:
    base, known = first, json.loads(first.model_dump_json())
    for _ in range(3):
        state = drawn_after(base, data)
        known = applied(known, json.loads(change_text(base, state)))
        assert known == json.loads(state.model_dump_json())
        base = state


def drawn_after(base: StationState, data: st.DataObject) -> StationState:
    """The base some time later; vehicles come, go and change places, with values drawn anew."""
    state = older(base, data.draw(st.integers(0, 3000)))
    vehicles = [drawn_vehicle(v, data) for v in state.vehicles if data.draw(st.integers(0, 9))]
    if data.draw(st.booleans()):
        vehicles.reverse()
    return state.model_copy(update={"vehicles": vehicles})


def drawn_vehicle(vehicle: VehicleView, data: st.DataObject) -> VehicleView:
    ages_s = st.sampled_from([None, 0.0, 0.004, 0.005, 1.25])
    some = ages_s if data.draw(st.booleans()) else st.just(data.draw(ages_s))
    changes: dict[str, object] = {
        name: member.model_copy(update={"age_s": data.draw(some)})
        for name, member in vehicle.__dict__.items()
        if "age_s" in getattr(type(member), "model_fields", ()) and name != "authority"
    }
    fraction = data.draw(st.none() | st.floats(0.0, 1.0))
    changes["battery_fraction"] = AgedNumber(value=fraction, age_s=0.0)
    leases = st.builds(LeaseView, person=st.sampled_from("ab"), age_s=st.just(0.5))
    changes["lease"] = data.draw(st.none() | leases)
    changes["track"] = data.draw(POINTS)
    return vehicle.model_copy(update=changes)


def older(value: Any, by_ms: int) -> Any:
    """The same some time later: all its ages have grown, and the state's time."""
    if isinstance(value, list):
        return [older(each, by_ms) for each in value]
    if not isinstance(value, Message):
        return value
    grown: dict[str, object] = {}
    for name, member in value.__dict__.items():
        if name.endswith("age_s"):
            grown[name] = None if member is None else round(member + by_ms / 1e3, 3)
        elif name == "time_ns":
            grown[name] = member + by_ms * 1_000_000
        else:
            grown[name] = older(member, by_ms)
    return value.model_copy(update=grown)
