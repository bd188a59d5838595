"""When each row's condition holds, and what a site may choose to do about it."""

import pytest
from tests.safety.failsafe.flights import NOW_NS, ago_ns, facts

from recon.model.failsafe_matrix import (
    Activity,
    FailsafeCell,
    FailsafeCondition,
    FailsafeMatrix,
    Reaction,
)
from recon.model.severity import Severity
from recon.model.vehicle import Attitude, BatteryWarning
from recon.safety.failsafe import DEFAULT_MATRIX, ROWS, RelatedFinding, SharedFacts, cell_words
from recon.safety.failsafe import attitude as attitude_row
from recon.safety.failsafe import battery_critical as critical_row
from recon.safety.failsafe import battery_low as low_row
from recon.safety.failsafe import gnss_lost as gnss_row
from recon.safety.failsafe import wind as wind_row
from recon.safety.failsafe.row import FlightFacts, cells, hold, recall


def since(condition: FailsafeCondition, given: FlightFacts) -> int | None:
    find = ROWS[condition].find
    assert find is not None
    return find(given)


STALE = {"core_received_at_ns": ago_ns(4.0)}


def test_a_healthy_flight_has_none_of_them() -> None:
    for row in ROWS.values():
        assert row.find is None or row.find(facts()) is None, row.condition


class TestLinkLost:
    def test_without_a_link_since_the_last_telemetry(self) -> None:
        lost = facts(opened_at_ns=None, core_received_at_ns=ago_ns(7.0))
        assert since(FailsafeCondition.LINK_LOST, lost) == ago_ns(7.0)

    def test_on_a_new_link_until_its_first_telemetry(self) -> None:
        new = facts(opened_at_ns=ago_ns(1.0), core_received_at_ns=ago_ns(7.0))
        assert since(FailsafeCondition.LINK_LOST, new) == ago_ns(7.0)
        assert since(FailsafeCondition.TELEMETRY_LOST, new) is None
        assert since(FailsafeCondition.LINK_LOST, facts(opened_at_ns=ago_ns(1.0))) is None

    def test_telemetry_as_old_as_the_link_came_on_it(self) -> None:
        same = facts(opened_at_ns=ago_ns(2.0), core_received_at_ns=ago_ns(2.0))
        assert since(FailsafeCondition.LINK_LOST, same) is None
        assert since(FailsafeCondition.TELEMETRY_LOST, same) == ago_ns(2.0)

    def test_a_vehicle_without_any_telemetry_has_lost_none(self) -> None:
        never = facts(opened_at_ns=None, core_received_at_ns=None)
        assert since(FailsafeCondition.LINK_LOST, never) is None
        assert since(FailsafeCondition.TELEMETRY_LOST, never) is None


class TestTelemetryLost:
    @pytest.mark.parametrize(("age_s", "is_lost"), [(0.9, False), (1.0, True), (60.0, True)])
    def test_after_a_second_on_an_open_link(self, age_s: float, is_lost: bool) -> None:
        old = facts(core_received_at_ns=ago_ns(age_s))
        expected = ago_ns(age_s) if is_lost else None
        assert since(FailsafeCondition.TELEMETRY_LOST, old) == expected

    def test_without_a_link_it_is_the_links_row(self) -> None:
        lost = facts(opened_at_ns=None, core_received_at_ns=ago_ns(7.0))
        assert since(FailsafeCondition.TELEMETRY_LOST, lost) is None


class TestGnssLost:
    def test_without_a_position_or_at_level_0(self) -> None:
        assert since(FailsafeCondition.GNSS_LOST, facts(position=None)) == NOW_NS
        assert since(FailsafeCondition.GNSS_LOST, facts(gnss_signal_level=0)) == NOW_NS
        assert since(FailsafeCondition.GNSS_LOST, facts(gnss_signal_level=1)) is None

    def test_not_before_its_reception_was_reported_or_on_old_telemetry(self) -> None:
        assert not gnss_row.is_lost(facts(position=None, extended_received_at_ns=None).vehicle)
        assert since(FailsafeCondition.GNSS_LOST, facts(position=None, **STALE)) is None


