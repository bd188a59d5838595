"""The greatest height above ground, the route home included."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.cases import command, vehicle
from tests.safety.fenced import (
    WIDE,
    airspace,
    asked,
    flier,
    here,
    hills,
    mission,
    reason,
    stick,
)

from recon.model.command import Body, HoldPosition, Hover, Nudge, ReturnHome
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety import PreparedAirspace
from recon.safety.rules.max_height import max_height

LIMITS = replace(WIDE, max_height_above_ground_m=100.0)
FLAT = airspace(limits=LIMITS)


def over(heights: object) -> PreparedAirspace:
    return airspace(limits=LIMITS, elevation=hills(heights))


PIT = np.zeros((10, 10))
PIT[4, 7] = -30.0
"""A quarry 30 m deep, 250 m east and 50 m north of home."""


def is_allowed(body: Body, air: PreparedAirspace = FLAT, state: VehicleState | None = None) -> bool:
    return asked(max_height, body, air, state) is None


def refusal_text(
    body: Body, air: PreparedAirspace = FLAT, state: VehicleState | None = None
) -> str:
    return reason(asked(max_height, body, air, state))


def level(height_m: float) -> Body:
    return mission((0.0, 50.0, height_m), (300.0, 50.0, height_m))


class TestFlatGround:
    @pytest.mark.parametrize(("height_m", "allowed"), [(100.0, True), (100.01, False)])
    def test_the_limit(self, height_m: float, allowed: bool) -> None:
        assert is_allowed(level(height_m)) is allowed
        assert allowed or refusal_text(level(height_m)) == (
            "A: the leg to waypoint 1 must be at most 100 m above ground (flat ground "
            "assumed); got 100.0 m"
        )

    def test_the_default_is_120_metres(self) -> None:
        limited = airspace(limits=replace(WIDE, max_height_above_ground_m=120.0))
        assert is_allowed(level(120.0), limited)
        assert not is_allowed(level(121.0), limited)

    @pytest.mark.parametrize("body", [Hover(), ReturnHome()])
    def test_stops_are_not_asked(self, body: Body) -> None:
        assert is_allowed(body, state=flier(height_m=300.0))

    def test_corners_count(self) -> None:
        """On the legs it is refused as well; nothing else is as high."""
        body = mission((0.0, 50.0, 90.0), (100.0, 50.0, 110.0), (200.0, 90.0, 90.0), curved=True)
        assert refusal_text(body).startswith("A: leg 1 to 2 must be")
        assert refusal_text(body).endswith("got 110.0 m")


class TestTheWayHome:
    @pytest.mark.parametrize(("go_home_m", "allowed"), [(100.0, True), (101.0, False)])
    def test_the_go_home_height_counts(self, go_home_m: float, allowed: bool) -> None:
        state = flier(go_home_m=go_home_m)
        assert is_allowed(level(40.0), state=state) is allowed
        assert allowed or refusal_text(level(40.0), state=state) == (
            "A: the route home from the leg to waypoint 1 must be at most 100 m above ground (flat "
            "ground assumed); got 101.0 m; set a lower go-home height in the aircraft and in "
            "site.toml"
        )

    @pytest.mark.parametrize("failsafe", [Failsafe.HOVER, Failsafe.LAND])
    def test_unless_the_aircraft_does_not_go_home(self, failsafe: Failsafe) -> None:
        for height_m in (None, 300.0):
            assert is_allowed(level(40.0), state=flier(go_home_m=height_m, failsafe=failsafe))

    def test_an_unknown_one_is_refused(self) -> None:
        expected = (
            "A: go-home height unknown; write go_home_height_m, as set in the aircraft, "
            'into site.toml under [[vehicles]] serial = "A"'
        )
        assert refusal_text(level(40.0), state=flier(go_home_m=None)) == expected
        assert refusal_text(Nudge(1.0, 0.0, 0.0), state=flier(go_home_m=None)) == expected
        assert refusal_text(level(40.0), state=vehicle(None)) == expected

    def test_sticks_and_holding_need_none(self) -> None:
        for body in (stick(1.0, 0.0), HoldPosition()):
            assert is_allowed(body, state=flier(go_home_m=None))


class TestValleys:
    def test_the_lowest_ground_under_a_leg_counts(self) -> None:
        low_home = flier(0.0, 50.0, 60.0, go_home_m=60.0)
        assert is_allowed(level(70.0), over(PIT), low_home)
        assert refusal_text(level(71.0), over(PIT), low_home) == (
            "A: leg 1 to 2 must be at most 100 m above ground; got 101.0 m"
        )

    def test_a_valley_under_the_route_home_counts(self) -> None:
        beyond = mission((300.0, 20.0, 60.0), (300.0, 100.0, 60.0))
        state = flier(300.0, -60.0, 60.0, go_home_m=90.0)
        assert refusal_text(beyond, over(PIT), state).startswith(
            "A: the route home from the leg to waypoint 1"
        )
        assert is_allowed(beyond, over(PIT), flier(300.0, -60.0, 60.0, go_home_m=60.0))

    def test_a_valley_under_a_corner_counts(self) -> None:
        around = ((150.0, -20.0, 90.0), (360.0, -20.0, 90.0), (360.0, 160.0, 90.0))
        state = flier(0.0, -300.0, 60.0, failsafe=Failsafe.HOVER)
        assert is_allowed(mission(*around, curved=True), over(PIT), state)
        assert "the corner at waypoint 2" in refusal_text(
            mission(*around, curved=True, radius_m=100.0), over(PIT), state
        )

    def test_unknown_ground_is_refused(self) -> None:
        body = mission((100.0, 50.0, 20.0), (700.0, 50.0, 20.0))
        assert refusal_text(body, over(PIT)) == (
            "A: leg 1 to 2 goes over ground outside the site's elevation model"
        )


class TestAlreadyTooHigh:
    high = flier(200.0, 0.0, 140.0)

    def test_it_may_be_brought_down_and_moved(self) -> None:
        assert is_allowed(Nudge(0.0, 0.0, -20.0), state=self.high)
        assert is_allowed(stick(5.0, 5.0, 140.0), state=self.high)
        assert is_allowed(mission((150.0, 0.0, 90.0), (0.0, 0.0, 90.0)), state=self.high)

    def test_it_may_not_climb_and_a_mission_may_not_stay_there(self) -> None:
        assert "got 141.0 m" in refusal_text(Nudge(0.0, 0.0, 1.0), state=self.high)
        assert (
            "leg 1 to 2 must be at most 100 m above ground (flat ground assumed); got 130.0 m"
            in (refusal_text(mission((150.0, 0.0, 130.0), (0.0, 0.0, 130.0)), state=self.high))
        )

    def test_over_lower_ground_it_would_be_higher(self) -> None:
        pit = over(PIT)
        assert is_allowed(stick(5.0, 0.0, 140.0), pit, flier(100.0, -100.0, 140.0))
        assert is_allowed(stick(0.1, 0.0, 80.0), pit, flier(250.0, 50.0, 80.0))
        assert not is_allowed(Nudge(0.0, 0.0, 5.0), pit, flier(250.0, 50.0, 80.0, go_home_m=60.0))
        over_the_rim = flier(160.0, 50.0, 110.0)
        assert not is_allowed(stick(0.0, 15.0, 110.0), pit, over_the_rim)

    def test_over_unknown_ground_nothing_is_excused(self) -> None:
        holed = PIT.copy()
        holed[4, 7] = np.nan
        assert not is_allowed(stick(0.0, 0.1, 140.0), over(holed), flier(250.0, 50.0, 140.0))


class TestZeroAndUnknown:
    @pytest.mark.parametrize(("height_m", "allowed"), [(102.0, True), (102.1, False)])
    def test_a_zero_has_two_metres_of_slack(self, height_m: float, allowed: bool) -> None:
        nowhere = flier(200.0, 0.0, 101.5, position=Stamped())
        for state in (flier(200.0, 0.0, 101.5), nowhere):
            body = stick(0.0, 0.0, height_m)
            assert is_allowed(body, state=state) is allowed
        assert allowed or refusal_text(stick(0.0, 0.0, height_m), state=nowhere) == (
            "Height must be at most 100 m above takeoff; got 102.1 m"
        )

    def test_a_zero_where_it_is_stays_however_high_that_is(self) -> None:
        for state in (flier(200.0, 0.0, 130.0), flier(200.0, 0.0, 130.0, position=Stamped())):
            assert is_allowed(stick(0.0, 0.0, 130.0), state=state)
            assert not is_allowed(stick(0.0, 0.0, 130.5), state=state)

    def test_a_climb_without_velocity_has_no_slack(self) -> None:
        assert is_allowed(stick(0.0, 0.0, 100.0), state=flier(200.0, 0.0, 90.0))
        assert not is_allowed(stick(0.0, 0.0, 100.1), state=flier(200.0, 0.0, 90.0))

    def test_a_vehicle_that_is_nowhere_known(self) -> None:
        nowhere = flier(position=Stamped())
        assert "position unknown" in refusal_text(level(40.0), state=nowhere)
        assert "position unknown" in refusal_text(stick(0.1, 0.0), state=nowhere)

    @pytest.mark.parametrize(("height_m", "allowed"), [(102.0, True), (103.0, False)])
    def test_a_zero_of_one_whose_height_is_unknown_too(
        self, height_m: float, allowed: bool
    ) -> None:
        """It stops when it asks for the height of the stick before; the limit holds all the same"""
        lost = flier(position=Stamped(), height_above_takeoff_m=Stamped())
        now = replace(here(FLAT, lost), stick_height_above_takeoff_m=height_m)
        refusal = max_height(command(stick(0.0, 0.0, height_m)), now)
        assert (refusal is None) is allowed
        assert allowed or reason(refusal) == (
            "Height must be at most 100 m above takeoff; got 103.0 m"
        )
