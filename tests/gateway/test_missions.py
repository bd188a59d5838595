"""Missions up and down by the mission protocol, and the site's fence."""

from math import nan
from typing import Any

import pytest
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as mavlink
from tests.gateway.drawn import given_examples
from tests.gateway.fleet_state import ORDERS, SENDER, Stepping, seen, sent, text, types

from recon.client.messages import TemporaryZoneStatus
from recon.client.site import SiteFeature
from recon.gateway.mavlink.fence import fence_items
from recon.gateway.mavlink.inputs_outputs import (
    CheckMission,
    FenceRead,
    Output,
    PeerGone,
    PlaceOrder,
    ReadFence,
    StationAnswered,
    TimePassed,
)
from recon.gateway.mavlink.mission_items import NotUnderstood, mission_of
from recon.gateway.mavlink.values import GatewaySettings, Sender
from recon.model.command import FlyMission, Refusal
from recon.model.mission import Mission, Waypoint
from recon.model.temporary_zone import TemporaryZoneKind

WAYPOINT, LAND, SPEED, TAKEOFF = 16, 21, 178, 22
DELAY, GIMBAL, MOUNT = 93, 1000, 205
FENCE_CORNER = 5001


def item(seq: int, command: int = WAYPOINT, z: float = 40.0, **changes: Any) -> Any:
    message = mavlink.MAVLink_mission_item_int_message(
        *(1, 1, seq, 6, command, int(seq == 0), 1, 0.0, 0.0, 0.0, nan),
        *(419_000_000 + 1000 * seq, -936_000_000, z, 0),
    )
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def count(number: int, kind: int = 0) -> Any:
    return mavlink.MAVLink_mission_count_message(1, 1, number, kind)


def ack(outputs: tuple[Output, ...]) -> int:
    (message,) = (m for m in sent(outputs) if m.get_type() == "MISSION_ACK")
    return message.type


def upload(gateway: Stepping, items: list[Any], sender: Sender = SENDER) -> tuple[Output, ...]:
    """Upload items one by one; return what came of the last one."""
    (question,) = sent(gateway.receive(count(len(items)), sender))
    for number, each in enumerate(items):
        assert (question.get_type(), question.seq) == ("MISSION_REQUEST_INT", number)
        outputs = gateway.receive(each, sender)
        questions = sent(outputs)
        question = questions[0] if questions else None
    return outputs


def with_mission(count: int = 2) -> Stepping:
    gateway = Stepping()
    upload(gateway, [item(seq) for seq in range(count)])
    gateway.give(StationAnswered(1))
    return gateway


def test_a_mission_goes_up_through_the_gate_and_comes_down_as_it_was() -> None:
    gateway = Stepping()
    items = [item(seq, z=40.0 + seq) for seq in range(3)]
    (check,) = upload(gateway, items)
    assert isinstance(check, CheckMission)
    assert [w.height_above_takeoff_m for w in check.mission.waypoints] == [40.0, 41.0, 42.0]
    assert ack(gateway.give(StationAnswered(check.token))) == mavlink.MAV_MISSION_ACCEPTED
    (total,) = sent(gateway.receive(mavlink.MAVLink_mission_request_list_message(1, 1)))
    assert total.count == 3
    for seq, was in enumerate(items):
        question = mavlink.MAVLink_mission_request_int_message(1, 1, seq)
        (got,) = sent(gateway.receive(question))
        assert (got.seq, got.x, got.y, got.z, got.command) == (seq, was.x, was.y, was.z, 16)


def test_an_older_client_gets_items_of_floats() -> None:
    (got,) = sent(with_mission().receive(mavlink.MAVLink_mission_request_message(1, 1, 1)))
    assert (got.get_type(), got.frame) == ("MISSION_ITEM", 3)
    assert got.x == pytest.approx(41.9001, abs=1e-6)


def test_a_mission_that_the_gate_refuses_is_refused_and_not_kept() -> None:
    gateway = Stepping()
    upload(gateway, [item(0), item(1)])
    outputs = gateway.give(StationAnswered(1, Refusal("boundary", "it leaves the boundary")))
    assert ack(outputs) == mavlink.MAV_MISSION_DENIED
    assert text(outputs) == "it leaves the boundary"
    assert gateway.state.vehicles[1].mission is None


