"""Messages match the API's models, ages only grow, and invalid data gives a readable error."""

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.client import fake_state

from recon.api import schema
from recon.client import BadAnswerError, Staleness
from recon.client.messages import (
    ImagerReliefStatus,
    OrderMessage,
    OrderStatus,
    PhaseReport,
    ProblemMessage,
    ResultMessage,
    SideStepStatus,
    StateMessage,
    StationMessage,
    decode,
)
from recon.client.order import order_json
from recon.client.surveys import SurveyLight
from recon.client.telemetry import Telemetry
from recon.model.command import (
    Body,
    FlyMission,
    Hover,
    LandNow,
    LockCamera,
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
    (SideStepStatus, schema.SideStepView),
    (ImagerReliefStatus, schema.ImagerReliefView),
    (SurveyLight, schema.SurveyLightView),
    (Telemetry, schema.VehicleView),
    (OrderStatus, schema.CommandView),
    (PhaseReport, schema.PhaseView),
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
    LockCamera(True),
    FlyMission(Mission((Waypoint(41.9, -93.6, 50.0, 5.0, loiter_s=2.0),) * 2, land_at_end=True)),
    VirtualStick(StickFrame.BODY, 90.0, 1.0, 2.0, 30.0, 0.5),
]


@pytest.mark.parametrize(("ours", "theirs"), PAIRS)
def test_every_key_read_is_written_by_the_api(
    ours: type[msgspec.Struct], theirs: type[schema.Message]
) -> None:
    assert set(ours.__struct_fields__) <= set(theirs.model_fields)


def test_a_complete_state_is_decoded() -> None:
    text = fake_state.state_text(
        vehicles=(fake_state.vehicle(),), commands=(fake_state.command(7),)
    )
    message = decode(text, StateMessage, "a state")
    assert message.run_started_ns == fake_state.RUN_STARTED_NS
    (vehicle,) = message.vehicles
    assert (vehicle.serial, vehicle.is_live, vehicle.is_connected) == ("SIM-1", True, True)
    assert vehicle.position.latitude_deg == 41.9
    assert vehicle.height_above_takeoff_m.value == 12.0
    assert message.commands[0].id == 7


@pytest.mark.parametrize("body", BODIES)
def test_every_order_is_valid_for_the_api(body: Body) -> None:
    form = order_json(body)
    assert not isinstance(form, Refusal)
    request = schema.OrderRequest.model_validate({"serials": ["SIM-1"], "order": form})
    assert request.order.model_dump() == form


@given(st.floats(0.0, 1e6), st.one_of(st.none(), st.floats(0.0, 1e6)))
def test_ages_grow_together_and_staleness_follows(seconds: float, age_s: float | None) -> None:
    text = fake_state.state_text(vehicles=(fake_state.vehicle(age_s=age_s),))
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
    ("age_s", "staleness"),
    [
        (0.0, Staleness.LIVE),
        (0.999, Staleness.LIVE),
        (1.0, Staleness.LATE),
        (3.0, Staleness.LOST),
        (10.0, Staleness.SILENT),
        (None, Staleness.SILENT),
    ],
)
def test_staleness_of_ages(age_s: float | None, staleness: Staleness) -> None:
    assert staleness_at(age_s) is staleness


def test_a_worse_staleness_from_the_station_is_kept() -> None:
    vehicle = fake_state.vehicle(age_s=0.1).model_copy(update={"staleness": "lost"})
    (read,) = decode(fake_state.state_text(vehicles=(vehicle,)), StateMessage, "a state").vehicles
    assert read.older_by(0.0).staleness is Staleness.LOST


@given(st.binary(max_size=200))
def test_invalid_bytes_give_a_readable_error(data: bytes) -> None:
    with pytest.raises(BadAnswerError, match="expected a state as JSON, got"):
        decode(data, StateMessage, "a state")


@given(
    st.recursive(
        st.none() | st.booleans() | st.floats(allow_nan=False) | st.text(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    )
)
def test_unexpected_json_gives_a_readable_error(value: object) -> None:
    with pytest.raises(BadAnswerError, match="same version"):
        decode(msgspec.json.encode(value), OrderMessage, "results of an order")


@pytest.mark.parametrize("text", ["[" * 100_000, '{"time_ns":' + "9" * 5000])
def test_hostile_json_gives_a_readable_error(text: str) -> None:
    with pytest.raises(BadAnswerError) as problem:
        decode(text, StateMessage, "a state")
    assert len(str(problem.value)) < 400
