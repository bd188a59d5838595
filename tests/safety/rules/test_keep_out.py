"""Keep-out zones: beside, above and below them, through them, and out of them."""

from dataclasses import replace

import pytest
from tests.safety.fenced import (
    ORIGIN,
    airspace,
    asked,
    flier,
    goto,
    height_zone,
    hills,
    keep_out_zone,
    mission,
    reason,
    square,
    stick,
)

from recon.model.airspace import HeightDatum, Zone
from recon.model.command import Body, Hover, Nudge
from recon.model.units import Stamped
from recon.model.vehicle import Failsafe, VehicleState
from recon.safety import PreparedAirspace
from recon.safety.rules.keep_out import keep_out

YARD = square(100.0, -50.0, 200.0, 50.0)
AT_ALL_HEIGHTS = airspace(keep_out_zone(YARD))
LOW = airspace(keep_out_zone(YARD, ceiling_m=40.0))
HIGH = airspace(keep_out_zone(YARD, floor_m=60.0))
BAND = airspace(keep_out_zone(YARD, floor_m=60.0, ceiling_m=80.0))


def is_allowed(
    body: Body, air: PreparedAirspace = AT_ALL_HEIGHTS, state: VehicleState | None = None
) -> bool:
    return asked(keep_out, body, air, state) is None


def refusal_text(
    body: Body, air: PreparedAirspace = AT_ALL_HEIGHTS, state: VehicleState | None = None
) -> str:
    return reason(asked(keep_out, body, air, state))


def across(height_m: float) -> Body:
    """Over the yard and beyond, at one height."""
    return mission((90.0, 0.0, height_m), (300.0, 0.0, height_m))


def over(height_m: float, **changes: float) -> VehicleState:
    """A vehicle over the yard whose route home is as high."""
    return flier(150.0, 0.0, height_m, go_home_m=changes.get("go_home_m", height_m))


class TestBeside:
    @pytest.mark.parametrize(("north_m", "allowed"), [(55.1, True), (54.9, False)])
    def test_the_margin_is_kept(self, north_m: float, allowed: bool) -> None:
        body = mission((90.0, north_m, 40.0), (210.0, north_m, 40.0))
        state = flier(0.0, 200.0, takeoff_point=flier(0.0, 200.0).position.value)
        assert is_allowed(body, state=state) is allowed
        assert allowed or refusal_text(body, state=state) == (
            "A: leg 1 to 2 comes within 4.90 m of the keep-out zone 'yard' at 40.0 m above "
            "takeoff; the margin is 5 m horizontally"
        )

    def test_a_leg_through_it_is_refused_though_its_ends_are_outside(self) -> None:
        assert refusal_text(across(40.0)).startswith(
            "A: leg 1 to 2 goes through the keep-out zone 'yard' at 40.0 m above takeoff"
        )

    def test_so_are_the_way_there_the_route_home_and_corners(self) -> None:
        there = mission((250.0, 0.0, 40.0), (250.0, 90.0, 40.0))
        assert "the leg to waypoint 1 goes through" in refusal_text(there)
        beyond = flier(250.0, 0.0)
        assert refusal_text(there, state=beyond).startswith(
            "A: the route home from the leg to waypoint 1"
        )
        assert is_allowed(there, state=flier(250.0, 0.0, failsafe=Failsafe.HOVER))
        cut = ((80.0, -60.0, 40.0), (80.0, 80.0, 40.0), (-100.0, -100.0, 40.0))
        assert is_allowed(mission(*cut, curved=True))
        around = ((90.0, -90.0, 40.0), (90.0, 60.0, 40.0), (240.0, 60.0, 40.0))
        state = flier(failsafe=Failsafe.HOVER)
        assert is_allowed(mission(*around, curved=True), state=state)
        assert "the corner at waypoint 2 goes through" in refusal_text(
            mission(*around, curved=True, radius_m=60.0), state=state
        )

    def test_no_zone_and_no_motion_are_not_asked(self) -> None:
        assert is_allowed(across(40.0), airspace())
        assert is_allowed(across(40.0), airspace(height_zone(YARD, floor_m=50.0)))
        assert is_allowed(Hover(), state=over(40.0))

    def test_every_zone_is_asked(self) -> None:
        far = keep_out_zone(square(900.0, 900.0, 910.0, 910.0))
        assert not is_allowed(across(40.0), airspace(far, keep_out_zone(YARD)))

    def test_a_vehicle_that_is_nowhere_known_is_refused(self) -> None:
        nowhere = flier(position=Stamped())
        assert "position unknown" in refusal_text(across(40.0), state=nowhere)
        assert is_allowed(across(40.0), airspace(), nowhere)
        assert is_allowed(stick(0.0, 0.0), state=nowhere)


