"""Legs, stops and rounded corners, against the laws of motion."""

from dataclasses import replace
from itertools import pairwise
from math import cos, hypot, pi, sin, sqrt

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.examples import examples

from recon.safety.prediction.legs import (
    LEAST_M,
    Leg,
    corner_bulge_m,
    eased_rise_s,
    fly,
    rise_s,
    stop,
    stopping_distance_m,
)
from recon.safety.prediction.trajectory import (
    CURVE,
    EAST_0,
    EAST_1,
    END_S,
    HIGH_1,
    LOW_1,
    NORTH_0,
    NORTH_1,
    PART,
    START_S,
    FlightPart,
    Row,
    TrajectoryWriter,
)
from recon.safety.prediction_settings import PredictionSettings

SETTINGS = PredictionSettings()
BRAKING = SETTINGS.braking_mps2
PART_3 = 3


def flown(
    long_m: float,
    start_mps: float,
    speed_mps: float,
    end_mps: float,
    *,
    rise_m: float = 0.0,
    exactly: bool = True,
    flies: PredictionSettings = SETTINGS,
) -> list[Row]:
    """A leg towards 3 east and 4 north."""
    writer = TrajectoryWriter(100.0, -50.0, 40.0, 40.0)
    band_m = 40.0 + rise_m, 40.0 + rise_m
    to_m = 100.0 + 0.6 * long_m, -50.0 + 0.8 * long_m
    fly(writer, Leg(*to_m, band_m, start_mps, speed_mps, end_mps, PART_3), flies, exactly=exactly)
    return writer.rows


def length_m(row: Row) -> float:
    return hypot(row[EAST_1] - row[EAST_0], row[NORTH_1] - row[NORTH_0])


def speeds_mps(row: Row) -> tuple[float, float]:
    """At the start and the end of a row, from the derivative of its share."""
    lasts_s = row[END_S] - row[START_S]
    bend = row[CURVE] * lasts_s**2
    return length_m(row) / lasts_s * (1.0 - bend), length_m(row) / lasts_s * (1.0 + bend)


def end_of(row: Row) -> tuple[float, ...]:
    return row[END_S], row[EAST_1], row[NORTH_1], row[LOW_1], row[HIGH_1]


lengths_m = st.floats(0.5, 120.0)
speeds = st.floats(0.5, 15.0)


