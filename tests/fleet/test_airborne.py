"""Whether a vehicle is in the air: a wrong flag neither lands it nor takes it off."""

from dataclasses import dataclass, field

import pytest
from tests.fleet.reports import PLACE, S, Story, core, extended, jittered

from recon.geo.distance import moved_m
from recon.model.event import PacketReceived
from recon.model.trust import DoubtKind
from recon.model.vehicle import FlightMode

LANDING, GPS, MISSION = FlightMode.AUTO_LANDING, FlightMode.GPS_ATTI, FlightMode.GPS_WAYPOINT


@dataclass
class Flight:
    """One vehicle whose telemetry comes at 10 Hz, its mode at 2 Hz."""

    story: Story = field(default_factory=lambda: Story().opens(1).receives(1, extended(mode=GPS)))
    north_m: float = 0.0
    height_m: float = 0.0
    battery: float = 0.8
    packets: int = 0

    def reports(
        self,
        seconds: float,
        *,
        flying: bool | None,
        mode: FlightMode = GPS,
        north_mps: float = 0.0,
        up_mps: float = 0.0,
        drain: float = 0.0,
    ) -> "Flight":
        for _ in range(round(10 * seconds)):
            self.story.now_s += 0.1
            self.packets += 1
            self.north_m += 0.1 * north_mps
            self.height_m += 0.1 * up_mps
            self.battery -= 0.1 * drain
            if self.packets % 5 == 0:
                self.story.receives(1, extended(mode=mode, battery=round(self.battery, 2)))
            report = core(
                flying=flying,
                position=moved_m(PLACE, self.north_m, 0.0),
                height_m=self.height_m,
                altitude_m=260.0 + self.height_m,
                velocity=(north_mps, 0.0, -up_mps),
            )
            self.story.happens(PacketReceived(1, jittered(report, self.packets)))
        return self

    def goes_silent(self, seconds: float) -> "Flight":
        self.story.now_s += seconds
        return self

    @property
    def belief(self) -> bool | None:
        return self.story.vehicle().is_flying.value

    @property
    def doubts(self) -> set[DoubtKind]:
        now_ns = round(self.story.now_s * S)
        return {d.kind for d in self.story.vehicle().trust.doubts if d.until_ns > now_ns}


def in_flight(height_m: float = 40.0) -> Flight:
    """It took off here, climbed, and flew 100 m north."""
    flight = Flight().reports(2.0, flying=False)
    flight.reports(height_m / 4.0, flying=True, up_mps=4.0)
    return flight.reports(20.0, flying=True, north_mps=5.0)


class TestAFalseReportOfTheGround:
    def test_one_packet_moves_neither_home_nor_the_altitude_datum(self) -> None:
        flight = in_flight()
        before = flight.story.vehicle()
        flight.reports(0.1, flying=False).reports(1.0, flying=True)
        after = flight.story.vehicle()
        assert after.is_flying.value is True
        assert after.takeoff_point == before.takeoff_point
        assert after.altitude_offset_at_takeoff_m == before.altitude_offset_at_takeoff_m
        assert flight.doubts == {DoubtKind.GROUND_REPORT}

    @pytest.mark.parametrize("north_mps", [0.0, 8.0])
    def test_a_steady_one_at_40_m_never_lands_it(self, north_mps: float) -> None:
        flight = in_flight()
        for _ in range(60):
            flight.reports(5.0, flying=False, north_mps=north_mps, drain=0.0006)
            assert flight.belief is True
            assert flight.doubts == {DoubtKind.GROUND_REPORT}

    def test_after_a_descent_it_is_uncertain_and_not_on_the_ground(self) -> None:
        flight = in_flight().reports(5.0, flying=True, up_mps=-4.0)
        flight.reports(60.0, flying=False, drain=0.0006)
        assert flight.belief is None
        assert flight.doubts == {DoubtKind.GROUND_REPORT}

    def test_a_landing_called_off_at_20_m_is_none(self) -> None:
        flight = in_flight().reports(3.0, flying=True, up_mps=-3.0, mode=LANDING)
        flight.reports(4.0, flying=False, up_mps=-3.0, mode=LANDING)
        flight.reports(60.0, flying=False, mode=GPS, drain=0.0006)
        assert flight.belief is not False

    def test_the_height_over_home_is_no_landing_elsewhere(self) -> None:
        flight = in_flight().reports(19.0, flying=True, up_mps=-2.0)
        assert flight.height_m == pytest.approx(2.0)
        flight.reports(30.0, flying=False, drain=0.0006)
        assert flight.belief is None