def test_a_mission_that_could_not_be_flown_at_this_moment_is_kept_with_the_sentence() -> None:
    gateway = Stepping()
    upload(gateway, [item(0), item(1)])
    outputs = gateway.give(StationAnswered(1, Refusal("preflight", "no list")))
    assert ack(outputs) == mavlink.MAV_MISSION_ACCEPTED
    assert "no list" in text(outputs)
    assert gateway.state.vehicles[1].mission is not None


def test_starting_flies_it_and_takes_off_only_after_arming() -> None:
    gateway = with_mission()
    start = mavlink.MAVLink_command_long_message(1, 1, 300, 0, *(0.0,) * 7)
    arm = mavlink.MAVLink_command_long_message(1, 1, 400, 0, 1.0, *(0.0,) * 6)
    (order,) = gateway.receive(start)
    assert isinstance(order, PlaceOrder)
    assert isinstance(order.body, FlyMission)
    assert not order.takeoff
    gateway.give(StationAnswered(order.token, Refusal("flying", "on the ground")))
    assert "may take off" in text(gateway.receive(arm))
    (order,) = gateway.receive(start)
    assert isinstance(order, PlaceOrder)
    assert order.takeoff
    gateway.give(StationAnswered(order.token, Refusal("gnss", "no")))
    # Used up by one start.
    (order,) = gateway.receive(start)
    assert isinstance(order, PlaceOrder)
    assert not order.takeoff


def test_arming_is_forgotten_after_a_minute() -> None:
    gateway = with_mission()
    gateway.receive(mavlink.MAVLink_command_long_message(1, 1, 400, 0, 1.0, *(0.0,) * 6))
    gateway.now_ns += 60_000_000_000
    (order,) = gateway.receive(mavlink.MAVLink_command_long_message(1, 1, 300, 0, *(0.0,) * 7))
    assert isinstance(order, PlaceOrder)
    assert not order.takeoff


def test_a_read_only_gateway_takes_no_mission() -> None:
    gateway = Stepping(GatewaySettings())
    for message in (count(2), mavlink.MAVLink_mission_clear_all_message(1, 1)):
        outputs = gateway.receive(message)
        assert ack(outputs) == mavlink.MAV_MISSION_DENIED
        assert "--allow-orders" in text(outputs)


def test_an_upload_of_another_client_is_refused_until_the_first_ends() -> None:
    gateway, other = Stepping(), Sender(2, 254, 1)
    gateway.receive(count(2))
    assert ack(gateway.receive(count(2), other)) == mavlink.MAV_MISSION_DENIED
    gateway.give(PeerGone(1))
    assert types(gateway.receive(count(2), other)) == ["MISSION_REQUEST_INT"]


def test_a_missing_item_is_asked_for_again_and_then_given_up() -> None:
    gateway = Stepping()
    gateway.receive(count(2))
    asked = [types(gateway.give(TimePassed(), after_s=0.75)) for _ in range(6)]
    assert asked == [["MISSION_REQUEST_INT"]] * 4 + [["MISSION_ACK"], []]
    assert gateway.state.uploads == {}


def test_an_upload_is_bounded() -> None:
    assert ack(Stepping().receive(count(2001))) == mavlink.MAV_MISSION_NO_SPACE


def test_clearing_forgets_it() -> None:
    gateway = with_mission()
    outputs = gateway.receive(mavlink.MAVLink_mission_clear_all_message(1, 1))
    assert ack(outputs) == mavlink.MAV_MISSION_ACCEPTED
    assert gateway.state.vehicles[1].mission is None


