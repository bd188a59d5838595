"""When an imaging drone must return, what a survey needs, and the leg to its place."""

import numpy as np
import pytest

from recon.geo.distance import horizontal_distance_m, offset_north_east_m
from recon.guidance.imager_relief import (
    CHARGES_KEPT,
    Charge,
    MissingGround,
    layers_m,
    least_share,
    relief_mission,
    return_due_ns,
    shown_share,
    survey_needs_s,
    transit_time_s,
    use_per_s,
    with_charge,
    with_missing,
)
from recon.model.geo import LatLon

S = 1_000_000_000
HERE = LatLon(41.9, -93.6)
THERE = LatLon(41.9, -93.599)


def falling(percents: list[int], every_s: float = 15.0) -> tuple[Charge, ...]:
    """A charge reported ten times a second, that falls a percent every 15 s."""
    charges: tuple[Charge, ...] = ()
    for number, percent in enumerate(percents):
        for tenth in range(int(every_s * 10)):
            at_ns = round((number * every_s + tenth / 10.0) * S)
            charges = with_charge(charges, at_ns, percent / 100.0)
    return charges


class TestUse:
    def test_it_is_read_from_the_changes(self) -> None:
        charges = falling([90, 89, 88, 87, 86])
        assert use_per_s(charges) == pytest.approx(0.01 / 15.0)

    def test_it_is_unknown_before_three_steps_between_changes(self) -> None:
        assert use_per_s(falling([90, 89, 88, 87])) is None
        assert use_per_s(()) is None

    def test_the_first_report_does_not_count(self) -> None:
        """It came just before its change: with it the use would seem a third higher."""
        late = (Charge(14 * S, 0.90), *falling([90, 89, 88, 87, 86])[1:])
        assert use_per_s(late) == pytest.approx(0.01 / 15.0)

    def test_what_was_used_in_the_climb_is_forgotten(self) -> None:
        charges = falling([100 - step for step in range(10)], every_s=8.0)
        for step in range(CHARGES_KEPT + 1):
            charges = with_charge(charges, (80 + 15 * step) * S, (90 - step) / 100.0)
        assert len(charges) == CHARGES_KEPT
        assert use_per_s(charges) == pytest.approx(0.01 / 15.0)

    def test_a_small_rise_is_no_fresh_battery(self) -> None:
        charges = falling([90, 89, 88, 87, 86])
        assert with_charge(charges, 80 * S, 0.87) == charges

    def test_a_fresh_battery_begins_anew(self) -> None:
        assert with_charge(falling([30, 29, 28]), 80 * S, 0.99) == (Charge(80 * S, 0.99),)

    def test_a_lost_cell_is_no_use(self) -> None:
        assert with_charge(falling([90, 89, 88]), 80 * S, 0.60) == (Charge(80 * S, 0.60),)


class TestLeaves:
    def test_it_leaves_when_the_charge_is_what_is_needed(self) -> None:
        assert return_due_ns(Charge(100 * S, 0.50), 0.01 / 15.0, 0.30) == 400 * S

    def test_it_may_be_past(self) -> None:
        assert return_due_ns(Charge(100 * S, 0.29), 0.01 / 15.0, 0.30) == 85 * S


class TestSurveyNeeds:
    def test_its_missing_ground_at_its_recent_pace(self) -> None:
        history = (MissingGround(0, 10_000.0), MissingGround(100 * S, 8_000.0))
        assert survey_needs_s(history, 100 * S) == pytest.approx(400.0)
        assert survey_needs_s(history, 105 * S) == pytest.approx(395.0)

    def test_unknown_in_its_first_minute_and_without_progress(self) -> None:
        assert survey_needs_s((), 0) is None
        early = (MissingGround(0, 10_000.0), MissingGround(50 * S, 8_000.0))
        assert survey_needs_s(early, 50 * S) is None
        waits = (MissingGround(0, 10_000.0), MissingGround(100 * S, 10_000.0))
        assert survey_needs_s(waits, 100 * S) is None

    def test_nothing_when_nothing_is_missing(self) -> None:
        assert survey_needs_s((MissingGround(0, 0.0),), 5 * S) == 0.0

    def test_the_pace_is_of_the_last_five_minutes(self) -> None:
        history: tuple[MissingGround, ...] = ()
        for number in range(100):
            history = with_missing(
                history, MissingGround(number * 10 * S, 10_000.0 - 10.0 * number)
            )
        assert history[0].at_ns == 690 * S
        assert len(history) == 31


class TestShown:
    def test_the_share_of_what_the_other_knows(self) -> None:
        other = np.array([[True, True, True, True, False]])
        own = np.array([[True, True, True, False, True]])
        assert shown_share(own, other) == 0.75

    def test_any_cell_is_enough_without_another_map(self) -> None:
        nothing, one = np.zeros((2, 2), bool), np.eye(2, dtype=bool)
        assert shown_share(one, None) == 1.0
        assert shown_share(one, nothing) == 1.0
        assert shown_share(nothing, None) == 0.0

    def test_from_lower_less_ground_must_be_shown(self) -> None:
        assert least_share(120.0, 100.0) == 0.7
        assert least_share(50.0, 100.0) == pytest.approx(0.175)
        assert least_share(None, 100.0) == least_share(100.0, None) == 0.7


class TestWay:
    def test_layers_go_outwards_between_ground_and_ceiling(self) -> None:
        assert list(layers_m(60.0, 7.9, 75.0, may_be_above=True)) == [70, 74, 40, 36, 32, 28, 24]
        assert list(layers_m(60.0, 7.9, 99.0, may_be_above=True))[:4] == [70, 74, 78, 40]
        assert list(layers_m(60.0, 7.9, 75.0, may_be_above=False)) == [40, 36, 32, 28, 24]
        assert list(layers_m(25.0, 7.9, 30.0, may_be_above=True)) == []

    def test_barometers_that_may_have_drifted_take_more(self) -> None:
        assert next(layers_m(60.0, 11.5, 119.0, may_be_above=True)) == 71.5

    def test_straight_up_and_across(self) -> None:
        mission = relief_mission(HERE, THERE, 68.0, -90.0)
        above, across = mission.waypoints
        assert (above.latitude_deg, above.longitude_deg) == (HERE.latitude_deg, HERE.longitude_deg)
        assert (across.latitude_deg, across.longitude_deg) == (
            THERE.latitude_deg,
            THERE.longitude_deg,
        )
        assert above.height_above_takeoff_m == across.height_above_takeoff_m == 68.0
        assert (above.gimbal_pitch_deg, across.gimbal_pitch_deg) == (None, -90.0)
        assert not mission.land_at_end

    def test_right_above_its_pad_no_leg_is_without_length(self) -> None:
        above, across = relief_mission(HERE, HERE, 68.0, None).waypoints
        assert across.height_above_takeoff_m - above.height_above_takeoff_m == 2.0
        assert offset_north_east_m(HERE, LatLon(across.latitude_deg, across.longitude_deg)) == (
            0.0,
            0.0,
        )

    def test_how_long_it_takes(self) -> None:
        across_m = horizontal_distance_m(HERE, THERE)
        assert transit_time_s(HERE, 60.0, THERE) == pytest.approx(15.0 + 30.0 + across_m / 8.0)
