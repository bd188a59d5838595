"""Floors and ceilings inside height zones, and who may be below and above them."""

from dataclasses import replace

import pytest
from tests.safety.cases import command
from tests.safety.fenced import (
    ORIGIN,
    airspace,
    asked,
    flier,
    goto,
    height_zone,
    here,
    hills,
    keep_out_zone,
    mission,
    place,
    reason,
    square,
    stick,
)

from recon.model.airspace import HeightDatum, LandingPad
from recon.model.command import Body, Hover, Nudge
from recon.model.geo import GeoPoint
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.safety import PreparedAirspace
from recon.safety.rules.height_zones import height_zones
from recon.safety.settings import FenceSettings, SafetySettings

FARM = square(100.0, -50.0, 200.0, 50.0)
FLOOR = airspace(height_zone(FARM, floor_m=50.0))
CEILING = airspace(height_zone(FARM, ceiling_m=50.0))
ROUND_HOME = square(-60.0, -60.0, 60.0, 60.0)


def is_allowed(body: Body, air: PreparedAirspace, state: VehicleState | None = None) -> bool:
    return asked(height_zones, body, air, state) is None


def refusal_text(body: Body, air: PreparedAirspace, state: VehicleState | None = None) -> str:
    return reason(asked(height_zones, body, air, state))


def across(height_m: float) -> Body:
    return mission((90.0, 0.0, height_m), (300.0, 0.0, height_m))


class TestFloor:
    @pytest.mark.parametrize(("height_m", "allowed"), [(50.0, True), (49.99, False)])
    def test_no_lower(self, height_m: float, allowed: bool) -> None:
        state = flier(0.0, 0.0, height_m)
        assert is_allowed(across(height_m), FLOOR, state) is allowed
        assert allowed or refusal_text(across(height_m), FLOOR, state) == (
            "A: leg 1 to 2 is at 50.0 m above takeoff in the height zone 'yard'; fly no lower than "
            "50 m above ground there"
        )

    @pytest.mark.parametrize(("east_m", "allowed"), [(94.9, True), (95.1, False)])
    def test_the_margin_belongs_to_the_zone(self, east_m: float, allowed: bool) -> None:
        assert is_allowed(mission((0.0, 9.0, 40.0), (east_m, 0.0, 40.0)), FLOOR) is allowed

    def test_the_route_home_counts(self) -> None:
        body = mission((250.0, 0.0, 60.0), (250.0, 90.0, 60.0))
        state = flier(250.0, 0.0, 60.0, go_home_m=40.0)
        assert is_allowed(body, FLOOR, state)  # it goes home as high as it is
        low = mission((250.0, 0.0, 45.0), (250.0, 90.0, 45.0))
        state = flier(250.0, 0.0, 45.0, go_home_m=40.0)
        assert "the route home from the leg to waypoint 1 is at 45.0 m" in refusal_text(
            low, FLOOR, state
        )

    def test_a_landing_in_the_zone_is_below_its_floor(self) -> None:
        body = mission((90.0, 0.0, 60.0), (150.0, 0.0, 60.0), land=True)
        assert "the landing at the end is at the ground to 60.0 m" in refusal_text(
            body, FLOOR, flier(0.0, 0.0, 60.0)
        )

    def test_takeoff_and_landing_at_home_and_pads_are_open(self) -> None:
        air = airspace(height_zone(ROUND_HOME, floor_m=30.0))
        body = mission((0.0, 0.0, 40.0), (50.0, 0.0, 40.0))
        assert is_allowed(body, air, flier(0.0, 0.0, 0.0, is_flying=False))
        assert is_allowed(goto(1.0, 1.0, 2.0), air, flier(0.0, 0.0, 40.0))
        pad = place(40.0, 0.0)
        pads = [LandingPad("p", None, GeoPoint(pad.latitude_deg, pad.longitude_deg, 270.0))]
        landing = mission((0.0, 0.0, 40.0), (40.0, 0.0, 40.0), land=True)
        assert "the landing at the end" in refusal_text(landing, air)
        padded = airspace(height_zone(ROUND_HOME, floor_m=30.0), pads=pads)
        assert is_allowed(landing, padded)

    def test_who_is_below_may_climb(self) -> None:
        low = flier(150.0, 0.0, 20.0)
        assert is_allowed(Nudge(0.0, 0.0, 5.0), FLOOR, low)
        assert not is_allowed(Nudge(0.0, 0.0, -5.0), FLOOR, low)
        assert not is_allowed(Nudge(0.0, 30.0, 0.0), FLOOR, low)


