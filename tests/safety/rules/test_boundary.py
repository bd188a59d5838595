"""The boundary is kept along whole legs, corners, the path there and the route home."""

from dataclasses import replace

import pytest
from tests.safety.cases import NOW, command
from tests.safety.fenced import (
    WIDE,
    airspace,
    asked,
    flier,
    goto,
    here,
    mission,
    reason,
    region,
    square,
    stick,
)

from recon.model.command import Body, HoldPosition, Hover, LandNow, Nudge, ReturnHome
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety.path.pieces import PathVolume
from recon.safety.path.volumes import path_volume
from recon.safety.rules.boundary import boundary

L_SHAPE = region((-50, -50), (400, -50), (400, 50), (50, 50), (50, 400), (-50, 400))
WHOLE = airspace(boundary=square(-50.0, -50.0, 400.0, 400.0))
CORNERED = airspace(boundary=L_SHAPE)


def refusal_text(body: Body, state: VehicleState | None = None) -> str:
    return reason(asked(boundary, body, CORNERED, state))


def is_allowed(body: Body, state: VehicleState | None = None) -> bool:
    return asked(boundary, body, CORNERED, state) is None


class TestMissions:
    inside = mission((0.0, 300.0, 40.0), (20.0, 100.0, 40.0))

    def test_inside_is_allowed(self) -> None:
        assert is_allowed(self.inside)

    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_stops_are_never_asked(self, body: Body) -> None:
        assert is_allowed(body, flier(1_000.0, 0.0))

    def test_without_a_boundary_nothing_is_outside(self) -> None:
        assert asked(boundary, mission((9e3, 0, 40), (0, 0, 40)), airspace()) is None

    def test_a_leg_across_the_notch_is_refused_though_its_ends_are_inside(self) -> None:
        arms = mission((0.0, 300.0, 40.0), (300.0, 0.0, 40.0))
        assert asked(boundary, arms, WHOLE) is None
        assert refusal_text(arms) == (
            "A: leg 1 to 2 goes 100.0 m beyond the site's boundary; it must stay inside, 5 m from "
            "the edge"
        )

    @pytest.mark.parametrize(("east_m", "allowed"), [(44.9, True), (45.1, False)])
    def test_the_margin_is_kept(self, east_m: float, allowed: bool) -> None:
        body = mission((0.0, 300.0, 40.0), (east_m, 300.0, 40.0))
        assert is_allowed(body) is allowed
        assert allowed or refusal_text(body) == (
            "A: leg 1 to 2 comes within 4.90 m of the site's boundary; it must stay inside, 5 m "
            "from the edge"
        )

    def test_the_way_to_the_first_waypoint_counts(self) -> None:
        assert is_allowed(self.inside, flier(0.0, 0.0))
        assert refusal_text(self.inside, flier(300.0, 0.0)).startswith(
            "A: the leg to waypoint 1 goes 100.0 m beyond"
        )

    def test_the_route_home_counts(self) -> None:
        """Its legs are in one arm, its home is in the other."""
        away = flier(0.0, 300.0, takeoff_point=flier(300.0, 0.0).position.value)
        assert refusal_text(self.inside, away).startswith(
            "A: the route home from the leg to waypoint 1 goes 100.0 m beyond"
        )

    def test_unless_the_aircraft_hovers_by_itself(self) -> None:
        home = flier(300.0, 0.0).position.value
        for failsafe in (Failsafe.HOVER, Failsafe.LAND):
            assert is_allowed(self.inside, flier(0.0, 300.0, takeoff_point=home, failsafe=failsafe))

    def test_a_home_in_the_margin_is_no_home_to_come_to(self) -> None:
        state = flier(0.0, 0.0, takeoff_point=flier(0.0, -46.0).position.value)
        assert "the route home from" in refusal_text(self.inside, state)
        assert "comes within 4.00 m" in refusal_text(self.inside, state)

    def test_a_rounded_corner_counts(self) -> None:
        """Between the arms, just inside: cutting the corner by 30 m leaves the site."""
        turn = ((30.0, 300.0, 40.0), (30.0, 30.0, 40.0), (300.0, 30.0, 40.0))
        assert is_allowed(mission(*turn, curved=True, radius_m=20.0))
        assert is_allowed(mission(*turn, radius_m=80.0))
        assert refusal_text(mission(*turn, curved=True, radius_m=80.0)).startswith(
            "A: the corner at waypoint 2 goes 19.8 m beyond"
        )

    def test_a_hole_is_outside(self) -> None:
        holed = airspace(
            boundary=region(
                (-50, -50), (400, -50), (400, 400), (-50, 400),
                holes=[[(90, 90), (110, 90), (110, 110), (90, 110)]],
            )
        )  # fmt: skip
        body = mission((40.0, 100.0, 40.0), (200.0, 100.0, 40.0))
        assert asked(boundary, body, WHOLE) is None
        assert "leg 1 to 2 goes" in reason(asked(boundary, body, holed))

    def test_a_vehicle_that_is_nowhere_known_is_refused(self) -> None:
        assert "position unknown" in refusal_text(self.inside, flier(position=Stamped()))
        assert "home unknown" in refusal_text(self.inside, flier(takeoff_point=None))