class TestPhases:
    @given(lengths_m, st.floats(0.0, 20.0), speeds, st.floats(0.0, 1.0))
    @example(1.0, 4.0, 15.0, 1.0)
    @example(1.0, 0.5, 15.0, 1.0)
    @example(5.0, 15.0, 2.0, 0.0)
    @settings(max_examples=examples(200), deadline=None)
    def test_speed_is_gained_and_lost_at_the_braking_limit_and_else_kept(
        self, long_m: float, start_mps: float, speed_mps: float, end_share: float
    ) -> None:
        rows = flown(long_m, start_mps, speed_mps, end_share * speed_mps)
        reached = [speeds_mps(row) for row in rows]
        change = 2.0 * BRAKING * long_m
        slowest_mps, fastest_mps = (
            sqrt(max(0.0, start_mps**2 - change)),
            hypot(start_mps, sqrt(change)),
        )
        end_mps = min(max(end_share * speed_mps, slowest_mps), fastest_mps)
        # What is shorter than a millimetre is excluded.
        excluded_mps = sqrt(2.0 * BRAKING * 2.0 * LEAST_M)
        assert reached[0][0] == pytest.approx(start_mps, abs=excluded_mps)
        assert reached[-1][1] == pytest.approx(end_mps, abs=excluded_mps)
        for (_, before_mps), (after_mps, _) in pairwise(reached):
            assert after_mps == pytest.approx(before_mps, abs=excluded_mps)
        for row, (from_mps, to_mps) in zip(rows, reached, strict=True):
            gains_mps2 = (to_mps - from_mps) / (row[END_S] - row[START_S])
            if gains_mps2 == pytest.approx(0.0, abs=1e-6):
                assert from_mps == pytest.approx(speed_mps)
            else:
                assert abs(gains_mps2) == pytest.approx(BRAKING)
            assert max(from_mps, to_mps) <= max(start_mps, speed_mps) + 1e-6
        assert sum(map(length_m, rows)) == pytest.approx(long_m, abs=2.0 * LEAST_M)
        assert {row[PART] for row in rows} == {PART_3}

    @given(lengths_m, st.floats(0.0, 20.0), speeds, st.floats(0.0, 1.0))
    @settings(max_examples=examples(200), deadline=None)
    def test_an_even_row_lasts_as_long_as_the_phases(
        self, long_m: float, start_mps: float, speed_mps: float, end_share: float
    ) -> None:
        end_mps = end_share * speed_mps
        phases = flown(long_m, start_mps, speed_mps, end_mps)
        (row,) = flown(long_m, start_mps, speed_mps, end_mps, exactly=False)
        assert row[END_S] == pytest.approx(phases[-1][END_S], abs=0.1)
        assert (row[EAST_1], row[NORTH_1]) == (100.0 + 0.6 * long_m, -50.0 + 0.8 * long_m)
        assert row[CURVE] == 0.0

    @pytest.mark.parametrize(
        ("rise_m", "count"), [(0.0, 3), (21.0, 3), (21.1, 1), (-28.0, 3), (-28.1, 1)]
    )
    def test_a_change_of_height_that_takes_longer_sets_the_pace(
        self, rise_m: float, count: int
    ) -> None:
        """20 m at 4 m/s and 2 m/s2: 2 s for 4 m, 3 s for 12 m, 2 s for 4 m."""
        gentle = replace(SETTINGS, braking_mps2=2.0)
        rows = flown(20.0, 0.0, 4.0, 0.0, rise_m=rise_m, flies=gentle)
        assert len(rows) == count
        lasts_s = max(7.0, rise_m / 3.0, -rise_m / 4.0)
        end = lasts_s, 112.0, -34.0, 40.0 + rise_m, 40.0 + rise_m
        assert end_of(rows[-1]) == pytest.approx(end)

    @pytest.mark.parametrize("exactly", [False, True])
    @pytest.mark.parametrize("long_m", [0.0, LEAST_M])
    def test_a_leg_to_where_it_is_ends_at_its_height_at_once(
        self, long_m: float, exactly: bool
    ) -> None:
        writer = TrajectoryWriter(0.0, 0.0, 40.0, 60.0)
        fly(writer, Leg(long_m, 0.0, (50.0, 50.0), 0.0, 5.0, 0.0, 0), SETTINGS, exactly=exactly)
        (row,) = writer.rows
        assert 0.0 < row[END_S] < 0.05
        assert (row[LOW_1], row[HIGH_1]) == (50.0, 50.0)

    @pytest.mark.parametrize(("braking_mps2", "count"), [(500.0, 2), (500.1, 1)])
    def test_a_phase_shorter_than_a_millimetre_is_excluded(
        self, braking_mps2: float, count: int
    ) -> None:
        """1 m/s is lost on a millimetre."""
        hard = replace(SETTINGS, braking_mps2=braking_mps2)
        assert len(flown(10.0, 1.0, 1.0, 0.0, flies=hard)) == count

    def test_a_leg_commanded_at_no_speed_still_ends(self) -> None:
        (row,) = flown(10.0, 0.0, 0.0, 0.0, exactly=False)
        assert row[END_S] == pytest.approx(100.0, abs=0.1)


@pytest.mark.parametrize(
    ("band_m", "seconds"),
    [
        ((50.0, 50.0), 0.0),
        ((45.0, 55.0), 0.0),
        ((40.0, 60.0), 0.0),
        ((66.0, 66.0), 2.0),
        ((30.0, 66.0), 5.0),
        ((38.0, 66.0), 2.0),
        ((20.0, 20.0), 10.0),
        ((20.0, 58.0), 10.0),
        ((-1e5, 1e5), 600.0),
    ],
)
def test_a_band_of_heights_is_reached_when_its_farther_end_is(
    band_m: tuple[float, float], seconds: float
) -> None:
    """From 40 to 60 m, up at 3 m/s and down at 2 m/s."""
    assert rise_s(TrajectoryWriter(0.0, 0.0, 40.0, 60.0), band_m, 3.0, 2.0) == seconds


@pytest.mark.parametrize(
    ("rise_m", "speed_mps", "seconds"),
    [
        (12.5, 2.0, 7.5),  # 10 m at 2 m/s, and 2.5 m in 2.5 s
        (2.5, 2.0, 2.5),
        (0.4, 2.0, 1.0),  # 0.8 m/s are lost in 1 s
        (0.4, 0.8, 1.0),
        (1.2, 0.8, 2.0),
    ],
)
def test_a_climb_eases_into_its_height_at_0_8_mps2(
    rise_m: float, speed_mps: float, seconds: float
) -> None:
    assert eased_rise_s(rise_m, speed_mps) == pytest.approx(seconds)