class TestAboveAndBelow:
    """5 m are kept above a ceiling and below a floor."""

    @pytest.mark.parametrize(("height_m", "allowed"), [(45.0, True), (44.99, False)])
    def test_above_the_ceiling(self, height_m: float, allowed: bool) -> None:
        state = flier(0.0, 0.0, height_m, go_home_m=60.0)
        assert is_allowed(across(height_m), LOW, state) is allowed
        assert allowed or refusal_text(across(height_m), LOW, state) == (
            "A: leg 1 to 2 goes through the keep-out zone 'yard' (up to 40 m above ground) at "
            "45.0 m above takeoff; the margin is 5 m horizontally or 5 m vertically"
        )

    @pytest.mark.parametrize(("height_m", "allowed"), [(55.0, True), (55.01, False)])
    def test_below_the_floor(self, height_m: float, allowed: bool) -> None:
        state = flier(0.0, 0.0, 50.0, go_home_m=50.0)
        assert is_allowed(across(height_m), HIGH, state) is allowed

    def test_between_a_floor_and_a_ceiling(self) -> None:
        for height_m, allowed in ((50.0, True), (70.0, False), (90.0, True)):
            state = flier(0.0, 0.0, height_m, go_home_m=height_m)
            assert is_allowed(across(height_m), BAND, state) is allowed
        assert "(from 60 m above ground up to 80 m above ground)" in refusal_text(
            across(70.0), BAND, flier(0.0, 0.0, 70.0)
        )

    def test_all_of_a_leg_must_be_above(self) -> None:
        body = mission((90.0, 0.0, 30.0), (300.0, 0.0, 130.0))
        assert "at 30.0 m to 130.0 m above takeoff" in refusal_text(body, LOW)

    def test_the_climb_before_the_route_home_must_not_pass_through_a_band(self) -> None:
        state = flier(0.0, 0.0, 40.0, go_home_m=100.0)
        assert refusal_text(across(40.0), BAND, state).startswith(
            "A: the climb before the route home from leg 1 to 2 goes through"
        )
        assert is_allowed(across(40.0), BAND, flier(0.0, 0.0, 40.0, go_home_m=50.0))

    def test_the_route_home_is_at_the_go_home_height(self) -> None:
        low_home = flier(0.0, 0.0, 50.0, go_home_m=30.0)
        assert is_allowed(across(50.0), LOW, low_home)  # it stays as high as it is
        band_home = flier(250.0, 0.0, 40.0, go_home_m=70.0)
        beside = mission((250.0, 0.0, 40.0), (250.0, 90.0, 40.0))
        assert refusal_text(beside, BAND, band_home).startswith(
            "A: the route home from the leg to waypoint"
        )

    def test_an_unknown_go_home_height_may_be_any(self) -> None:
        state = flier(0.0, 0.0, 40.0, go_home_m=None)
        assert "at 40.0 m to an unknown go-home height above takeoff" in refusal_text(
            across(40.0), BAND, state
        )
        assert is_allowed(across(90.0), BAND, flier(0.0, 0.0, 90.0, go_home_m=None))

    def test_who_lands_by_itself_may_not_pass_above(self) -> None:
        state = flier(0.0, 0.0, 60.0, failsafe=Failsafe.LAND)
        assert refusal_text(across(60.0), LOW, state).startswith(
            "A: the landing at leg 1 to 2 goes"
        )
        assert is_allowed(across(50.0), HIGH, state)

    def test_a_landing_at_the_end_goes_to_the_ground(self) -> None:
        body = mission((50.0, 0.0, 60.0), (150.0, 0.0, 60.0), land=True)
        assert "the landing at the end goes through" in refusal_text(
            body, LOW, flier(0.0, 0.0, 60.0)
        )
        assert is_allowed(mission((50.0, 0.0, 60.0), (150.0, 0.0, 60.0)), LOW)

    def test_a_home_below_a_band_is_not_landed_at_from_above(self) -> None:
        air = airspace(
            keep_out_zone(square(-20.0, -20.0, 20.0, 20.0), floor_m=60.0, ceiling_m=80.0)
        )
        body = mission((50.0, 0.0, 90.0), (150.0, 0.0, 90.0))
        state = flier(50.0, 0.0, 90.0, go_home_m=90.0)
        assert refusal_text(body, air, state).startswith("A: the landing at home goes through")