class TestSteered:
    @pytest.mark.parametrize(("north_m", "allowed"), [(391.9, True), (392.1, False)])
    def test_a_goto_keeps_the_margin_with_what_it_may_pass_its_target_by(
        self, north_m: float, allowed: bool
    ) -> None:
        assert is_allowed(goto(0.0, north_m)) is allowed

    def test_a_goto_across_the_notch_is_refused(self) -> None:
        assert "the leg to the target" in refusal_text(goto(0.0, 300.0), flier(300.0, 0.0))

    def test_a_nudge_is_measured_from_the_vehicle(self) -> None:
        assert is_allowed(Nudge(0.0, 10.0, 0.0), flier(30.0, 300.0))
        assert "the nudge" in refusal_text(Nudge(0.0, 20.0, 0.0), flier(30.0, 300.0))

    def test_holding_the_place_is_allowed_wherever_it_is(self) -> None:
        for east_m in (0.0, 48.0, 90.0):
            assert is_allowed(HoldPosition(), flier(east_m, 300.0))
        assert "position unknown" in refusal_text(HoldPosition(), flier(position=Stamped()))

    @pytest.mark.parametrize(("speed_mps", "allowed"), [(9.9, True), (10.1, False)])
    def test_a_stick_reaches_as_far_as_it_brakes(self, speed_mps: float, allowed: bool) -> None:
        """At 10 m/s: 10 m in its second and 20 m of braking, from 35 m inside."""
        assert is_allowed(stick(0.0, speed_mps), flier(15.0, 300.0)) is allowed

    def test_a_stick_without_velocity_is_never_refused(self) -> None:
        for state in (flier(900.0, 0.0), flier(position=Stamped()), flier(takeoff_point=None)):
            assert is_allowed(stick(0.0, 0.0), state)

    def test_a_stick_with_velocity_needs_to_know_where(self) -> None:
        assert "position unknown" in refusal_text(stick(0.1, 0.0), flier(position=Stamped()))