class TestBattery:
    LOW, CRITICAL = FailsafeCondition.BATTERY_LOW, FailsafeCondition.BATTERY_CRITICAL

    @pytest.mark.parametrize(
        ("level", "is_low", "is_critical"),
        [(0.26, False, False), (0.25, True, False), (0.11, True, False), (0.10, False, True)],
    )
    def test_by_the_level(self, level: float, is_low: bool, is_critical: bool) -> None:
        given = facts(battery_fraction=level)
        assert since(self.LOW, given) == (NOW_NS if is_low else None)
        assert since(self.CRITICAL, given) == (NOW_NS if is_critical else None)

    def test_by_the_aircrafts_warning(self) -> None:
        assert since(self.LOW, facts(battery_warning=BatteryWarning.LOW)) == NOW_NS
        assert since(self.CRITICAL, facts(battery_warning=BatteryWarning.SERIOUS)) == NOW_NS
        assert since(self.LOW, facts(battery_warning=BatteryWarning.SERIOUS)) is None

    def test_an_unknown_battery_and_one_on_the_ground_count_as_full(self) -> None:
        assert critical_row.left_in_flight(facts(battery_fraction=None).vehicle) == 1.0
        landed = facts(battery_fraction=0.05, is_flying=False).vehicle
        assert critical_row.left_in_flight(landed) == 1.0

    def test_by_the_route_home(self) -> None:
        for severity, low, critical in (
            (Severity.ERROR, None, None),
            (Severity.WARNING, ago_ns(2.0), None),
            (Severity.CRITICAL, None, ago_ns(2.0)),
        ):
            given = facts(findings={"battery_home": RelatedFinding(severity, ago_ns(2.0))})
            assert since(self.LOW, given) == low
            assert since(self.CRITICAL, given) == critical

    def test_an_unknown_level_old_telemetry_and_the_ground_are_none(self) -> None:
        for given in (
            facts(battery_fraction=None),
            facts(battery_fraction=0.05, **STALE),
            facts(battery_fraction=0.05, is_flying=False),
        ):
            assert since(self.LOW, given) is None
            assert since(self.CRITICAL, given) is None


class TestWindAndAttitude:
    def test_wind_from_the_warning_level_on(self) -> None:
        assert since(FailsafeCondition.WIND, facts(wind_level=1)) is None
        assert since(FailsafeCondition.WIND, facts(wind_level=2)) == NOW_NS
        assert since(FailsafeCondition.WIND, facts(wind_level=2, **STALE)) is None

    @pytest.mark.parametrize("sign", [1.0, -1.0])
    def test_a_tilt_beyond_the_limit(self, sign: float) -> None:
        for tilt_deg, is_far in [(45.0, False), (45.1, True)]:
            for tilted in (
                Attitude(0.0, sign * tilt_deg, 0.0),
                Attitude(0.0, 0.0, sign * tilt_deg),
            ):
                expected = NOW_NS if is_far else None
                assert since(FailsafeCondition.ATTITUDE, facts(attitude=tilted)) == expected
                assert since(FailsafeCondition.ATTITUDE, facts(attitude=tilted, **STALE)) is None
        assert since(FailsafeCondition.ATTITUDE, facts(attitude=None)) is None


@pytest.mark.parametrize("age_s", [2.999, 3.0])
def test_telemetry_of_3_s_is_too_old_to_show_how_it_flies(age_s: float) -> None:
    old = facts(battery_fraction=0.05, core_received_at_ns=ago_ns(age_s))
    assert old.is_live is (age_s < 3.0)


def test_the_words_state_value_limit_and_what_to_do() -> None:
    tilted = facts(attitude=Attitude(0.0, 5.0, -50.4)).vehicle
    assert attitude_row.words(tilted, 45.0) == (
        "tilted by 50 deg, limit 45 deg: its pilot must take over; keep clear below"
    )
    windy = facts(wind_level=3).vehicle
    assert wind_row.words(windy, 2) == (
        "strong wind, reported by the aircraft (level 3, limit 2), near what it can fly in: "
        "bring it lower and home, or land it"
    )
    critical = critical_row.words
    assert critical(facts(battery_warning=BatteryWarning.SERIOUS).vehicle, 0.1) == (
        "battery critically low, reported by the aircraft: land now"
    )
    at_limit = facts(battery_fraction=0.1).vehicle
    assert critical(at_limit, 0.1) == "battery at 10%, limit 10%: land now"
    assert critical(facts(battery_fraction=0.2).vehicle, 0.1) is None
    low = low_row.words
    assert low(facts(battery_warning=BatteryWarning.LOW).vehicle, 0.25) == (
        "battery low, reported by the aircraft: return home"
    )
    below = facts(battery_fraction=0.2).vehicle
    assert low(below, 0.25) == "battery at 20%, limit 25%: return home"
    assert low(facts().vehicle, 0.25) is None


