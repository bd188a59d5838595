"""The least height above ground, along everything that is flown, but columns."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.cases import command
from tests.safety.fenced import (
    WIDE,
    airspace,
    asked,
    flier,
    goto,
    here,
    hills,
    mission,
    place,
    reason,
    stick,
)

from recon.model.airspace import LandingPad
from recon.model.command import Body, HoldPosition, Hover, LandNow, Nudge
from recon.model.geo import GeoPoint
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety import PreparedAirspace
from recon.safety.rules.min_height import min_height
from recon.safety.settings import FenceSettings, SafetySettings

FLAT = airspace(limits=replace(WIDE, min_height_above_ground_m=10.0))


def over(heights: object) -> PreparedAirspace:
    limits = replace(WIDE, min_height_above_ground_m=10.0)
    return airspace(limits=limits, elevation=hills(heights))


HILL = np.zeros((10, 10))
HILL[4, 7] = 35.0
"""A hill of 35 m, 250 m east and 50 m north of home."""


def is_allowed(body: Body, air: PreparedAirspace = FLAT, state: VehicleState | None = None) -> bool:
    return asked(min_height, body, air, state) is None


def refusal_text(
    body: Body, air: PreparedAirspace = FLAT, state: VehicleState | None = None
) -> str:
    return reason(asked(min_height, body, air, state))


def level(height_m: float) -> Body:
    return mission((0.0, 50.0, height_m), (300.0, 50.0, height_m))


class TestFlatGround:
    @pytest.mark.parametrize(("height_m", "allowed"), [(10.0, True), (9.99, False)])
    def test_the_limit(self, height_m: float, allowed: bool) -> None:
        assert is_allowed(level(height_m)) is allowed
        assert allowed or refusal_text(level(height_m)) == (
            "A: the leg to waypoint 1 must be at least 10 m above ground (flat ground assumed) "
            "outside takeoff and landing; got 10.0 m"
        )

    @pytest.mark.parametrize("body", [Hover(), LandNow()])
    def test_stops_are_not_asked(self, body: Body) -> None:
        assert is_allowed(body, state=flier(height_m=1.0))

    def test_the_default_is_five_metres(self) -> None:
        assert is_allowed(level(5.0), airspace())
        assert "at least 5 m above ground" in refusal_text(level(4.9), airspace())

    def test_corners_and_ways_home_count(self) -> None:
        low_home = flier(0.0, 50.0, 20.0, go_home_m=2.0)
        assert is_allowed(level(20.0), state=low_home)  # as high as it is
        dip = mission((0.0, 50.0, 40.0), (100.0, 50.0, 4.0), (200.0, 90.0, 40.0), curved=True)
        assert "leg 1 to 2 must be" in refusal_text(dip)
        assert "got 4.0 m" in refusal_text(dip)


class TestHills:
    def test_a_hill_under_the_middle_of_a_leg_counts(self) -> None:
        assert is_allowed(level(45.0), over(HILL), flier(0.0, 50.0, 45.0))
        assert refusal_text(level(44.0), over(HILL), flier(0.0, 50.0, 45.0)) == (
            "A: leg 1 to 2 must be at least 10 m above ground outside takeoff and landing; got "
            "9.0 m"
        )

    def test_a_hill_under_a_corner_counts(self) -> None:
        """The legs pass it on both sides; the corner between them is cut over its slope."""
        around = ((150.0, -20.0, 22.0), (360.0, -20.0, 22.0), (360.0, 160.0, 22.0))
        state = flier(0.0, -300.0, 30.0, failsafe=Failsafe.HOVER)
        assert is_allowed(mission(*around, curved=True), over(HILL), state)
        assert "the corner at waypoint 2" in refusal_text(
            mission(*around, curved=True, radius_m=100.0), over(HILL), state
        )

    def test_a_hill_beside_the_leg_does_not(self) -> None:
        body = mission((0.0, -60.0, 20.0), (300.0, -60.0, 20.0))
        assert is_allowed(body, over(HILL), flier(0.0, 0.0, 20.0, failsafe=Failsafe.HOVER))

    def test_a_hill_under_the_route_home_counts(self) -> None:
        far = mission((300.0, 100.0, 60.0), (300.0, 20.0, 60.0))
        low_home = flier(300.0, 100.0, 60.0, go_home_m=30.0)
        assert is_allowed(far, over(HILL), low_home)
        low = mission((300.0, -60.0, 30.0), (300.0, -20.0, 30.0))
        state = flier(300.0, -80.0, 30.0, go_home_m=30.0)
        assert is_allowed(low, over(HILL), state)
        wide = mission((300.0, -60.0, 30.0), (300.0, 120.0, 30.0))
        assert "the route home from leg 1 to 2 must be" in refusal_text(wide, over(HILL), state)
        assert "got -5.0 m" in refusal_text(wide, over(HILL), state)
        assert is_allowed(wide, over(HILL), replace(state, profile=flier(go_home_m=50.0).profile))

    def test_home_on_a_hill_raises_every_height(self) -> None:
        """Heights count from 35 m up there: 24 m below it is 11 m above the ground beside it."""
        hovers = Failsafe.HOVER
        top = place(250.0, 50.0)
        state = flier(100.0, -80.0, -20.0, takeoff_point=top, failsafe=hovers)
        beside = ((90.0, -80.0), (60.0, -80.0))
        for height_m, allowed in ((-24.0, True), (-26.0, False)):
            body = mission(*((*point, height_m) for point in beside))
            assert is_allowed(body, over(HILL), state) is allowed

    def test_unknown_ground_is_refused(self) -> None:
        body = mission((100.0, 50.0, 200.0), (700.0, 50.0, 200.0))
        assert refusal_text(body, over(HILL)) == (
            "A: leg 1 to 2 goes over ground outside the site's elevation model"
        )
        holed = HILL.copy()
        holed[4, 7] = np.nan
        assert "outside the site's elevation model" in refusal_text(level(200.0), over(holed))


class TestColumns:
    def test_takeoff_from_home(self) -> None:
        grounded = flier(0.0, 0.0, 0.0, is_flying=False)
        assert is_allowed(mission((0.0, 3.0, 40.0), (50.0, 0.0, 40.0)), state=grounded)
        assert refusal_text(mission((0.0, 30.0, 40.0), (50.0, 0.0, 40.0)), state=grounded).endswith(
            "; climb straight up first (a mission's first waypoint may be above the vehicle)"
        )

    @pytest.mark.parametrize(("east_m", "allowed"), [(1.9, True), (2.1, False)])
    def test_round_home_it_may_be_low(self, east_m: float, allowed: bool) -> None:
        """A goto counts 3 m more: 5 m are open."""
        state = flier(0.0, 0.0, 20.0)
        assert is_allowed(goto(east_m, 0.0, 1.0), state=state) is allowed

    def test_round_every_pad_it_may_be_low(self) -> None:
        at = place(200.0, 0.0)
        pad = GeoPoint(at.latitude_deg, at.longitude_deg, 270.0)
        body, there = stick(0.0, 0.5, 1.0), flier(200.0, 1.0, 20.0)
        assert not is_allowed(body, state=there)
        pads = airspace(limits=FLAT.airspace.limits, pads=[LandingPad("north", "B", pad)])
        assert is_allowed(body, pads, there)
        assert there.profile is not None
        own = replace(there, profile=replace(there.profile, pad=pad))
        assert is_allowed(body, state=own)

    def test_the_landing_at_the_end_is_open_anywhere(self) -> None:
        assert is_allowed(mission((0.0, 50.0, 40.0), (300.0, 50.0, 40.0), land=True))

    def test_one_too_low_may_climb_where_it_is(self) -> None:
        low = flier(200.0, 0.0, 3.0)
        assert is_allowed(Nudge(0.0, 0.0, 20.0), state=low)
        assert is_allowed(stick(0.5, 0.0, 5.0), state=low)
        assert not is_allowed(Nudge(0.0, 30.0, 20.0), state=low)
        assert refusal_text(Nudge(0.0, 30.0, 0.0), state=low).endswith("may be above the vehicle)")
        assert refusal_text(Nudge(0.0, 0.0, -1.0), state=low).endswith(
            "outside takeoff and landing; got 2.0 m"
        )
        assert refusal_text(level(40.0), state=low).endswith(
            "(a mission's first waypoint may be above the vehicle)"
        )
        assert not is_allowed(stick(0.5, 0.0, 2.5), state=low)
        assert is_allowed(HoldPosition(), state=low)

    def test_a_barometers_noise_at_the_limit_is_no_reason(self) -> None:
        assert is_allowed(stick(5.0, 0.0, 10.0), state=flier(200.0, 0.0, 9.2))
        assert not is_allowed(stick(5.0, 0.0, 10.0), state=flier(200.0, 0.0, 8.8))


class TestZeroAndUnknown:
    @pytest.mark.parametrize(("height_m", "allowed"), [(10.0, True), (9.9, False)])
    def test_a_descent_without_velocity_has_no_slack(self, height_m: float, allowed: bool) -> None:
        state = flier(200.0, 0.0, 20.0)
        assert is_allowed(stick(0.0, 0.0, height_m), state=state) is allowed

    def test_a_zero_has_slack(self) -> None:
        assert is_allowed(stick(0.0, 0.0, 9.5), state=flier(200.0, 0.0, 10.4))

    @pytest.mark.parametrize(("height_m", "allowed"), [(8.1, True), (7.9, False)])
    def test_a_zero_far_below_its_place_has_its_slack_below_the_limit(
        self, height_m: float, allowed: bool
    ) -> None:
        """Where barometers are trusted less: what is asked for is no column of its own."""
        settings = SafetySettings(fences=FenceSettings(same_height_m=5.0))
        now = replace(here(FLAT, flier(200.0, 0.0, 11.0)), settings=settings)
        refusal = min_height(command(stick(0.0, 0.0, height_m)), now)
        assert (refusal is None) is allowed

    def test_a_zero_that_holds_a_low_place_stays(self) -> None:
        assert is_allowed(stick(0.0, 0.0, 2.6), state=flier(200.0, 0.0, 3.5))

    def test_a_vehicle_that_is_nowhere_known(self) -> None:
        nowhere = flier(position=Stamped())
        assert "position unknown" in refusal_text(level(40.0), state=nowhere)
        assert "position unknown" in refusal_text(stick(0.1, 0.0), state=nowhere)
        assert is_allowed(stick(0.0, 0.0), state=nowhere)
