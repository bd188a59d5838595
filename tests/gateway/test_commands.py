"""Commands of clients: what each orders, and its one answer."""

from math import nan

import pytest
from pymavlink.dialects.v20 import common as mavlink
from tests.gateway.fleet_state import Stepping, sent, text, types

from recon.gateway.mavlink.inputs_outputs import Output, PlaceOrder, StationAnswered
from recon.gateway.mavlink.values import GatewaySettings, Sender
from recon.model.command import Body, GoTo, Hover, LandNow, Refusal, ReturnHome
from recon.model.geo import LatLon

SET_MODE = mavlink.MAV_CMD_DO_SET_MODE
UNKNOWN = 2**31 - 1


def long(command: int, *params: float, target: int = 1, confirmation: int = 0) -> object:
    full = (*params, *(0.0,) * (7 - len(params)))
    return mavlink.MAVLink_command_long_message(target, 1, command, confirmation, *full)


def goto(frame: int, x: int, y: int, z: float, speed: float = -1.0) -> object:
    command = mavlink.MAV_CMD_DO_REPOSITION
    return mavlink.MAVLink_command_int_message(
        1, 1, frame, command, 0, 0, speed, 1.0, 0.0, nan, x, y, z
    )


def ordered(outputs: tuple[Output, ...]) -> list[Body]:
    return [output.body for output in outputs if isinstance(output, PlaceOrder)]


def result(outputs: tuple[Output, ...]) -> int:
    (ack,) = (m for m in sent(outputs) if m.get_type() == "COMMAND_ACK")
    assert (ack.target_system, ack.target_component) == (255, 190)
    return ack.result


@pytest.mark.parametrize(
    ("message", "body"),
    [
        (long(SET_MODE, 1, 4, 3), Hover()),
        (long(SET_MODE, 1, 4, 5), ReturnHome()),
        (long(SET_MODE, 1, 4, 6), LandNow()),
        (mavlink.MAVLink_set_mode_message(1, 1, 4 << 16 | 3 << 24), Hover()),
        (long(mavlink.MAV_CMD_DO_SET_STANDARD_MODE, 5), ReturnHome()),
        (long(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH), ReturnHome()),
        (long(mavlink.MAV_CMD_NAV_LAND), LandNow()),
        (long(mavlink.MAV_CMD_NAV_LOITER_UNLIM), Hover()),
        (long(mavlink.MAV_CMD_DO_PAUSE_CONTINUE, 0), Hover()),
        # QGroundControl pauses, and changes the height alone.
        (long(mavlink.MAV_CMD_DO_REPOSITION, -1, 1, 0, nan, nan, nan, nan), Hover()),
        (
            long(mavlink.MAV_CMD_DO_REPOSITION, -1, 1, 0, nan, nan, nan, 300.0),
            GoTo(LatLon(41.9, -93.6), 22.0, 5.0),
        ),
        (goto(5, 419100000, -936100000, 318.0), GoTo(LatLon(41.91, -93.61), 40.0, 5.0)),
        (goto(6, 419100000, -936100000, 40.0, 8.0), GoTo(LatLon(41.91, -93.61), 40.0, 8.0)),
        (goto(6, UNKNOWN, UNKNOWN, nan), Hover()),
    ],
)
def test_what_a_command_orders(message: object, body: Body) -> None:
    gateway = Stepping(GatewaySettings(allow_orders=True, ground_above_sea_level_m=278.0))
    assert ordered(gateway.receive(message)) == [body]


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (long(SET_MODE, 1, 1, 0), mavlink.MAV_RESULT_DENIED),
        (long(SET_MODE, 1, nan, nan), mavlink.MAV_RESULT_DENIED),
        (long(mavlink.MAV_CMD_MISSION_START), mavlink.MAV_RESULT_DENIED),
        (long(mavlink.MAV_CMD_NAV_TAKEOFF), mavlink.MAV_RESULT_DENIED),
        (long(mavlink.MAV_CMD_DO_FLIGHTTERMINATION, 1), mavlink.MAV_RESULT_DENIED),
        (long(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0, 21196), mavlink.MAV_RESULT_DENIED),
        (long(mavlink.MAV_CMD_DO_PAUSE_CONTINUE, 1), mavlink.MAV_RESULT_DENIED),
        (long(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1), mavlink.MAV_RESULT_UNSUPPORTED),
        (goto(10, 419100000, -936100000, 40.0), 9),
    ],
)
def test_what_is_no_order(message: object, expected: int) -> None:
    outputs = Stepping().receive(message)
    assert (ordered(outputs), result(outputs)) == ([], expected)


def test_a_gateway_without_orders_refuses_with_a_sentence() -> None:
    outputs = Stepping(GatewaySettings()).receive(long(SET_MODE, 1, 4, 3))
    assert (ordered(outputs), result(outputs)) == ([], mavlink.MAV_RESULT_DENIED)
    assert "--allow-orders" in text(outputs)


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        ("boundary", mavlink.MAV_RESULT_DENIED),
        ("preflight", mavlink.MAV_RESULT_TEMPORARILY_REJECTED),
    ],
)
def test_a_refusal_comes_back_with_its_sentence(rule: str, expected: int) -> None:
    gateway = Stepping()
    gateway.receive(long(SET_MODE, 1, 4, 3))
    reason = "SIM-1: " + "a long reason " * 8
    outputs = gateway.give(StationAnswered(1, Refusal(rule, reason)))
    assert (result(outputs), text(outputs)) == (expected, reason)
    pieces = [m for m in sent(outputs) if m.get_type() == "STATUSTEXT"]
    assert [piece.chunk_seq for piece in pieces] == list(range(len(pieces)))
    assert types(outputs)[-1] == "COMMAND_ACK"


