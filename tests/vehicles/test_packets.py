"""Commands into packets (ICD 3.2; decisions 8, 9 and 11)."""

from dataclasses import replace
from math import isnan

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.safety.cases import STICK, mission, waypoint

from recon import wire
from recon.model.command import (
    BODY_NAMES,
    STEERED_BODIES,
    Body,
    Hover,
    LandNow,
    LockCamera,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
)
from recon.model.report import AnsweredKind
from recon.vehicles.packets import answered_kind, describe_altitudes, to_packet

EVERY_BODY: list[Body] = [
    Hover(),
    LandNow(),
    ReturnHome(),
    StartCamera(2.0),
    StopCamera(),
    LockCamera(True),
    mission(),
    STICK,
]


def written(body: Body, offset_m: float = 0.0) -> wire.ExecuteWaypointMission:
    packet = to_packet(body, offset_m)
    assert isinstance(packet, wire.ExecuteWaypointMission)
    return packet


def test_every_body_has_a_packet_that_encodes_and_comes_back() -> None:
    assert {type(body) for body in EVERY_BODY} == set(BODY_NAMES) - set(STEERED_BODIES)
    for body in EVERY_BODY:
        data = wire.encode(to_packet(body, 0.0))
        assert wire.encode(wire.decode(data)) == data
        assert data[6] == answered_kind(body)


@pytest.mark.parametrize(("body", "action"), [(Hover(), 0), (LandNow(), 1), (ReturnHome(), 2)])
def test_emergency_actions(body: Body, action: int) -> None:
    assert to_packet(body, 0.0) == wire.EmergencyCommand(action=action)
    assert answered_kind(body) is AnsweredKind.EMERGENCY


def test_hover_is_the_documents_example() -> None:
    assert wire.encode(to_packet(Hover(), 0.0)).hex() == "daa70000000aff008a7d"


def test_a_stop_carries_0_for_its_ignored_rate() -> None:
    assert to_packet(StopCamera(), 0.0) == wire.CameraControl(action=0, target_fps_hz=0.0)
    assert to_packet(LockCamera(True), 0.0) == wire.CameraControl(action=2, target_fps_hz=0.0)
    assert to_packet(LockCamera(False), 0.0) == wire.CameraControl(action=3, target_fps_hz=0.0)
    assert to_packet(StartCamera(2.0), 0.0) == wire.CameraControl(action=1, target_fps_hz=2.0)


class TestMission:
    def test_no_action_is_nan_and_nothing_else_is(self) -> None:
        first = written(mission()).waypoints[0]
        assert isnan(first.loiter_time_s)
        assert isnan(first.gimbal_pitch_deg)
        acting = waypoint(0.0, loiter_s=0.0, gimbal_pitch_deg=-90.0)
        first = written(mission(acting, waypoint(50.0))).waypoints[0]
        assert (first.loiter_time_s, first.gimbal_pitch_deg) == (0.0, -90.0)

    def test_the_ignored_corner_radius_is_sent_as_0_2(self) -> None:
        points = (waypoint(0.0, corner_radius_m=7.0), waypoint(50.0))
        straight, curved = written(mission(*points)), written(mission(*points, curved=True))
        assert straight.waypoints[0].corner_radius_m == pytest.approx(0.2)
        assert straight.curved_flight == 0
        assert curved.waypoints[0].corner_radius_m == 7.0
        assert curved.curved_flight == 1

    def test_land_at_end(self) -> None:
        landing = replace(mission(), mission=replace(mission().mission, land_at_end=True))
        assert written(landing).land_at_end == 1
        assert written(mission()).land_at_end == 0

    def test_the_offset_is_added_to_every_height(self) -> None:
        packet = written(mission(waypoint(0.0), waypoint(50.0, height_above_takeoff_m=60.0)), 260.0)
        assert [w.altitude_m for w in packet.waypoints] == [300.0, 320.0]

    def test_console_log_and_audit_are_reported_what_was_sent(self) -> None:
        assert describe_altitudes(mission(), None) == "sent as 40.0 to 40.0 m above takeoff"
        assert describe_altitudes(mission(), 260.0) == (
            "40.0 to 40.0 m above takeoff, sent as 300.0 to 300.0 m WGS84 "
            "(offset +260.0 m from its own telemetry)"
        )
        assert describe_altitudes(Hover(), None) is None


class TestStick:
    @given(st.floats(-1e6, 1e6))
    def test_yaw_goes_out_wrapped(self, yaw_deg: float) -> None:
        packet = to_packet(replace(STICK, yaw_deg=yaw_deg), 0.0)
        assert isinstance(packet, wire.VirtualStickCommand)
        assert -180.0 <= packet.yaw_deg <= 180.0
        turns = (packet.yaw_deg - yaw_deg) / 360.0
        assert turns == pytest.approx(round(turns), abs=1e-5)

    def test_mode_a_is_ground_and_mode_b_is_body(self) -> None:
        ground = to_packet(STICK, 0.0)
        body = to_packet(replace(STICK, frame=StickFrame.BODY), 0.0)
        assert isinstance(ground, wire.VirtualStickCommand)
        assert isinstance(body, wire.VirtualStickCommand)
        assert (ground.mode, body.mode) == (0, 1)

    def test_its_height_is_above_takeoff_and_gets_no_offset(self) -> None:
        packet = to_packet(STICK, 260.0)
        assert isinstance(packet, wire.VirtualStickCommand)
        assert packet.height_above_takeoff_m == STICK.height_above_takeoff_m