def test_progress_is_what_telemetry_shows_of_the_order() -> None:
    from tests.client import fake_state

    from recon.gateway.mavlink.inputs_outputs import StationSeen

    gateway = with_mission()
    gateway.receive(mavlink.MAVLink_command_long_message(1, 1, 300, 0, *(0.0,) * 7))
    gateway.give(StationAnswered(2, command_id=7))
    shown = []
    for second, phase in enumerate(("started", "done", "done")):
        import msgspec

        from recon.client.messages import StateMessage

        order = fake_state.command(7, phase)  # type: ignore[arg-type]
        uptime_ns = (10 + second) * 1_000_000_000
        whole = fake_state.state_text(
            uptime_ns, vehicles=(fake_state.vehicle(),), commands=(order,)
        )
        message = msgspec.json.decode(whole, type=StateMessage)
        outputs = gateway.give(StationSeen(message), after_s=1.0)
        shown.append([m for m in sent(outputs) if m.get_type().startswith("MISSION")])
    assert [m.mission_state for m in (shown[0][0], shown[1][0])] == [3, 5]
    assert [len(messages) for messages in shown] == [1, 2, 1]
    assert shown[1][1].seq == 1


# What items mean.


def meant(*items: Any) -> Mission | NotUnderstood:
    return mission_of(items, ORDERS)


def test_what_mavsdk_sends_is_understood() -> None:
    mission = meant(
        item(0),
        item(1, SPEED, param1=1.0, param2=7.0),
        item(2, MOUNT, param1=-60.0),
        item(3, DELAY, param1=2.5),
        item(4),
        item(5, GIMBAL, param1=-90.0),
        item(6, LAND, x=0, y=0),
    )
    assert isinstance(mission, Mission)
    assert mission.land_at_end
    assert mission.waypoints == (
        Waypoint(41.9, -93.6, 40.0, 7.0, loiter_s=2.5, gimbal_pitch_deg=-60.0),
        Waypoint(41.9004, -93.6, 40.0, 7.0, gimbal_pitch_deg=-90.0),
    )


def test_a_takeoff_first_and_heights_above_the_sea() -> None:
    settings = GatewaySettings(ground_above_sea_level_m=278.0)
    mission = mission_of([item(0, TAKEOFF), item(1, frame=5, z=318.0)], settings)
    assert isinstance(mission, Mission)
    assert mission.waypoints[0].height_above_takeoff_m == 40.0


@pytest.mark.parametrize(
    ("items", "result"),
    [
        # A fence that pymavlink sends by MAVLink 1 arrives as a mission.
        ([item(0, FENCE_CORNER), item(1, FENCE_CORNER)], mavlink.MAV_MISSION_UNSUPPORTED),
        ([item(0), item(1, 20)], mavlink.MAV_MISSION_UNSUPPORTED),
        ([item(0), item(1, 2000)], mavlink.MAV_MISSION_UNSUPPORTED),
        ([item(0), item(1, TAKEOFF)], mavlink.MAV_MISSION_UNSUPPORTED),
        ([item(0), item(1, LAND, x=1, y=1)], mavlink.MAV_MISSION_UNSUPPORTED),
        ([item(0), item(1, LAND, x=0, y=0), item(2)], mavlink.MAV_MISSION_UNSUPPORTED),
        ([item(0), item(1, SPEED, param2=nan)], mavlink.MAV_MISSION_UNSUPPORTED),
        ([item(0), item(1, frame=10)], mavlink.MAV_MISSION_UNSUPPORTED_FRAME),
        ([item(0), item(1, z=nan)], mavlink.MAV_MISSION_INVALID_PARAM7),
        ([item(0, TAKEOFF)], mavlink.MAV_MISSION_INVALID),
    ],
)
def test_nothing_is_left_out_silently(items: list[Any], result: int) -> None:
    understood = meant(*items)
    assert isinstance(understood, NotUnderstood)
    assert understood.result == result


def test_a_fence_that_came_as_a_mission_says_so() -> None:
    outputs = upload(Stepping(), [item(0, FENCE_CORNER), item(1, FENCE_CORNER)])
    assert ack(outputs) == mavlink.MAV_MISSION_UNSUPPORTED
    assert "MAVLink 2" in text(outputs)


FLOATS = st.floats(width=32) | st.sampled_from([0.0, 1.0, 21196.0])
COMMANDS = st.sampled_from([16, 20, 21, 22, 93, 178, 205, 1000, 5001]) | st.integers(0, 65535)