class TestAlreadyOutside:
    """70 m east of home in the upper arm is 20 m beyond its edge."""

    out = flier(70.0, 300.0)

    def test_back_in_is_allowed(self) -> None:
        assert is_allowed(stick(0.0, -10.0), self.out)
        assert is_allowed(goto(20.0, 300.0), self.out)
        assert is_allowed(mission((20.0, 300.0, 40.0), (20.0, 100.0, 40.0)), self.out)

    def test_farther_out_is_not(self) -> None:
        assert refusal_text(stick(0.0, 1.0), self.out) == (
            "A: the stick's path goes 21.2 m beyond the site's boundary; the vehicle is 20.00 m "
            "outside now and may only be moved back in"
        )

    def test_along_the_edge_it_may_be_moved(self) -> None:
        assert is_allowed(stick(1.0, 0.0), self.out)
        assert is_allowed(stick(1.0, -0.1), self.out)
        assert not is_allowed(stick(1.0, 0.1), self.out)

    def test_what_comes_later_must_keep_the_margin(self) -> None:
        body = mission((40.0, 300.0, 40.0), (47.0, 300.0, 40.0), (0.0, 100.0, 40.0))
        assert refusal_text(body, self.out).endswith("it must stay inside, 5 m from the edge")

    def test_its_route_home_may_go_no_farther_out_either(self) -> None:
        """From far up the notch the route home leads through the middle of it: a stick may help."""
        deep = flier(300.0, 55.0, takeoff_point=flier(20.0, 390.0).position.value)
        assert "the route home from the leg to the target" in refusal_text(goto(300.0, 0.0), deep)
        assert is_allowed(stick(-5.0, 0.0), deep)

    @pytest.mark.parametrize(("east_mps", "allowed"), [(-0.5, True), (0.5, False)])
    def test_in_the_margin_it_is_the_same(self, east_mps: float, allowed: bool) -> None:
        near = flier(47.0, 300.0)
        assert is_allowed(stick(0.0, east_mps), near) is allowed
        assert allowed or "is 3.00 m inside now" in refusal_text(stick(0.0, east_mps), near)

    def test_close_to_the_edge_the_words_say_which_side(self) -> None:
        assert "comes within 0.50 m of the site's boundary" in refusal_text(
            mission((0.0, 300.0, 40.0), (49.5, 300.0, 40.0))
        )
        assert "is 0.50 m inside now" in refusal_text(stick(0.0, 0.1), flier(49.5, 300.0))

    def test_on_the_margin_itself_it_may_be_moved_inwards(self) -> None:
        """The margin is counted as kept only beyond it: there, the path in must still be open."""
        state = flier(45.0, 300.0)
        fence = CORNERED.boundary
        assert fence is not None
        path = path_volume(command(stick(0.0, -1.0)), here(CORNERED, state))
        assert isinstance(path, PathVolume)
        margin_m = float(fence.room_m(path.here)[0])
        exact = airspace(boundary=L_SHAPE, limits=replace(WIDE, boundary_margin_m=margin_m))
        assert asked(boundary, stick(0.0, -1.0), exact, state) is None
        assert reason(asked(boundary, stick(0.0, 1.0), exact, state)).endswith(
            "; the vehicle is 5.00 m inside now and may only be moved back in"
        )

    def test_the_edge_itself_is_called_inside(self) -> None:
        state = flier(0.0, 0.0)
        path = path_volume(command(stick(0.0, -1.0)), here(WHOLE, state))
        assert isinstance(path, PathVolume)
        east = airspace(boundary=square(float(path.here_m[0]), -400.0, 400.0, 400.0))
        assert reason(asked(boundary, stick(0.0, -1.0), east, state)).endswith(
            "; the vehicle is 0.00 m inside now and may only be moved back in"
        )

    def test_a_path_that_touches_the_edge_is_not_beyond_it(self) -> None:
        touches = mission((0.0, 0.0, 40.0), (100.0, 100.0, 40.0))
        away = flier(100.0, 0.0, takeoff_point=flier(100.0, 0.0).position.value)
        path = path_volume(command(touches), here(WHOLE, away))
        assert isinstance(path, PathVolume)
        west_m = float(path.pieces.triangles_m[..., 0].min())
        east = airspace(boundary=square(west_m, -400.0, 400.0, 400.0))
        assert reason(asked(boundary, touches, east, away)) == (
            "A: the leg to waypoint 1 comes within 0.00 m of the site's boundary; it must stay "
            "inside, 5 m from the edge"
        )

    def test_a_stick_that_crosses_an_arm_may_not_leave_it_on_the_other_side(self) -> None:
        assert is_allowed(stick(0.0, -15.0, timeout_s=2.0), self.out)
        assert "beyond" in refusal_text(stick(0.0, -15.0, timeout_s=7.0), self.out)


def test_telemetry_of_no_position_at_all_is_refused() -> None:
    state = flier(position=Stamped(None, NOW))
    assert "position unknown" in refusal_text(goto(0.0, 0.0), state)