class TestCeiling:
    @pytest.mark.parametrize(("height_m", "allowed"), [(50.0, True), (50.01, False)])
    def test_no_higher(self, height_m: float, allowed: bool) -> None:
        state = flier(0.0, 0.0, 40.0, go_home_m=40.0)
        assert is_allowed(across(height_m), CEILING, state) is allowed
        assert allowed or refusal_text(across(height_m), CEILING, state).endswith(
            "in the height zone 'yard'; fly no higher than 50 m above ground there"
        )

    def test_the_go_home_height_counts(self) -> None:
        state = flier(0.0, 0.0, 40.0, go_home_m=60.0)
        assert (
            "the climb before the route home from leg 1 to 2 is at 40.0 m to 60.0 m"
            in refusal_text(across(40.0), CEILING, state)
        )
        unknown = flier(0.0, 0.0, 40.0, go_home_m=None)
        assert "unknown go-home height" in refusal_text(across(40.0), CEILING, unknown)

    def test_who_is_above_may_be_brought_down(self) -> None:
        high = flier(150.0, 0.0, 70.0, go_home_m=40.0)
        assert is_allowed(Nudge(0.0, 0.0, -10.0), CEILING, high)
        assert is_allowed(stick(1.0, 1.0, 69.0), CEILING, high)
        assert not is_allowed(Nudge(0.0, 0.0, 10.0), CEILING, high)
        assert "leg 1 to 2" in refusal_text(mission((150, 0, 60), (120, 0, 60)), CEILING, high)

        level = Nudge(5.0, 0.0, 0.0)
        assert is_allowed(level, CEILING, high)
        assert is_allowed(mission((150.0, 0.0, 40.0), (120.0, 0.0, 40.0)), CEILING, high)

    def test_in_the_zones_margin_it_is_as_in_the_zone(self) -> None:
        high = flier(97.0, 0.0, 70.0, go_home_m=40.0)
        assert is_allowed(Nudge(0.0, 0.0, -10.0), CEILING, high)
        assert not is_allowed(Nudge(0.0, 0.0, 10.0), CEILING, high)

    def test_above_a_ceiling_over_the_ellipsoid_too(self) -> None:
        height_m = ORIGIN.ellipsoid_height_m + 50.0
        zone = height_zone(FARM, ceiling_m=height_m, datum=HeightDatum.WGS84)
        air = airspace(zone, elevation=hills([[30.0] * 10] * 10))
        high = flier(150.0, 0.0, 40.0, go_home_m=10.0)
        assert is_allowed(Nudge(0.0, 0.0, -10.0), air, high)
        assert not is_allowed(Nudge(0.0, 0.0, 1.0), air, high)

    def test_over_falling_ground_level_flight_is_higher(self) -> None:
        falling = hills([[20.0] * 5 + [20.0, 20.0, 0.0, 0.0, 0.0]] * 10)
        air = airspace(
            height_zone(square(100.0, -50.0, 300.0, 50.0), ceiling_m=50.0), elevation=falling
        )
        high = flier(120.0, 0.0, 60.0, go_home_m=40.0)
        assert is_allowed(stick(1.0, 0.0, 60.0), air, high)
        assert not is_allowed(stick(0.0, 15.0, 60.0), air, high)

    def test_who_is_above_beside_the_zone_may_not_enter_it(self) -> None:
        high = flier(90.0, 0.0, 70.0, go_home_m=40.0)
        assert not is_allowed(Nudge(0.0, 40.0, -5.0), CEILING, high)


class TestDatum:
    def test_above_the_ellipsoid(self) -> None:
        height_m = ORIGIN.ellipsoid_height_m + 50.0
        datum = HeightDatum.WGS84
        ground = hills([[30.0] * 10] * 10)
        floor = airspace(height_zone(FARM, floor_m=height_m, datum=datum), elevation=ground)
        assert is_allowed(across(20.0), floor, flier(0.0, 0.0, 20.0))
        assert "320 m above the ellipsoid" in refusal_text(
            across(19.0), floor, flier(0.0, 0.0, 19.0)
        )
        ceiling = airspace(height_zone(FARM, ceiling_m=height_m, datum=datum), elevation=ground)
        low = flier(0.0, 0.0, 20.0, go_home_m=20.0)
        assert is_allowed(across(20.0), ceiling, low)
        assert not is_allowed(across(21.0), ceiling, low)

    def test_over_the_ground_the_worst_under_the_piece_counts(self) -> None:
        rising = hills([[0.0] * 5 + [0.0, 0.0, 20.0, 20.0, 20.0]] * 10)
        floor = airspace(height_zone(FARM, floor_m=50.0), elevation=rising)
        assert is_allowed(across(70.0), floor, flier(0.0, 0.0, 70.0))
        assert not is_allowed(across(69.0), floor, flier(0.0, 0.0, 70.0))
        falling = hills([[20.0] * 5 + [20.0, 20.0, 0.0, 0.0, 0.0]] * 10)
        ceiling = airspace(height_zone(FARM, ceiling_m=50.0), elevation=falling)
        low = flier(0.0, 0.0, 30.0, go_home_m=30.0)
        assert is_allowed(across(30.0), ceiling, low)
        assert not is_allowed(across(31.0), ceiling, low)

    def test_over_ground_that_is_not_known_it_is_refused(self) -> None:
        small = hills([[0.0] * 4] * 4, cell_m=30.0)
        for heights in ({"floor_m": 1.0}, {"ceiling_m": 400.0}):
            assert not is_allowed(
                across(60.0), airspace(height_zone(FARM, **heights), elevation=small)
            )


