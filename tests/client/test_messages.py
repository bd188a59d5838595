"""Messages fit the API's own models, ages only grow, and foreign data is told in a sentence."""

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.client import told

from recon.api import schema
from recon.client import BadAnswerError, Staleness
from recon.client.life import Life, PhaseChange
from recon.client.messages import (
    OrderMessage,
    ProblemMessage,
    ResultMessage,
    StateMessage,
    StationMessage,
    decode,
)
from recon.client.order_form import order_form
from recon.client.telemetry import Telemetry
from recon.model.command import (
    Body,
    FlyMission,
    Hover,
    LandNow,
    Refusal,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import staleness_at

PAIRS = [
    (StateMessage, schema.StationState),
    (StationMessage, schema.StationView),
    (Telemetry, schema.VehicleView),
    (Life, schema.CommandView),
    (PhaseChange, schema.PhaseView),
    (OrderMessage, schema.OrderResponse),
    (ResultMessage, schema.OrderResult),
    (ProblemMessage, schema.Problem),
]
BODIES: list[Body] = [
    Hover(),
    LandNow(),
    ReturnHome(),
    StartCamera(2.0),
    StopCamera(),
    FlyMission(Mission((Waypoint(41.9, -93.6, 50.0, 5.0, loiter_s=2.0),) * 2, land_at_end=True)),
    VirtualStick(StickFrame.BODY, 90.0, 1.0, 2.0, 30.0, 0.5),
]


@pytest.mark.parametrize(("ours", "theirs"), PAIRS)
def test_every_key_read_is_one_the_api_writes(
    ours: type[msgspec.Struct], theirs: type[schema.Message]
) -> None:
    assert set(ours.__struct_fields__) <= set(theirs.model_fields)


def test_a_whole_state_is_read_as_it_was_told() -> None:
    text = told.state_text(vehicles=(told.vehicle(),), commands=(told.command(7),))
    message = decode(text, StateMessage, "a state")
    assert message.run_started_ns == told.RUN_STARTED_NS
    (vehicle,) = message.vehicles
    assert (vehicle.serial, vehicle.is_live, vehicle.is_connected) == ("SIM-1", True, True)
    assert vehicle.position.latitude_deg == 41.9
    assert vehicle.height_above_takeoff_m.value == 12.0
    assert message.commands[0].id == 7


@pytest.mark.parametrize("body", BODIES)
def test_every_order_is_one_the_api_takes(body: Body) -> None:
    form = order_form(body)
    assert not isinstance(form, Refusal)
    request = schema.OrderRequest.model_validate({"serials": ["SIM-1"], "order": form})
    assert request.order.model_dump() == form


@given(st.floats(0.0, 1e6), st.one_of(st.none(), st.floats(0.0, 1e6)))
def test_ages_grow_together_and_staleness_follows(seconds: float, age_s: float | None) -> None:
    text = told.state_text(vehicles=(told.vehicle(age_s=age_s),))
    (vehicle,) = decode(text, StateMessage, "a state").vehicles
    older = vehicle.older_by(seconds)
    expected = None if age_s is None else age_s + seconds
    for part in (older.position, older.attitude, older.velocity_ned, older.is_flying):
        assert part.age_s == expected
    assert older.telemetry_age_s == expected
    assert older.staleness is staleness_at(expected)
    assert older.mission_id.age_s is None
    assert older.height_above_takeoff_m.value == vehicle.height_above_takeoff_m.value


@pytest.mark.parametrize(
    ("age_s", "word"),
    [
        (0.0, Staleness.LIVE),
        (0.999, Staleness.LIVE),
        (1.0, Staleness.LATE),
        (3.0, Staleness.LOST),
        (10.0, Staleness.SILENT),
        (None, Staleness.SILENT),
    ],
)
def test_words_for_ages(age_s: float | None, word: Staleness) -> None:
    assert staleness_at(age_s) is word


def test_the_stations_worse_word_stands() -> None:
    vehicle = told.vehicle(age_s=0.1).model_copy(update={"staleness": "lost"})
    (read,) = decode(told.state_text(vehicles=(vehicle,)), StateMessage, "a state").vehicles
    assert read.older_by(0.0).staleness is Staleness.LOST


@given(st.binary(max_size=200))
def test_foreign_bytes_are_told_in_a_sentence(data: bytes) -> None:
    with pytest.raises(BadAnswerError, match="expected a state as JSON, got"):
        decode(data, StateMessage, "a state")


@given(
    st.recursive(
        st.none() | st.booleans() | st.floats(allow_nan=False) | st.text(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    )
)
def test_foreign_json_is_told_in_a_sentence(value: object) -> None:
    with pytest.raises(BadAnswerError, match="same version"):
        decode(msgspec.json.encode(value), OrderMessage, "results of an order")


@pytest.mark.parametrize("text", ["[" * 100_000, '{"time_ns":' + "9" * 5000])
def test_json_made_to_hurt_is_told_in_a_sentence(text: str) -> None:
    with pytest.raises(BadAnswerError) as problem:
        decode(text, StateMessage, "a state")
    assert len(str(problem.value)) < 400
