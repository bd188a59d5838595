"""The path an order sends its vehicle on, row by row, and until when traffic is predicted."""

import pytest
from tests.safety.traffic import SETTINGS, aircraft, at, flies, route, seen

from recon.model.command import Body, FlyMission, GoTo, HoldPosition, StickFrame, VirtualStick
from recon.model.vehicle import VehicleState
from recon.safety.prediction import FlightPart, Trajectory, predict_order, predict_traffic
from recon.safety.prediction.legs import LEAST_S
from recon.safety.prediction.trajectory import (
    EAST_1,
    END_S,
    NORTH_1,
    PART,
    RADIUS_0,
    RADIUS_1,
    START_S,
    sample,
)


def ordered(body: Body, state: VehicleState) -> Trajectory:
    return predict_order(seen(state), body, SETTINGS)


def stick(
    north_mps: float, east_mps: float, timeout_s: float = 1.0, height_m: float = 40.0
) -> VirtualStick:
    return VirtualStick(StickFrame.GROUND, 0.0, north_mps, east_mps, height_m, timeout_s)


def turn(yaw_deg: float, forward_mps: float) -> VirtualStick:
    return VirtualStick(StickFrame.BODY, yaw_deg, forward_mps, 0.0, 40.0, 1.0)


def test_it_bears_the_vehicles_name() -> None:
    assert ordered(GoTo(at(50.0, 0.0), 40.0, 5.0), aircraft("A")).name == "A"


def test_a_moving_vehicle_that_is_to_hold_reacts_and_brakes() -> None:
    """From 5 m/s: 5 m in the reaction's second and 5 m of braking."""
    held = ordered(HoldPosition(), aircraft(velocity=(5.0, 0.0, 0.0)))
    assert held.rows[-1, NORTH_1] == pytest.approx(10.0)


@pytest.mark.parametrize(("speed_mps", "first"), [(0.49, 0), (0.5, FlightPart.STOPPING)])
def test_a_mission_begins_with_a_stop_unless_the_vehicle_stands(
    speed_mps: float, first: int
) -> None:
    state = aircraft(velocity=(speed_mps, 0.0, 0.0))
    flown = ordered(FlyMission(route((0.0, 0.0), (50.0, 0.0))), state)
    assert flown.rows[0, PART] == first


class TestTraffic:
    @pytest.mark.parametrize(
        ("velocity", "passed", "delay_s"),
        [
            ((0.0, 0.0, 0.0), 0, 8.2),
            ((0.4, 0.0, 0.0), 0, 8.2),
            ((0.5, 0.0, 0.0), 0, 0.0),
            ((0.0, 0.5, 0.0), 0, 0.0),
            ((0.4, 0.4, 0.0), 0, 0.0),
            ((0.0, 0.0, -0.5), 0, 0.0),
            ((0.0, 0.0, 0.0), 1, 0.0),
        ],
    )
    def test_a_mission_may_begin_late_while_its_vehicle_stands_before_its_first_leg(
        self, velocity: tuple[float, float, float], passed: int, delay_s: float
    ) -> None:
        motion = seen(aircraft(velocity=velocity))
        flown = predict_traffic(motion, flies(route((50.0, 0.0), (99.0, 0.0)), passed), SETTINGS, 9)
        assert [trajectory.delay_s for trajectory in flown] == pytest.approx([delay_s])

    def test_it_is_predicted_no_longer_than_it_is_of_interest(self) -> None:
        mission = route(*((20.0 * n, 0.0) for n in range(1, 90)))
        (flown,) = predict_traffic(seen(aircraft()), flies(mission), SETTINGS, 10.0)
        assert 10.0 < flown.rows[-1, END_S] < 20.0


class TestSticks:
    def test_its_velocity_is_kept_for_its_time_and_the_reaction_and_braked(self) -> None:
        """At 5 m/s already: 2 s, 1 s, and 5 m; none of it beside the line."""
        flown = ordered(stick(3.0, 4.0, 2.0), aircraft(velocity=(3.0, 4.0, 0.0))).rows
        assert flown[-1, [EAST_1, NORTH_1]] == pytest.approx([16.0, 12.0], abs=0.01)
        assert set(flown[:, PART]) == {FlightPart.STEERED}
        assert flown[:, [RADIUS_0, RADIUS_1]].max() == 0.0
        assert (flown[:, END_S] > flown[:, START_S]).all()

    def test_a_change_of_velocity_is_within_its_bow_of_the_straight_line(self) -> None:
        """From 2 to 4 m/s in 0.8 s: a parabola's bow is an eighth of 2 m/s times 0.8 s."""
        flown = ordered(stick(4.0, 0.0), aircraft(velocity=(2.0, 0.0, 0.0))).rows
        changes = flown[1]
        assert changes[END_S] - changes[START_S] == pytest.approx(0.8)
        assert changes[NORTH_1] == pytest.approx(3.0 * 0.8, abs=0.01)
        assert changes[[RADIUS_0, RADIUS_1]] == pytest.approx([0.2, 0.2])
        assert flown[2:, [RADIUS_0, RADIUS_1]].tolist() == [[0.0, 0.0]] * len(flown[2:])

    @pytest.mark.parametrize(("yaw_deg", "radius_m"), [(15.0, 0.0), (16.0, 4.0 + 0.8)])
    def test_one_that_turns_by_more_than_15_degrees_sweeps_a_disc(
        self, yaw_deg: float, radius_m: float
    ) -> None:
        assert ordered(turn(yaw_deg, 2.0), aircraft()).rows[-1, RADIUS_1] == pytest.approx(radius_m)

    def test_the_disc_is_as_wide_as_its_vehicles_own_speed_takes_it(self) -> None:
        """At 10 m/s: a second, the reaction's, and 20 m of braking, however slow the stick."""
        swept = ordered(turn(90.0, 2.0), aircraft(velocity=(10.0, 0.0, 0.0))).rows[-1]
        assert swept[RADIUS_1] == pytest.approx(40.0)
        assert swept[END_S] == pytest.approx(2.0 + LEAST_S)
        assert swept[PART] == FlightPart.STEERED

    @pytest.mark.parametrize("age_s", [0.0, 1.0])
    def test_until_now_it_has_flown_on_at_its_own_height(self, age_s: float) -> None:
        state = aircraft(velocity=(4.0, 3.0, 0.0), age_s=age_s)
        rows = ordered(stick(4.0, 3.0, height_m=60.0), state).rows
        found = sample([rows], [-age_s, -0.5 * age_s, 0.0, 0.1])
        gone_s = [0.0, 0.5 * age_s, age_s, age_s + 0.1]
        assert found.north_m[0] == pytest.approx([4.0 * s for s in gone_s], abs=1e-6)
        assert found.east_m[0] == pytest.approx([3.0 * s for s in gone_s], abs=1e-6)
        assert found.low_m[0].tolist() == [40.0] * 4
        assert found.high_m[0].tolist() == [40.0, 40.0, 40.0, 60.0]