class TestAsked:
    def test_zones_of_this_kind_and_moves_only(self) -> None:
        assert is_allowed(across(20.0), airspace())
        assert is_allowed(across(20.0), airspace(), flier(position=Stamped()))
        assert is_allowed(across(20.0), airspace(keep_out_zone(FARM)))
        assert is_allowed(Hover(), FLOOR, flier(150.0, 0.0, 20.0))

    def test_every_zone_and_both_ends(self) -> None:
        far = height_zone(square(900.0, 900.0, 910.0, 910.0), floor_m=400.0)
        both = airspace(far, height_zone(FARM, floor_m=45.0, ceiling_m=55.0))
        for height_m, allowed in ((44.0, False), (50.0, True), (56.0, False)):
            state = flier(0.0, 0.0, 50.0, go_home_m=50.0)
            assert is_allowed(across(height_m), both, state) is allowed

    def test_a_vehicle_that_is_nowhere_known(self) -> None:
        nowhere = flier(position=Stamped())
        assert "position unknown" in refusal_text(across(60.0), FLOOR, nowhere)
        assert is_allowed(stick(0.0, 0.0), FLOOR, nowhere)

    def test_a_zero_has_slack_below(self) -> None:
        assert is_allowed(stick(0.0, 0.0, 49.5), FLOOR, flier(150.0, 0.0, 50.4))

    @pytest.mark.parametrize(("height_m", "allowed"), [(50.0, True), (49.9, False)])
    def test_a_descent_without_velocity_has_none(self, height_m: float, allowed: bool) -> None:
        state = flier(150.0, 0.0, 60.0)
        assert is_allowed(stick(0.0, 0.0, height_m), FLOOR, state) is allowed

    @pytest.mark.parametrize(("height_m", "allowed"), [(51.9, True), (52.1, False)])
    def test_a_zero_has_it_above_too(self, height_m: float, allowed: bool) -> None:
        state = flier(150.0, 0.0, 51.5)
        assert is_allowed(stick(0.0, 0.0, height_m), CEILING, state) is allowed

    def test_a_zero_beside_the_zone_is_not_in_it(self) -> None:
        assert is_allowed(stick(0.0, 0.0, 20.0), FLOOR, flier(99.5, 0.0, 20.0))
        assert is_allowed(stick(0.0, 0.0, 20.0), FLOOR, flier(97.0, 0.0, 20.0))
        assert not is_allowed(stick(0.1, 0.0, 20.0), FLOOR, flier(97.0, 0.0, 60.0))

    @pytest.mark.parametrize(("east_m", "allowed"), [(97.0, True), (99.5, True), (100.5, False)])
    def test_nor_held_to_its_ceiling_there(self, east_m: float, allowed: bool) -> None:
        body, state = stick(0.0, 0.0, 52.4), flier(east_m, 0.0, 51.5)
        assert is_allowed(body, CEILING, state) is allowed

    @pytest.mark.parametrize(("height_m", "allowed"), [(48.1, True), (47.9, False)])
    def test_a_zero_far_below_its_place_has_its_slack_below_the_floor(
        self, height_m: float, allowed: bool
    ) -> None:
        """Where barometers are trusted less: what is asked for is no column of its own."""
        settings = SafetySettings(fences=FenceSettings(same_height_m=5.0))
        now = replace(here(FLOOR, flier(150.0, 0.0, 51.0)), settings=settings)
        refusal = height_zones(command(stick(0.0, 0.0, height_m)), now)
        assert (refusal is None) is allowed

    def test_a_zero_that_holds_a_low_place_stays(self) -> None:
        assert is_allowed(stick(0.0, 0.0, 19.6), FLOOR, flier(150.0, 0.0, 20.5))