def test_a_sentence_of_full_pieces_is_ended_by_an_empty_one() -> None:
    gateway = Stepping()
    gateway.receive(long(SET_MODE, 1, 4, 3))
    outputs = gateway.give(StationAnswered(1, problem="x" * 100))
    pieces = [m.text for m in sent(outputs) if m.get_type() == "STATUSTEXT"]
    assert pieces == ["x" * 50, "x" * 50, ""]
    assert result(outputs) == mavlink.MAV_RESULT_FAILED


def test_a_repetition_orders_nothing_twice() -> None:
    gateway = Stepping()
    fly = goto(6, 419100000, -936100000, 40.0)
    assert len(ordered(gateway.receive(fly))) == 1
    assert gateway.receive(fly) == ()
    gateway.give(StationAnswered(1, command_id=7))
    again = gateway.receive(fly)
    assert (ordered(again), result(again)) == ([], mavlink.MAV_RESULT_ACCEPTED)
    gateway.now_ns += 3_000_000_000
    assert len(ordered(gateway.receive(fly))) == 1


def test_a_stop_is_never_taken_for_a_repetition() -> None:
    gateway = Stepping()
    for _ in range(3):
        assert ordered(gateway.receive(long(SET_MODE, 1, 4, 3))) == [Hover()]


def test_a_refused_order_may_be_given_again_at_once() -> None:
    gateway = Stepping()
    fly = goto(6, 419100000, -936100000, 40.0)
    gateway.receive(fly)
    gateway.give(StationAnswered(1, Refusal("preflight", "no")))
    assert len(ordered(gateway.receive(fly))) == 1


def test_orders_under_way_are_bounded_and_stops_still_pass() -> None:
    gateway = Stepping()
    for number in range(100):
        outputs = gateway.receive(goto(6, number, 0, 40.0))
    assert result(outputs) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    assert len(gateway.state.pending) == 64
    assert ordered(gateway.receive(long(SET_MODE, 1, 4, 3))) == [Hover()]


def test_commands_to_others_are_ignored() -> None:
    gateway = Stepping()
    assert gateway.receive(long(SET_MODE, 1, 4, 3, target=2)) == ()
    camera = mavlink.MAVLink_command_long_message(1, 100, SET_MODE, 0, 1, 4, 3, 0, 0, 0, 0)
    assert gateway.receive(camera) == ()
    # To all, where there is one: as clients send before they know an id.
    assert ordered(gateway.receive(long(SET_MODE, 1, 4, 3, target=0))) == [Hover()]


def test_an_answer_goes_to_the_client_that_asked() -> None:
    gateway = Stepping()
    gateway.receive(long(SET_MODE, 1, 4, 3), Sender(5, 200, 1))
    (output,) = gateway.give(StationAnswered(1, command_id=7))
    assert output.peer == 5
    assert output.messages[0].target_system == 200


@pytest.mark.parametrize(
    "message",
    [
        long(mavlink.MAV_CMD_REQUEST_MESSAGE, 148),
        long(mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, 1),
    ],
)
def test_the_version_is_asked_for_in_the_new_and_the_old_way(message: object) -> None:
    outputs = Stepping().receive(message)
    assert types(outputs) == ["COMMAND_ACK", "AUTOPILOT_VERSION"]
    # Without it MAVSDK sends no mission.
    assert sent(outputs)[1].capabilities & mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT


@pytest.mark.parametrize("number", [242, 435, 0, -1, nan, 1e30])
def test_messages_that_there_are_not_are_unsupported(number: float) -> None:
    # 242 is home, which is not known of a vehicle that was never seen on the ground.
    outputs = Stepping().receive(long(mavlink.MAV_CMD_REQUEST_MESSAGE, number))
    assert result(outputs) == mavlink.MAV_RESULT_UNSUPPORTED


def test_the_time_and_the_parameter_are_answered() -> None:
    gateway = Stepping()
    question = mavlink.MAVLink_timesync_message(0, 42)
    (answer,) = sent(gateway.receive(question))
    assert (answer.ts1, answer.tc1) == (42, gateway.now_ns)
    assert gateway.receive(mavlink.MAVLink_timesync_message(7, 42)) == ()
    for message in (
        mavlink.MAVLink_param_request_list_message(1, 1),
        mavlink.MAVLink_param_request_read_message(1, 1, b"", 0),
        mavlink.MAVLink_param_set_message(1, 1, b"RECON_SYSID", 9.0, 9),
    ):
        (value,) = sent(gateway.receive(message))
        assert (value.param_id, value.param_value, value.param_count) == ("RECON_SYSID", 1.0, 1)