class TestTheStationsOwn:
    def test_the_imaging_drone_concerns_the_others(self) -> None:
        lost = SharedFacts(imager_serials=frozenset({"B", "C"}), imager_lost_since_ns=ago_ns(5.0))
        assert since(FailsafeCondition.IMAGING_DRONE_LOST, facts(station=lost)) == ago_ns(5.0)
        for serial in ("B", "C"):
            itself = facts(station=lost, serial=serial)
            assert since(FailsafeCondition.IMAGING_DRONE_LOST, itself) is None

    def test_lateness_and_operators(self) -> None:
        given = facts(station=SharedFacts(1, 2))
        assert since(FailsafeCondition.STATION_OVERLOADED, given) == 1
        assert since(FailsafeCondition.OPERATOR_GONE, given) == 2


class TestWhatASiteMayChoose:
    def test_every_default_is_offered(self) -> None:
        for row in ROWS.values():
            for activity in Activity:
                assert row.default[activity].reaction in row.offered(activity)

    def test_nothing_weaker_than_what_is_under_way(self) -> None:
        for row in ROWS.values():
            if row.is_timed:
                assert Reaction.HOLD not in row.offered(Activity.HOLDING)
                assert not {Reaction.HOLD, Reaction.RETURN} & row.offered(Activity.RETURNING)

    def test_a_fixed_cell_offers_its_default_alone(self) -> None:
        row = ROWS[FailsafeCondition.TELEMETRY_LOST]
        assert row.offered(Activity.STEERED) == {Reaction.HOLD}
        assert row.offered(Activity.MISSION) == {Reaction.ALARM, Reaction.HOLD}

    def test_cells_as_the_rows_write_them(self) -> None:
        row = cells(hold(3.0), hold(), recall(4.0), recall())
        assert row == {
            Activity.MISSION: FailsafeCell(Reaction.HOLD, 3.0),
            Activity.STEERED: FailsafeCell(Reaction.HOLD, 0.0),
            Activity.HOLDING: FailsafeCell(Reaction.RETURN, 4.0),
            Activity.RETURNING: FailsafeCell(Reaction.RETURN, 0.0),
        }

    def test_cells_in_words(self) -> None:
        link, battery = (
            ROWS[FailsafeCondition.LINK_LOST],
            ROWS[FailsafeCondition.BATTERY_CRITICAL],
        )
        words = [cell_words(link, link.default[activity]) for activity in Activity]
        assert words == [
            "hold when back after 30 s or more",
            "hold when back",
            "alarm",
            "alarm",
        ]
        assert cell_words(battery, battery.default[Activity.MISSION]) == "return at once"
        assert cell_words(battery, FailsafeCell(Reaction.LAND, 5.0)) == "land after 5 s"
        fence = ROWS[FailsafeCondition.GEOFENCE]
        assert cell_words(fence, fence.default[Activity.MISSION]) == "hold"


class TestTheMatrix:
    def test_it_is_total(self) -> None:
        rows = {**DEFAULT_MATRIX.rows, FailsafeCondition.WIND: {}}
        with pytest.raises(ValueError, match="wind"):
            FailsafeMatrix(rows)

    def test_differences_and_what_is_weaker(self) -> None:
        later, land = FailsafeCell(Reaction.HOLD, 9.0), FailsafeCell(Reaction.LAND)
        row = {**DEFAULT_MATRIX.rows[FailsafeCondition.TELEMETRY_LOST], Activity.MISSION: later}
        changed = FailsafeMatrix({**DEFAULT_MATRIX.rows, FailsafeCondition.TELEMETRY_LOST: row})
        ((condition, activity, cell, default),) = changed.differences(DEFAULT_MATRIX)
        assert (condition, activity) == (FailsafeCondition.TELEMETRY_LOST, Activity.MISSION)
        assert cell.is_weaker_than(default)
        assert not default.is_weaker_than(cell)
        assert default.is_weaker_than(land)
        assert not FailsafeCell(Reaction.ALARM).is_weaker_than(FailsafeCell(Reaction.ALARM))
