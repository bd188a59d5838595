"""Orders interpreted once: the motion they ask for, and how far a stick counts."""

from math import cos, hypot, inf, radians, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.safety.cases import mission, vehicle, waypoint

from recon.model.command import (
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    Nudge,
    StickFrame,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.mission import Mission
from recon.model.units import Stamped
from recon.model.vehicle import Attitude
from recon.safety.path.order_path import (
    HoldPath,
    StickFlight,
    StraightFlight,
    TakeoffClimb,
    as_sent,
    order_path,
)
from recon.safety.prediction_settings import StickBounds
from recon.safety.settings import SafetySettings

LIMITS = SafetySettings()
SPEEDS = st.floats(-15.0, 15.0, width=32)


def stick(x_mps: float, y_mps: float, yaw_deg: float, frame: StickFrame) -> StickFlight:
    state = vehicle(attitude=Stamped(Attitude(yaw_deg - 10.0, 0.0, 0.0), 1))
    path = order_path(VirtualStick(frame, yaw_deg, x_mps, y_mps, 40.0, 2.0), state)
    assert isinstance(path, StickFlight)
    return path


class TestMotions:
    def test_a_mission_is_itself(self) -> None:
        body = mission(waypoint(0.0), waypoint(50.0))
        assert order_path(body, vehicle()) is body.mission

    def test_what_moves_nothing_holds(self) -> None:
        assert order_path(FlyMission(Mission(())), vehicle()) == HoldPath()
        assert order_path(HoldPosition(), vehicle()) == HoldPath()
        lost = vehicle(position=Stamped())
        assert order_path(Nudge(5.0, 0.0, 0.0), lost) == HoldPath()

    def test_a_hover_is_a_takeoff(self) -> None:
        assert order_path(Hover(), vehicle()) == TakeoffClimb()

    def test_a_goto_is_straight(self) -> None:
        path = order_path(GoTo(LatLon(42.0, -93.6), 30.0, 4.0), vehicle())
        assert isinstance(path, StraightFlight)
        assert (path.target, path.height_above_takeoff_m, path.speed_mps) == (
            LatLon(42.0, -93.6),
            30.0,
            4.0,
        )

    def test_a_nudge_adds_to_the_present_height(self) -> None:
        state = vehicle(height_above_takeoff_m=Stamped(40.0, 1))
        path = order_path(Nudge(0.0, 0.0, 3.0, 2.5), state)
        assert isinstance(path, StraightFlight)
        assert (path.height_above_takeoff_m, path.speed_mps) == (43.0, 2.5)
        unknown = order_path(Nudge(0.0, 0.0, 3.0), vehicle(height_above_takeoff_m=Stamped()))
        assert isinstance(unknown, StraightFlight)
        assert unknown.height_above_takeoff_m is None


class TestSticks:
    @given(x_mps=SPEEDS, y_mps=SPEEDS, yaw_deg=st.floats(-180.0, 180.0, width=32))
    def test_a_body_stick_leads_forward_and_right_of_its_yaw(
        self, x_mps: float, y_mps: float, yaw_deg: float
    ) -> None:
        """Forward is (sin, cos) of the yaw in east and north; right is a quarter turn clockwise."""
        yaw = radians(yaw_deg)
        east_mps, north_mps = stick(x_mps, y_mps, yaw_deg, StickFrame.BODY).east_north_mps()
        assert east_mps == pytest.approx(x_mps * sin(yaw) + y_mps * cos(yaw), abs=1e-4)
        assert north_mps == pytest.approx(x_mps * cos(yaw) - y_mps * sin(yaw), abs=1e-4)

    @given(x_mps=SPEEDS, y_mps=SPEEDS, yaw_deg=st.floats(-180.0, 180.0, width=32))
    def test_a_ground_stick_leads_north_and_east_whatever_its_yaw(
        self, x_mps: float, y_mps: float, yaw_deg: float
    ) -> None:
        path = stick(x_mps, y_mps, yaw_deg, StickFrame.GROUND)
        assert path.east_north_mps() == (y_mps, x_mps)
        assert path.turn_deg == 0.0
        assert path.frame is StickFrame.GROUND

    def test_the_turn_is_from_the_present_yaw(self) -> None:
        assert stick(1.0, 0.0, 90.0, StickFrame.BODY).turn_deg == pytest.approx(10.0)
        state = vehicle(attitude=Stamped(Attitude(175.0, 0.0, 0.0), 1))
        over_south = VirtualStick(StickFrame.BODY, -175.0, 1.0, 0.0, 40.0, 2.0)
        path = order_path(over_south, state)
        assert isinstance(path, StickFlight)
        assert path.turn_deg == pytest.approx(10.0)

    def test_numbers_are_the_wires_32_bit_floats(self) -> None:
        path = stick(1e-50, 0.1, 0.0, StickFrame.GROUND)
        assert path.north_mps == 0.0
        assert path.east_mps == 0.10000000149011612

    @pytest.mark.parametrize("beyond", [1e39, 1e300])
    def test_what_no_32_bit_float_holds_is_infinite(self, beyond: float) -> None:
        assert (as_sent(beyond), as_sent(-beyond)) == (inf, -inf)

    def test_another_speed_reaches_as_far_as_a_stick_of_that_speed(self) -> None:
        bounds = StickBounds(reaction_s=1.0, braking_mps2=2.0)
        slow = stick(2.0, 0.0, 0.0, StickFrame.GROUND)
        assert slow.reach_m(bounds) == pytest.approx(2.0 * 3.0 + 1.0)
        assert slow.reach_m(bounds, speed_mps=6.0) == pytest.approx(6.0 * 3.0 + 9.0)

    @given(x_mps=SPEEDS, y_mps=SPEEDS)
    def test_energy_counts_least_and_separation_most(self, x_mps: float, y_mps: float) -> None:
        path = stick(x_mps, y_mps, 0.0, StickFrame.GROUND)
        speed_mps = hypot(x_mps, y_mps)
        energy = path.reach_m(LIMITS.energy.stick)
        fences = path.reach_m(LIMITS.fences.stick)
        separation = path.reach_m(LIMITS.prediction.stick)
        assert energy == pytest.approx(2.0 * speed_mps)
        assert fences == pytest.approx(energy + speed_mps**2 / 5.0)
        assert separation == pytest.approx(fences + speed_mps)