class TestDatum:
    def zoned(self, **heights: float) -> Zone:
        return keep_out_zone(YARD, datum=HeightDatum.WGS84, **heights)

    def test_a_ceiling_above_the_ellipsoid(self) -> None:
        air = airspace(self.zoned(ceiling_m=ORIGIN.ellipsoid_height_m + 40.0))
        assert is_allowed(across(45.0), air, flier(0.0, 0.0, 45.0))
        assert "up to 310 m above the ellipsoid" in refusal_text(
            across(44.9), air, flier(0.0, 0.0, 45.0)
        )

    def test_a_floor_above_the_ellipsoid(self) -> None:
        air = airspace(self.zoned(floor_m=ORIGIN.ellipsoid_height_m + 60.0))
        state = flier(0.0, 0.0, 50.0, go_home_m=50.0)
        assert is_allowed(across(55.0), air, state)
        assert not is_allowed(across(55.1), air, state)

    def test_the_ellipsoids_heights_do_not_follow_the_ground(self) -> None:
        ground = hills([[30.0] * 10] * 10)
        wgs84 = airspace(self.zoned(ceiling_m=ORIGIN.ellipsoid_height_m + 40.0), elevation=ground)
        assert is_allowed(across(15.0), wgs84, flier(0.0, 0.0, 15.0))
        over_ground = airspace(keep_out_zone(YARD, ceiling_m=40.0), elevation=ground)
        assert not is_allowed(across(44.0), over_ground, flier(0.0, 0.0, 44.0))
        assert is_allowed(across(45.0), over_ground, flier(0.0, 0.0, 45.0))

    def test_a_ceiling_over_the_ground_counts_from_the_highest_below(self) -> None:
        """The ground rises from 0 at home to 20 m beyond the yard."""
        rising = hills([[0.0] * 5 + [0.0, 0.0, 20.0, 20.0, 20.0]] * 10)
        air = airspace(keep_out_zone(YARD, ceiling_m=40.0), elevation=rising)
        assert is_allowed(across(65.0), air, flier(0.0, 0.0, 65.0, go_home_m=65.0))
        assert not is_allowed(across(64.0), air, flier(0.0, 0.0, 64.0, go_home_m=64.0))

    def test_a_floor_over_the_ground_counts_from_the_lowest_below(self) -> None:
        falling = hills([[20.0] * 5 + [20.0, 20.0, 0.0, 0.0, 0.0]] * 10)
        air = airspace(keep_out_zone(YARD, floor_m=60.0), elevation=falling)
        # 35 m above home are 55 m above the low ground beyond the yard.
        assert is_allowed(across(35.0), air, flier(0.0, 0.0, 35.0, go_home_m=35.0))
        assert not is_allowed(across(36.0), air, flier(0.0, 0.0, 35.0, go_home_m=35.0))

    def test_over_ground_that_is_not_known_nothing_is_above_or_below(self) -> None:
        small = hills([[0.0] * 4] * 4, cell_m=40.0)
        for heights in ({"ceiling_m": 10.0}, {"floor_m": 300.0}):
            air = airspace(keep_out_zone(YARD, **heights), elevation=small)
            assert "goes through" in refusal_text(across(100.0), air, flier(0.0, 0.0, 100.0))


