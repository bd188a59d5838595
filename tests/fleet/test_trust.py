"""Packets that are not plausible are not telemetry; honest ones always are."""

import pytest
from tests.fleet.reports import PLACE, S
from tests.fleet.test_airborne import Flight, in_flight

from recon.fleet.state import staleness
from recon.geo.distance import horizontal_distance_m
from recon.model.event import ClockGap
from recon.model.trust import DoubtKind
from recon.model.vehicle import Staleness


def age_s(flight: Flight) -> float:
    received_ns = flight.story.vehicle().core_received_at_ns
    assert received_ns is not None
    return flight.story.now_s - received_ns / S


class TestJumps:
    @pytest.mark.parametrize(("north_m", "height_m"), [(-60.0, 0.0), (2_000.0, 0.0), (0.0, 30.0)])
    def test_a_jump_is_not_telemetry(self, north_m: float, height_m: float) -> None:
        flight = in_flight()
        before = flight.story.vehicle()
        flight.north_m, flight.height_m = flight.north_m + north_m, flight.height_m + height_m
        flight.reports(1.5, flying=True)
        after = flight.story.vehicle()
        assert after.position == before.position
        assert after.height_above_takeoff_m == before.height_above_takeoff_m
        assert age_s(flight) == pytest.approx(1.5)
        assert flight.doubts == {DoubtKind.JUMP}

    def test_a_run_that_follows_from_itself_is_the_new_truth_after_2_s(self) -> None:
        flight = in_flight()
        flight.north_m -= 60.0
        flight.reports(1.9, flying=True)
        assert flight.story.vehicle().trust.jump_accepted_at_ns is None
        flight.reports(0.3, flying=True)
        vehicle = flight.story.vehicle()
        assert vehicle.trust.jump_accepted_at_ns is not None
        assert vehicle.position.value is not None
        assert horizontal_distance_m(PLACE, vehicle.position.value) == pytest.approx(40.0, abs=0.1)
        assert age_s(flight) < 0.2
        flight.reports(50.0, flying=True)
        assert flight.doubts == {DoubtKind.JUMP}
        assert flight.reports(12.0, flying=True).doubts == set()

    def test_places_that_jump_from_packet_to_packet_are_never_believed(self) -> None:
        flight = in_flight()
        for _ in range(60):
            for off_m in (-60.0, 90.0):
                flight.north_m += off_m
                flight.reports(0.1, flying=True)
        assert staleness(flight.story.vehicle(), round(flight.story.now_s * S)) is Staleness.SILENT

    def test_after_a_gap_it_may_have_flown_farther(self) -> None:
        flight = in_flight().goes_silent(10.0)
        flight.north_m += 150.0
        assert flight.reports(0.2, flying=True).doubts == set()

    def test_in_a_burst_packets_may_be_missing(self) -> None:
        flight = in_flight()
        flight.north_m += 15.0
        flight.story.now_s -= 0.1
        assert flight.reports(0.1, flying=True).doubts == set()
        flight.north_m += 60.0
        flight.story.now_s -= 0.1
        assert flight.reports(0.1, flying=True).doubts == {DoubtKind.JUMP}

    def test_on_the_ground_heights_may_jump(self) -> None:
        flight = Flight(height_m=20.0).reports(2.0, flying=False)
        flight.height_m = 0.0
        assert flight.reports(0.2, flying=False).doubts == set()


class TestFrozen:
    def test_a_moving_vehicle_is_frozen_after_1_s_and_its_age_counts_from_the_last_change(
        self,
    ) -> None:
        flight = in_flight()
        report = flight.story.vehicle()
        self.repeats(flight, 3.0)
        assert flight.story.vehicle().position.value == report.position.value
        assert age_s(flight) == pytest.approx(3.0)
        assert flight.doubts == {DoubtKind.FROZEN}
        assert staleness(flight.story.vehicle(), round(flight.story.now_s * S)) is Staleness.LOST

    def test_a_hovering_one_after_5_s(self) -> None:
        flight = in_flight().reports(1.0, flying=True)
        self.repeats(flight, 4.8)
        assert age_s(flight) < 0.2
        self.repeats(flight, 0.5)
        assert age_s(flight) == pytest.approx(5.3, abs=0.15)

    def test_on_the_ground_values_may_stay_the_same(self) -> None:
        flight = Flight().reports(1.0, flying=False)
        self.repeats(flight, 20.0)
        assert flight.doubts == set()

    def repeats(self, flight: Flight, seconds: float) -> None:
        """The newest packet comes again and again."""
        packets, vehicle = flight.packets, flight.story.vehicle()
        velocity = vehicle.velocity_ned.value
        assert velocity is not None
        for _ in range(round(10 * seconds)):
            flight.packets = packets - 1
            flight.north_m -= 0.1 * velocity.north_mps
            flight.reports(
                0.1, flying=vehicle.reported_is_flying.value, north_mps=velocity.north_mps
            )

    def test_a_position_that_stands_still_at_speed_is_not_telemetry(self) -> None:
        flight = in_flight()
        for _ in range(80):
            flight.north_m -= 0.5
            flight.reports(0.1, flying=True, north_mps=5.0)
        assert flight.doubts == {DoubtKind.STANDSTILL}
        assert age_s(flight) > 3.0


class TestBattery:
    def test_a_rise_in_flight_is_not_believed(self) -> None:
        flight = in_flight()
        flight.battery = 0.95
        flight.reports(1.0, flying=True)
        assert flight.story.vehicle().battery_fraction.value == 0.8
        assert flight.doubts == {DoubtKind.BATTERY}

    def test_a_sudden_fall_is_believed_and_doubted_and_may_return_at_once(self) -> None:
        flight = in_flight()
        flight.battery = 0.3
        flight.reports(1.0, flying=True)
        assert flight.story.vehicle().battery_fraction.value == 0.3
        assert flight.doubts == {DoubtKind.BATTERY}
        flight.battery = 0.79
        flight.reports(1.0, flying=True)
        assert flight.story.vehicle().battery_fraction.value == 0.79


class TestAfterAGap:
    def test_what_waited_in_the_sockets_is_not_telemetry(self) -> None:
        flight = in_flight()
        flight.goes_silent(60.0).story.happens(ClockGap(60.0))
        flight.reports(0.9, flying=True)
        assert age_s(flight) > 60.0
        flight.reports(0.3, flying=True)
        assert age_s(flight) < 0.2
