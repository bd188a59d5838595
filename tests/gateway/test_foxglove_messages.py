"""The messages of live topics: what is live, once, and nothing that a state does not say."""

import json
import math
from typing import Any

import msgspec
from foxglove_schemas_protobuf.GeoJSON_pb2 import GeoJSON
from foxglove_schemas_protobuf.LocationFix_pb2 import LocationFix
from foxglove_schemas_protobuf.Log_pb2 import Log
from hypothesis import strategies as st
from tests.client import fake_state
from tests.gateway.drawn import given_examples

from recon.api import schema
from recon.client.messages import AuditRecord, StateMessage
from recon.gateway.foxglove.audit_messages import audit_messages
from recon.gateway.foxglove.live_message import GEOJSON, LiveMessage
from recon.gateway.foxglove.vehicle_messages import (
    STATE,
    Shown,
    is_another_run,
    new_samples,
)

NS = 1_000_000_000
ENTRY = AuditRecord(
    3, "2025-06-01T09:30:00.123456Z", "alarm.raised", "station", "A", "Anna", "x", {}
)
UTC_NS = 1_748_770_200_123_456_000


def state(at_s: float = 5.0, **changes: Any) -> StateMessage:
    view = fake_state.vehicle().model_copy(update=changes)
    text = fake_state.state_text(round(at_s * NS), vehicles=(view,))
    return msgspec.json.decode(text, type=StateMessage)


def topics(messages: list[LiveMessage]) -> list[str]:
    return [each.topic.rpartition("/")[2] for each in messages]


def aged(value: float | None, age_s: float | None) -> schema.AgedNumber:
    return schema.AgedNumber(value=value, age_s=age_s)


def test_a_sample_is_shown_once_and_only_while_it_is_live() -> None:
    shown: Shown = {}
    shown, messages = new_samples(shown, state(5.0), 0.0)
    assert topics(messages) == ["location", "state"]
    assert {each.at_ns for each in messages} == {fake_state.RUN_STARTED_NS + round(4.95 * NS)}
    # The same sample, older, in a later state.
    older = {"telemetry_age_s": 0.15, "position": position(0.15)}
    shown, messages = new_samples(shown, state(5.1, **older), 0.0)
    assert messages == []
    shown, messages = new_samples(shown, state(5.1), 0.0)
    assert topics(messages) == ["location", "state"]
    # Not live: by its own age, by the state's, or as the station says.
    for changes, age_s in (
        ({"telemetry_age_s": 1.0, "position": position(1.0)}, 0.0),
        ({}, 0.96),
        ({"staleness": "lost"}, 0.0),
        ({"staleness": "late"}, 0.0),
    ):
        shown, messages = new_samples(shown, state(9.0, **changes), age_s)
        assert messages == []


def position(age_s: float) -> schema.PositionView:
    return schema.PositionView(latitude_deg=41.9, longitude_deg=-93.6, age_s=age_s)


def test_a_location_has_the_altitude_of_its_own_packet() -> None:
    for altitude, expected in ((aged(12.0, 0.05), 12.0), (aged(12.0, 0.15), math.nan)):
        _, messages = new_samples({}, state(reported_altitude_m=altitude), 0.0)
        fix = LocationFix.FromString(messages[0].content)
        assert (fix.latitude, fix.longitude, fix.frame_id) == (41.9, -93.6, "SIM-1")
        assert fix.altitude == expected or (math.isnan(fix.altitude) and math.isnan(expected))
        assert fix.timestamp.ToNanoseconds() == messages[0].at_ns


def test_a_state_has_what_is_known_and_not_old() -> None:
    changes = {
        "battery_fraction": aged(0.5, 3.0),
        "height_above_takeoff_m": aged(None, 0.1),
        "flight_mode": schema.AgedText(value="gps_atti", age_s=2.9),
    }
    _, (_, message) = new_samples({}, state(**changes), 0.05)
    found = json.loads(message.content)
    assert found["flight_mode"] == "gps_atti"
    assert found["velocity_north_mps"] == 1.0
    assert not {"battery_fraction", "height_above_takeoff_m", "mission_id"} & set(found)
    described = json.loads(STATE.schema)
    assert described["type"] == "object"
    assert set(found) <= set(described["properties"])
    assert "$ref" not in STATE.schema.decode()


def test_a_link_without_a_serial_is_named_as_in_a_record() -> None:
    _, messages = new_samples({}, state(serial=None, link_id=3), 0.0)
    assert messages[0].topic == "/vehicles/link-3/location"
    _, messages = new_samples({}, state(serial=None, link_id=None), 0.0)
    assert messages == []


def test_another_run_is_known_by_its_start() -> None:
    restarted = msgspec.json.decode(
        fake_state.state_text(NS, fake_state.RUN_STARTED_NS + 60 * NS), type=StateMessage
    )
    assert not is_another_run(state(5.0), state(5.1))
    assert is_another_run(state(5.0), restarted)


def test_an_alarm_is_a_line_of_the_log() -> None:
    (message,) = audit_messages(ENTRY)
    line = Log.FromString(message.content)
    assert (message.topic, message.at_ns) == ("/log", UTC_NS)
    assert (line.message, line.name, line.level) == ("x", "Anna", Log.WARNING)
    assert line.timestamp.ToNanoseconds() == UTC_NS


def test_an_accepted_mission_is_a_line_on_the_map() -> None:
    waypoints = [
        {
            "latitude_deg": 41.9,
            "longitude_deg": longitude_deg,
            "height_above_takeoff_m": 40,
            "speed_mps": 5.0,
        }
        for longitude_deg in (-93.6, -93.599)
    ]
    details = {"order": "mission", "body": {"mission": {"waypoints": waypoints}}}
    ordered = msgspec.structs.replace(ENTRY, kind="order.queued", details=details)
    (_, message) = audit_messages(ordered)
    assert (message.topic, message.kind) == ("/vehicles/A/mission", GEOJSON)
    line = json.loads(GeoJSON.FromString(message.content).geojson)["geometry"]
    assert line["coordinates"][1] == [-93.599, 41.9, 40.0]
    for kind, changed in (
        ("order.refused_by_station", details),
        ("order.queued", details | {"order": "follow_path"}),
        ("order.queued", details | {"body": {"mission": {"waypoints": [1]}}}),
    ):
        other = msgspec.structs.replace(ordered, kind=kind, details=changed)
        assert len(list(audit_messages(other))) == 1


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=9),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["mission", "waypoints", "latitude_deg", "x"]), inner, max_size=4
        )
    ),
    max_leaves=12,
)


@given_examples(st.text(max_size=30), st.text(max_size=30), json_values)
def test_any_entry_is_a_line(utc: str, text: str, body: Any) -> None:
    details = {"order": "mission", "body": body}
    entry = AuditRecord(1, utc, "order.queued", "x", "A", "", text, details)
    line, *_mission = audit_messages(entry)
    assert Log.FromString(line.content).message == text