class TestSticks:
    @pytest.mark.parametrize(("speed_mps", "allowed"), [(9.9, True), (10.1, False)])
    def test_a_stick_reaches_as_far_as_it_brakes(self, speed_mps: float, allowed: bool) -> None:
        """10 m in its second, 20 m of braking, from 35 m before the yard."""
        assert is_allowed(stick(0.0, speed_mps), state=flier(65.0, 0.0)) is allowed

    def test_a_zero_over_the_yard_may_not_sink_into_it(self) -> None:
        assert is_allowed(stick(0.0, 0.0, 41.0), LOW, over(42.0))
        assert is_allowed(stick(0.0, 0.0, 45.1), LOW, over(60.0))
        assert not is_allowed(stick(0.0, 0.0, 44.9), LOW, over(60.0))
        assert "the stick's path goes through" in refusal_text(
            stick(0.0, 0.0, 37.9), LOW, over(60.0)
        )
        assert is_allowed(stick(0.0, 0.0, 59.0), HIGH, over(58.0))
        assert not is_allowed(stick(0.0, 0.0, 62.1), HIGH, over(50.0))

    def test_a_zero_inside_is_allowed(self) -> None:
        assert is_allowed(stick(0.0, 0.0, 40.0), state=over(40.0))
        assert is_allowed(stick(0.0, 0.0, 31.0), LOW, over(31.9))
        assert is_allowed(stick(0.0, 0.0, 38.1), LOW, over(39.0))
        assert is_allowed(stick(0.0, 0.0, 61.9), HIGH, over(61.0))

    def test_a_zero_beside_it_is_held_to_the_zone_alone(self) -> None:
        assert is_allowed(stick(0.0, 0.0, 20.0), LOW, flier(99.5, 0.0, 20.0))
        assert is_allowed(stick(0.0, 0.0, 20.0), LOW, flier(97.0, 0.0, 20.0))

    @pytest.mark.parametrize(("east_m", "allowed"), [(97.0, True), (99.5, True), (100.5, False)])
    def test_a_zero_beside_it_may_sink_to_its_heights(self, east_m: float, allowed: bool) -> None:
        body, state = stick(0.0, 0.0, 37.6), flier(east_m, 0.0, 38.5)
        assert is_allowed(body, LOW, state) is allowed


