"""Telemetry folded into a state: unknown stays unknown, ages are true."""

from dataclasses import replace

import pytest
from tests.fleet.reports import PLACE, S, Story, core, extended

from recon.fleet.state import Fleet, staleness
from recon.fleet.telemetry import STAMPED_FIELDS
from recon.model.geo import LatLon
from recon.model.vehicle import Staleness, VehicleProfile, VehicleState


def known() -> Story:
    return Story().opens(1).receives(1, core(), extended())


class TestUnknown:
    @pytest.mark.parametrize(
        ("report", "name"),
        [
            (core(flying=None), "is_flying"),
            (core(position=None), "position"),
            (core(altitude_m=None), "reported_altitude_m"),
            (core(altitude_m=None), "altitude_offset_m"),
            (core(height_m=None), "height_above_takeoff_m"),
            (core(height_m=None), "altitude_offset_m"),
            (core(velocity=None), "velocity_ned"),
            (replace(core(), attitude=None), "attitude"),
            (extended(mode=None), "flight_mode"),
            (extended(battery=None), "battery_fraction"),
            (extended(warning=None), "battery_warning"),
            (extended(gnss_level=None), "gnss_signal_level"),
        ],
    )
    def test_a_field_become_unknown_is_never_the_old_value_passed_on_as_new(
        self, report: object, name: str
    ) -> None:
        before = getattr(known().vehicle(), name)
        assert before.is_known()
        after = getattr(known().at(1.0).receives(1, report).vehicle(), name)  # type: ignore[arg-type]
        assert after.value is None
        assert after.received_at_ns == S

    def test_altitudes_whose_difference_no_float_holds_give_no_offset(self) -> None:
        story = known().receives(1, core(altitude_m=1.7e308, height_m=-1.7e308))
        assert story.vehicle().altitude_offset_m.value is None

    def test_every_value_with_an_age_is_listed(self) -> None:
        assert len(STAMPED_FIELDS) == 19
        assert all(getattr(VehicleState(serial="A"), name).value is None for name in STAMPED_FIELDS)


class TestStaleness:
    @pytest.mark.parametrize(
        ("age_ns", "tier"),
        [
            (0, Staleness.LIVE),
            (1 * S - 1, Staleness.LIVE),
            (1 * S, Staleness.LATE),
            (3 * S - 1, Staleness.LATE),
            (3 * S, Staleness.LOST),
            (10 * S - 1, Staleness.LOST),
            (10 * S, Staleness.SILENT),
        ],
    )
    def test_tiers_at_their_exact_limits(self, age_ns: int, tier: Staleness) -> None:
        assert staleness(known().vehicle(), age_ns) is tier

    def test_never_received_is_silent(self) -> None:
        assert staleness(VehicleState(serial="A"), 0) is Staleness.SILENT

    def test_other_packets_make_no_position_younger(self) -> None:
        story = known().at(5.0).receives(1, extended())
        assert staleness(story.vehicle(), 5 * S) is Staleness.LOST
        assert story.vehicle().position.age_s(5 * S) == 5.0


class TestTakeoff:
    def test_the_offset_at_takeoff_is_the_first_one_in_flight(self) -> None:
        story = Story().opens(1).receives(1, extended(), core(flying=False, altitude_m=290.0))
        assert story.vehicle().altitude_offset_at_takeoff_m is None
        story.receives(
            1, core(altitude_m=301.0, height_m=1.0), core(altitude_m=340.0, height_m=1.0)
        )
        assert story.vehicle().altitude_offset_at_takeoff_m == 300.0
        assert story.vehicle().takeoff_point == PLACE

    def test_an_unknown_altitude_at_takeoff_waits_for_the_first_known_one(self) -> None:
        story = Story().opens(1).receives(1, extended(), core(flying=False), core(altitude_m=None))
        assert story.vehicle().altitude_offset_at_takeoff_m is None
        story.receives(1, core(altitude_m=300.0, height_m=40.0))
        assert story.vehicle().altitude_offset_at_takeoff_m == 260.0

    def test_landing_ends_it(self) -> None:
        story = known().receives(1, core(flying=False))
        assert story.vehicle().altitude_offset_at_takeoff_m is None

    def test_a_takeoff_seen_across_a_reconnect_is_a_new_one(self) -> None:
        story = known().closes(1).at(60.0).opens(2)
        story.receives(2, core(flying=False, altitude_m=320.0, height_m=0.0), extended())
        story.receives(2, core(altitude_m=321.0, height_m=1.0))
        assert story.vehicle().altitude_offset_at_takeoff_m == 320.0

    def test_a_takeoff_the_new_link_saw_before_its_serial_counts(self) -> None:
        story = known().closes(1).at(60.0).opens(2)
        story.receives(2, core(flying=False, altitude_m=320.0, height_m=0.0))
        story.receives(2, core(altitude_m=321.0, height_m=1.0), extended())
        assert story.vehicle().altitude_offset_at_takeoff_m == 320.0

    def test_a_reconnect_in_flight_keeps_the_offset_of_the_takeoff(self) -> None:
        story = known().closes(1).at(5.0).opens(2).receives(2, core(altitude_m=330.0), extended())
        assert story.vehicle().altitude_offset_at_takeoff_m == 260.0


class TestBattery:
    def test_a_capacity_factor_mends_an_app_that_reports_half(self) -> None:
        fleet = Fleet(profiles={"A": VehicleProfile("A", battery_factor=2.0)})
        story = Story(fleet).opens(1).receives(1, extended(battery=0.4))
        story.receives(1, extended(battery=0.4))
        assert story.vehicle().battery_fraction.value == pytest.approx(0.8)
        story.at(60.0).receives(1, extended(battery=0.9))
        assert story.vehicle().battery_fraction.value == 1.0


class TestTrack:
    def test_it_keeps_a_point_a_second_where_the_vehicle_moves(self) -> None:
        story = Story().opens(1).receives(1, extended())
        for tenth in range(100):
            place = LatLon(42.0 + tenth * 1e-5, -93.6)
            story.at(tenth / 10).receives(1, core(position=place))
        assert len(story.vehicle().track) == 10

    def test_it_is_bounded(self) -> None:
        story = Story().opens(1).receives(1, extended())
        for second in range(700):
            story.at(second).receives(1, core(position=LatLon(42.0 + second * 1e-4, -93.6)))
        assert len(story.vehicle().track) == 600

    def test_no_position_adds_no_point(self) -> None:
        assert Story().opens(1).receives(1, extended(), core(position=None)).vehicle().track == ()