@given_examples(
    st.lists(
        st.tuples(COMMANDS, st.integers(0, 255), *(FLOATS,) * 4, st.integers(-(2**31), 2**31 - 1))
    )
)
def test_any_items_are_a_mission_or_a_sentence(fields: list[tuple[Any, ...]]) -> None:
    items = [
        item(seq, command, z=z, frame=frame, param1=one, param2=two, param4=four, x=x)
        for seq, (command, frame, one, two, four, z, x) in enumerate(fields)
    ]
    assert isinstance(meant(*items), Mission | NotUnderstood)


# The fence.

SQUARE = [[-93.6, 41.9], [-93.5, 41.9], [-93.5, 42.0], [-93.6, 41.9]]
FEATURES = (
    SiteFeature("boundary", {"type": "Polygon", "coordinates": [SQUARE]}),
    SiteFeature("keep_out", {"type": "MultiPolygon", "coordinates": [[SQUARE], [SQUARE]]}),
    SiteFeature("height_zones", {"type": "Polygon", "coordinates": [SQUARE]}),
    SiteFeature("landing_pads", {"type": "Point", "coordinates": [-93.6, 41.9]}),
)


def zone(radius_m: float | None) -> TemporaryZoneStatus:
    ring = tuple((lon, lat) for lon, lat in SQUARE)
    kind = next(iter(TemporaryZoneKind))
    return TemporaryZoneStatus(1, "z", kind, ring, radius_m, None, None, "", "", 1.0, None)


def test_boundary_and_zones_are_items_of_a_fence() -> None:
    items = fence_items(FEATURES, (zone(None), zone(30.0)))
    assert [each.command for each in items] == [5001] * 3 + [5002] * 9 + [5004]
    assert [each.param1 for each in items] == [3.0] * 12 + [30.0]
    assert (items[0].x, items[0].y) == (419_000_000, -936_000_000)
    assert all(each.mission_type == 1 for each in items)


def test_a_fence_is_read_from_the_station_for_each_list() -> None:
    gateway = Stepping(GatewaySettings())
    wanted = mavlink.MAVLink_mission_request_list_message(1, 1, 1)
    (asked,) = gateway.receive(wanted)
    assert isinstance(asked, ReadFence)
    # Asked again while it is being read.
    assert gateway.receive(wanted) == ()
    items = fence_items(FEATURES, ())
    (total,) = sent(gateway.give(FenceRead(asked.token, items)))
    assert (total.count, total.mission_type) == (9, 1)
    question = mavlink.MAVLink_mission_request_int_message(1, 1, 4, 1)
    (got,) = sent(gateway.receive(question))
    assert (got.command, got.seq, got.mission_type) == (5002, 4, 1)
    beyond = mavlink.MAVLink_mission_request_int_message(1, 1, 9, 1)
    assert ack(gateway.receive(beyond)) == mavlink.MAV_MISSION_INVALID_SEQUENCE


def test_a_fence_that_cannot_be_read_is_an_error_with_a_sentence() -> None:
    gateway = Stepping()
    gateway.receive(mavlink.MAVLink_mission_request_list_message(1, 1, 1))
    outputs = gateway.give(FenceRead(1, problem="no answer"))
    assert (ack(outputs), text(outputs)) == (mavlink.MAV_MISSION_ERROR, "no answer")


@pytest.mark.parametrize("kind", [1, 2])
def test_fence_and_rally_points_are_not_taken(kind: int) -> None:
    gateway = Stepping()
    assert ack(gateway.receive(count(3, kind))) == mavlink.MAV_MISSION_DENIED
    clear = mavlink.MAVLink_mission_clear_all_message(1, 1, kind)
    assert ack(gateway.receive(clear)) == mavlink.MAV_MISSION_DENIED


def test_there_are_no_rally_points() -> None:
    wanted = mavlink.MAVLink_mission_request_list_message(1, 1, 2)
    (total,) = sent(Stepping().receive(wanted))
    assert (total.count, total.mission_type) == (0, 2)


def test_a_lost_vehicle_keeps_its_mission() -> None:
    gateway = with_mission()
    gateway.give(seen(9.0, staleness="lost", telemetry_age_s=4.0))
    assert gateway.state.vehicles[1].mission is not None