class TestStop:
    def stopped(self, velocity_mps: tuple[float, float, float], reaction_s: float) -> list[Row]:
        writer = TrajectoryWriter(10.0, 20.0, 40.0, 45.0)
        stop(writer, velocity_mps, SETTINGS, reaction_s=reaction_s)
        assert {row[PART] for row in writer.rows} == {FlightPart.STOPPING}
        return writer.rows

    def test_it_goes_on_for_the_reaction_and_brakes(self) -> None:
        """5 m/s and 2 m/s up: 10 m and 4 m in 2 s; then 5 m in 2 s, and 1 m up."""
        reacts, brakes = self.stopped((3.0, 4.0, 2.0), 2.0)
        assert end_of(reacts) == pytest.approx((2.0, 16.0, 28.0, 45.0, 50.0))
        assert end_of(brakes) == pytest.approx((4.0, 19.0, 32.0, 45.0, 50.0))
        assert speeds_mps(reacts) == pytest.approx((5.0, 5.0))
        assert speeds_mps(brakes) == pytest.approx((5.0, 0.0), abs=1e-9)

    @pytest.mark.parametrize(("up_mps", "rise_m"), [(2.0, 5.0), (-2.0, -5.0), (-4.0, -12.0)])
    def test_one_that_only_climbs_or_sinks_does_so_where_it_is(
        self, up_mps: float, rise_m: float
    ) -> None:
        (row,) = self.stopped((0.0, 0.0, up_mps), 2.0)
        assert end_of(row) == pytest.approx((2.0, 10.0, 20.0, 40.0 + rise_m, 45.0 + rise_m))

    @pytest.mark.parametrize(("speed_mps", "moves"), [(0.09, False), (0.1, True)])
    def test_from_0_1_mps_on_it_has_a_way_to_stop(self, speed_mps: float, moves: bool) -> None:
        assert (self.stopped((speed_mps, 0.0, 0.0), 1.0)[-1][EAST_1] > 10.0) is moves

    def test_without_a_reaction_it_brakes_at_once(self) -> None:
        (row,) = self.stopped((3.0, 4.0, 0.0), 0.0)
        assert end_of(row) == pytest.approx((2.0, 13.0, 24.0, 40.0, 45.0))

    def test_the_stopping_distance_is_the_way_of_both(self) -> None:
        late = replace(SETTINGS, reaction_s=0.5)
        assert stopping_distance_m(10.0, late) == pytest.approx(5.0 + 20.0)


@pytest.mark.parametrize("turned", [0.0, 1.0, 4.0])
@pytest.mark.parametrize(
    ("angle_deg", "back_m", "on_m", "radius_m", "bulge_m"),
    [
        (90.0, 100.0, 40.0, 20.0, 10.0),
        (90.0, 100.0, 40.0, 80.0, 20.0),
        (90.0, 40.0, 100.0, 80.0, 20.0),
        (60.0, 100.0, 90.0, 10.0, 7.5),  # an arc of 10 m leaves the legs at 17.3 m
        (120.0, 100.0, 90.0, 10.0, 5.0 * sqrt(0.75)),
        (120.0, 4.0, 90.0, 10.0, 2.0 * sqrt(0.75)),
        (180.0, 100.0, 100.0, 50.0, 0.0),
        (0.0, 100.0, 100.0, 50.0, 0.0),
        (90.0, 0.0, 100.0, 50.0, 0.0),
        (90.0, 100.0, 0.0, 50.0, 0.0),
        (90.0, 100.0, 40.0, 1_000.0, 20.0),
    ],
)
def test_a_rounded_corner_may_leave_its_legs_by_half_its_reach(
    angle_deg: float, back_m: float, on_m: float, radius_m: float, bulge_m: float, turned: float
) -> None:
    """Wherever the corner is, whichever path it points, left or right."""
    corner = 70.0, -30.0
    for after in (turned + angle_deg * pi / 180.0, turned - angle_deg * pi / 180.0):
        before_m = corner[0] + back_m * cos(turned), corner[1] + back_m * sin(turned)
        after_m = corner[0] + on_m * cos(after), corner[1] + on_m * sin(after)
        found_m = corner_bulge_m(before_m, corner, after_m, radius_m)
        assert found_m == pytest.approx(bulge_m, abs=1e-9)