class TestAlreadyInside:
    """30 m inside the west edge of the yard."""

    inside = flier(130.0, 0.0, 40.0)

    def test_out_the_shortest_way_is_allowed(self) -> None:
        assert is_allowed(stick(0.0, -15.0), state=self.inside)
        assert is_allowed(Nudge(0.0, -60.0, 0.0), state=self.inside)

    def test_deeper_in_is_not(self) -> None:
        assert "goes through" in refusal_text(stick(0.0, 1.0), state=self.inside)
        assert not is_allowed(goto(300.0, 0.0), state=self.inside)

    def test_along_the_edge_it_may_be_moved(self) -> None:
        assert is_allowed(stick(-2.0, 0.0), state=self.inside)

    def test_in_the_margin_it_may_be_moved_away(self) -> None:
        near = flier(97.0, 0.0, 40.0)
        assert is_allowed(stick(0.0, -1.0), state=near)
        assert not is_allowed(stick(0.0, 1.0), state=near)
        assert is_allowed(stick(0.0, 1.0, 46.0), LOW, flier(97.0, 0.0, 46.0))

    def test_the_rest_of_a_mission_must_keep_out(self) -> None:
        body = mission((50.0, 0.0, 40.0), (98.0, 0.0, 40.0))
        assert "leg 1 to 2 comes within 2.00 m" in refusal_text(body, state=self.inside)
        assert is_allowed(mission((50.0, 0.0, 40.0), (90.0, 0.0, 40.0)), state=self.inside)

    def test_its_route_home_may_go_no_deeper_either(self) -> None:
        far = flier(170.0, 0.0, 40.0)
        assert "the route home from the nudge" in refusal_text(Nudge(0.0, 60.0, 0.0), state=far)

    def test_just_above_the_ceiling_it_may_not_sink(self) -> None:
        """3 m above the ceiling, 40 m: too close, and moved up or sideways it is no worse."""
        above = over(43.0)
        assert is_allowed(Nudge(0.0, 0.0, 10.0), LOW, above)
        assert is_allowed(
            stick(0.0, 0.5, 43.0), LOW, replace(above, position=flier(180.0).position)
        )
        assert not is_allowed(stick(0.0, 0.0, 30.0), LOW, above)
        assert not is_allowed(Nudge(0.0, 0.0, -2.0), LOW, above)
        assert is_allowed(Nudge(0.0, 0.0, -2.0), LOW, over(35.0))

    def test_just_below_the_floor_it_may_not_climb(self) -> None:
        below = over(57.0)
        assert is_allowed(Nudge(0.0, 0.0, -10.0), HIGH, below)
        assert not is_allowed(Nudge(0.0, 0.0, 2.0), HIGH, below)
        assert is_allowed(Nudge(0.0, 0.0, 2.0), HIGH, over(65.0))

    def test_well_above_it_is_not_inside(self) -> None:
        """Nothing is excused that begins above the zone and sinks into it."""
        assert not is_allowed(Nudge(0.0, 0.0, -20.0), LOW, over(60.0))

    def test_above_a_ceiling_over_the_ellipsoid_it_may_not_sink_either(self) -> None:
        height_m = ORIGIN.ellipsoid_height_m + 40.0
        air = airspace(keep_out_zone(YARD, ceiling_m=height_m, datum=HeightDatum.WGS84))
        assert is_allowed(Nudge(0.0, 0.0, 10.0), air, over(43.0))
        assert not is_allowed(Nudge(0.0, 0.0, -2.0), air, over(43.0))
        assert is_allowed(Nudge(0.0, 0.0, -2.0), air, over(35.0))

    def test_below_a_floor_over_the_ellipsoid_it_may_not_climb_either(self) -> None:
        height_m = ORIGIN.ellipsoid_height_m + 60.0
        air = airspace(keep_out_zone(YARD, floor_m=height_m, datum=HeightDatum.WGS84))
        assert is_allowed(Nudge(0.0, 0.0, -10.0), air, over(57.0))
        assert not is_allowed(Nudge(0.0, 0.0, 2.0), air, over(57.0))
        assert is_allowed(Nudge(0.0, 0.0, 2.0), air, over(65.0))

    def test_at_the_very_height_of_an_end_it_may_not_cross_it(self) -> None:
        assert not is_allowed(Nudge(0.0, 0.0, -2.0), LOW, over(40.0))
        assert not is_allowed(Nudge(0.0, 0.0, 2.0), HIGH, over(60.0))

    def test_close_above_or_below_it_may_go_no_farther_in(self) -> None:
        assert not is_allowed(Nudge(0.0, 10.0, 0.0), LOW, flier(110.0, 0.0, 43.0))
        assert is_allowed(Nudge(0.0, -10.0, 0.0), LOW, flier(110.0, 0.0, 43.0, go_home_m=43.0))
        assert not is_allowed(Nudge(0.0, 10.0, 0.0), HIGH, flier(110.0, 0.0, 57.0))
        assert is_allowed(stick(0.0, -1.0, 57.0), HIGH, flier(110.0, 0.0, 57.0))
        assert not is_allowed(stick(0.0, 1.0, 57.0), HIGH, flier(110.0, 0.0, 57.0))

    def test_a_centimetre_is_rounding(self) -> None:
        assert is_allowed(Nudge(0.0, 0.0, -0.01), LOW, over(43.0))
        assert not is_allowed(Nudge(0.0, 0.0, -0.02), LOW, over(43.0))
        assert is_allowed(stick(0.0, 0.0, 57.0), HIGH, over(57.0))
        assert is_allowed(Nudge(0.0, 0.0, 0.01), HIGH, over(57.0))
        assert not is_allowed(Nudge(0.0, 0.0, 0.02), HIGH, over(57.0))

    def test_over_hills_the_ground_under_the_vehicle_tells_where_it_is(self) -> None:
        """The yard lies on a plateau of 20 m: 62 m up is 42 m above it, too close above 40 m."""
        plateau = hills([[0.0] * 6 + [20.0] * 4] * 10)
        air = airspace(keep_out_zone(YARD, ceiling_m=40.0), elevation=plateau)
        assert is_allowed(Nudge(0.0, 0.0, 1.0), air, over(62.0))
        assert not is_allowed(Nudge(0.0, 0.0, -1.0), air, over(62.0))
        assert is_allowed(Nudge(0.0, 0.0, -1.0), air, over(58.0))
