"""Changes of states: applied to their base they give the state, whatever the tracks did."""

import json
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from tests.api.fake_station import FakeStation
from tests.examples import examples

from recon.api.schema import StationState
from recon.api.state_changes import change_text, kept_points

POINTS = st.lists(
    st.tuples(st.integers(-9, 9).map(float), st.integers(-9, 9).map(float)), max_size=30
)


def applied(base: dict[str, Any], change: dict[str, Any]) -> dict[str, Any]:
    """A reader's part, as the console has it in TypeScript."""
    assert change["since"] == base["time_ns"]
    own = ("since", "kept", "same_facts")
    state = {**base, **{k: v for k, v in change.items() if k not in own}}
    facts = {vehicle["serial"]: vehicle["app_facts"] for vehicle in base["vehicles"]}
    tracks = {vehicle["serial"]: vehicle["track"] for vehicle in base["vehicles"]}
    for vehicle in state["vehicles"]:
        kept = change["kept"].get(vehicle["serial"], 0)
        if kept:
            vehicle["track"] = tracks[vehicle["serial"]][-kept:] + vehicle["track"]
        if vehicle["serial"] in change.get("same_facts", ()):
            vehicle["app_facts"] = facts[vehicle["serial"]]
    return state


@given(POINTS, st.integers(0, 12), POINTS)
@settings(max_examples=examples(150))
def test_a_track_that_slides_keeps_its_points(
    before: list[tuple[float, float]], dropped: int, added: list[tuple[float, float]]
) -> None:
    now = before[dropped:] + added
    kept = kept_points(before, now)
    assert before[len(before) - kept :] == now[:kept]
    if before[dropped:] and dropped < 8:
        assert kept >= len(before) - dropped


@given(POINTS, POINTS)
@settings(max_examples=examples(150))
def test_any_track_is_restored(
    before: list[tuple[float, float]], now: list[tuple[float, float]]
) -> None:
    kept = kept_points(before, now)
    assert before[len(before) - kept :] + now[kept:] == now


def test_changes_give_the_states_and_are_shorter() -> None:
    station = FakeStation()
    first = station.state()
    known = json.loads(first.model_dump_json())
    base = first
    for second in range(1, 6):
        state = moved(first, second)
        text = change_text(base, state)
        known = applied(known, json.loads(text))
        assert known == json.loads(state.model_dump_json())
        assert "site" not in json.loads(text)
        base = state


def moved(state: StationState, second: int) -> StationState:
    """The state some seconds later: each track has slid, and one vehicle has gone by then."""
    vehicles = [
        vehicle.model_copy(update={"track": [(float(n), 0.0) for n in range(second, second + 40)]})
        for vehicle in state.vehicles[second // 4 :]
    ]
    return state.model_copy(update={"time_ns": state.time_ns + second, "vehicles": vehicles})