class TestALanding:
    def test_it_is_believed_a_second_after_a_landing_mode_on_any_slope(self) -> None:
        flight = in_flight().reports(9.0, flying=True, up_mps=-3.0, mode=LANDING)
        assert flight.height_m == pytest.approx(13.0)
        flight.reports(0.9, flying=False, mode=LANDING)
        assert flight.belief is None
        flight.reports(0.3, flying=False, mode=LANDING)
        assert flight.belief is False
        assert flight.doubts == set()

    def test_one_from_knee_height_is_in_doubt_at_once_so_that_no_hover_starts_a_takeoff(
        self,
    ) -> None:
        flight = in_flight().reports(19.6, flying=True, up_mps=-2.0).reports(40.0, flying=True)
        assert flight.height_m == pytest.approx(0.8)
        flight.reports(1.0, flying=True, up_mps=-0.8, mode=LANDING)
        for _ in range(20):
            flight.reports(0.5, flying=False, mode=GPS)
            assert flight.belief is None

    def test_of_one_that_sinks_on_it_stays_false(self) -> None:
        flight = in_flight().reports(1.0, flying=True, up_mps=-0.5, mode=LANDING)
        flight.reports(5.0, flying=False, up_mps=-2.0, mode=LANDING)
        assert flight.belief is True

    def test_it_is_believed_at_home_in_any_mode(self) -> None:
        flight = in_flight().reports(20.0, flying=True, north_mps=-5.0)
        flight.reports(20.0, flying=True, up_mps=-2.0).reports(1.3, flying=False)
        assert flight.belief is False
        assert flight.doubts == set()

    def test_in_a_gap_it_is_believed_at_takeoff_height_of_an_unknown_takeoff_point(self) -> None:
        flight = Flight(height_m=40.0).reports(5.0, flying=True).goes_silent(30.0)
        flight.north_m, flight.height_m = -100.0, 0.0
        assert flight.reports(1.3, flying=False).belief is False

    def test_in_a_gap_elsewhere_it_may_be_high_above_a_valley(self) -> None:
        flight = in_flight().goes_silent(30.0)
        flight.north_m, flight.height_m = -100.0, 0.0
        assert flight.reports(10.0, flying=False, drain=0.0006).belief is None

    def test_elsewhere_two_minutes_at_rest_with_the_same_battery_show_it(self) -> None:
        flight = in_flight().reports(5.0, flying=True, up_mps=-4.0)
        flight.reports(118.0, flying=False)
        assert flight.belief is None
        assert flight.reports(5.0, flying=False).belief is False

    def test_a_battery_changed_in_a_gap_shows_it(self) -> None:
        flight = in_flight().goes_silent(60.0)
        flight.height_m, flight.battery = 12.0, 1.0
        assert flight.reports(2.0, flying=False).belief is False


class TestTakeoff:
    def test_home_is_where_it_takes_off(self) -> None:
        flight = Flight().reports(2.0, flying=False)
        assert flight.story.vehicle().takeoff_point is None
        flight.reports(1.0, flying=True, up_mps=1.0)
        assert flight.story.vehicle().takeoff_point == PLACE
        flight.reports(10.0, flying=True, north_mps=8.0)
        assert flight.story.vehicle().takeoff_point == PLACE

    def test_in_a_gap_home_is_where_it_stood(self) -> None:
        flight = Flight().reports(2.0, flying=False).goes_silent(20.0)
        flight.north_m, flight.height_m = 80.0, 30.0
        flight.reports(1.0, flying=True)
        assert flight.story.vehicle().takeoff_point == PLACE

    def test_after_a_long_gap_home_is_unknown(self) -> None:
        flight = Flight().reports(2.0, flying=False).goes_silent(600.0)
        flight.north_m, flight.height_m = 80.0, 30.0
        assert flight.reports(1.0, flying=True).story.vehicle().takeoff_point is None


class TestSignsOfFlightOnTheGround:
    def test_motion_makes_it_uncertain_and_standing_still_ends_that(self) -> None:
        flight = Flight().reports(2.0, flying=False).reports(1.5, flying=False, north_mps=3.0)
        assert flight.belief is None
        assert flight.doubts == {DoubtKind.FLIGHT_SIGNS}
        flight.reports(1.5, flying=False)
        assert flight.belief is False

    def test_a_mission_that_moves_it_is_a_flight_with_its_home_where_it_stood(self) -> None:
        flight = Flight().reports(2.0, flying=False)
        flight.reports(4.0, flying=False, up_mps=4.0, north_mps=2.0, mode=MISSION)
        assert flight.belief is True
        assert flight.story.vehicle().takeoff_point == PLACE

    def test_a_new_zero_of_the_barometer_is_none(self) -> None:
        flight = Flight(height_m=12.0).reports(2.0, flying=False)
        flight.height_m = 0.0
        assert flight.reports(5.0, flying=False).belief is False
        assert flight.doubts == set()

    def test_the_air_pressure_of_a_day_is_none(self) -> None:
        flight = Flight().reports(600.0, flying=False, up_mps=0.02)
        assert flight.belief is False
        assert flight.doubts == set()


class TestAnotherLink:
    def test_a_new_link_that_reports_the_ground_lands_nothing(self) -> None:
        flight = in_flight()
        flight.story.closes(1).at(flight.story.now_s + 2.0).opens(2)
        flight.story.receives(2, core(flying=False, height_m=40.0), extended())
        assert flight.story.vehicle().is_flying.value is None
        assert flight.story.vehicle().takeoff_point == PLACE
