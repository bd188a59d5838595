"""Missions repaired to what DJI accepts: reported, within bounds, idempotent."""

from dataclasses import replace
from itertools import pairwise
from math import hypot, inf, nan

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.safety.cases import TAKEOFF, command, situation, vehicle

from recon.geo.distance import moved_m, offset_north_east_m
from recon.model.command import FlyMission
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.vehicle import VehicleProfile
from recon.safety.rules.dji_limits import dji_limits
from recon.safety.rules.finite_numbers import finite_numbers
from recon.vehicles.mission_repair import REPAIR_LIMITS, Repaired, joined, repair

Place = tuple[float, float, float]
FloatArray = npt.NDArray[np.float64]
ORIGIN = LatLon(42.0, -93.6)
LARGEST_MOVE_M = 1.0
"""Stated in the room's own words: a waypoint is merged into one less than 1 m away."""


def at(north_m: float, east_m: float = 0.0, height_m: float = 40.0, **changes: object) -> Waypoint:
    place = moved_m(ORIGIN, north_m, east_m)
    point = Waypoint(place.latitude_deg, place.longitude_deg, height_m, 5.0)
    return replace(point, **changes)  # type: ignore[arg-type]


def row(*norths_m: float, **changes: object) -> tuple[Waypoint, ...]:
    return tuple(at(north_m, **changes) for north_m in norths_m)


def repaired(
    *waypoints: Waypoint, most: int = 99, curved: bool = False, lands: bool = False
) -> Repaired:
    mission = Mission(waypoints, land_at_end=lands, curved=curved, purpose="survey")
    return repair(mission, profile(most))


def profile(most: int = 99) -> VehicleProfile:
    return replace(TAKEOFF, max_waypoints=most)


def passes_dji_limits(mission: Mission, most: int = 99) -> bool:
    asked = situation(vehicle(profile(most)))
    return dji_limits(command(FlyMission(mission)), asked) is None


def metres(point: Waypoint) -> Place:
    place = LatLon(point.latitude_deg, point.longitude_deg)
    return (*offset_north_east_m(ORIGIN, place), point.height_above_takeoff_m)


class TestGoodMissions:
    def test_one_that_fits_is_left_as_it_is(self) -> None:
        mission = Mission(row(0.0, 50.0, 100.0), land_at_end=True, purpose="survey")
        result = repair(mission, profile())
        assert result == Repaired((mission,), ())
        assert result.parts[0] is mission

    @pytest.mark.parametrize(
        "waypoints",
        [
            row(0.0),
            (),
            row(0.0, nan),
            (at(0.0), at(50.0, speed_mps=nan)),
            (at(0.0), at(50.0, loiter_s=inf)),
            (at(0.0), at(50.0, height_m=501.0)),
            (at(0.0), at(50.0, speed_mps=-1.0)),
            (at(0.0), at(50.0, loiter_s=-1.0)),
            (at(0.0), replace(at(50.0), latitude_deg=91.0)),
            (at(0.0), replace(at(0.0), longitude_deg=86.4)),
            row(0.0, 0.3),
        ],
    )
    def test_what_cannot_be_repaired_stays_and_the_gate_refuses_it(
        self, waypoints: tuple[Waypoint, ...]
    ) -> None:
        mission = Mission(waypoints)
        assert repair(mission, profile()) == Repaired((mission,), ())
        asked, seen = command(FlyMission(mission)), situation(vehicle(profile()))
        assert finite_numbers(asked, seen) or dji_limits(asked, seen)

    def test_a_curved_mission_with_actions_stays(self) -> None:
        mission = Mission((at(0.0, loiter_s=1.0), at(50.0)), curved=True)
        assert repair(mission, profile()) == Repaired((mission,), ())


class TestRanges:
    def test_speeds_are_limited_and_reported_with_numbers(self) -> None:
        result = repaired(
            at(0.0, speed_mps=0.0), at(50.0, speed_mps=1e-60), at(90.0, speed_mps=22.0), at(130.0)
        )
        assert [w.speed_mps for w in result.parts[0].waypoints] == [1.0, 1.0, 15.0, 5.0]
        assert result.repairs[0].startswith("waypoints 1 and 2: speed 0 replaced by 1 m/s")
        assert result.repairs[1].startswith("waypoint 3: speed limited to 15 m/s")

    def test_a_long_stay_is_cut_and_a_gimbal_kept_in_its_range(self) -> None:
        result = repaired(at(0.0, loiter_s=60.0), at(50.0, gimbal_pitch_deg=30.0), at(90.0))
        first, second, _ = result.parts[0].waypoints
        assert (first.loiter_s, second.gimbal_pitch_deg) == (32.767, 0.0)
        assert "waypoint 1: loiter time limited to 32.767 s" in result.repairs[0]
        assert "waypoint 2: gimbal pitch" in result.repairs[1]


class TestSpacing:
    def test_a_near_waypoint_is_merged_and_its_actions_kept(self) -> None:
        result = repaired(
            at(0.0),
            at(50.0, loiter_s=2.0, speed_mps=3.0),
            at(50.4, gimbal_pitch_deg=-45.0, loiter_s=1.0, speed_mps=7.0),
            at(90.0),
        )
        _, merged, last = result.parts[0].waypoints
        assert metres(merged)[0] == pytest.approx(50.0)
        assert (merged.loiter_s, merged.gimbal_pitch_deg, merged.speed_mps) == (3.0, -45.0, 7.0)
        assert last == at(90.0)
        assert result.repairs == ("waypoint 3 is 0.40 m from waypoint 2 and was merged into it",)

    def test_lost_actions_are_reported(self) -> None:
        result = repaired(
            at(0.0, gimbal_pitch_deg=-90.0, loiter_s=30.0),
            at(0.5, gimbal_pitch_deg=-30.0, loiter_s=10.0),
            at(50.0),
        )
        assert "lost: gimbal pitch -90 deg of waypoint 1, 7.23 s" in result.repairs[0]

    def test_a_long_leg_gets_waypoints_of_its_own(self) -> None:
        result = repaired(at(0.0, speed_mps=9.0), at(100.0), at(3_100.0, 50.0, 60.0), at(0.0, 60.0))
        points = joined(result.parts).waypoints
        assert len(points) == 6
        assert points[2].height_above_takeoff_m == pytest.approx(50.0)
        assert points[2].speed_mps == points[1].speed_mps
        assert "waypoints 2 and 3 are 3.00 km apart: 1 inserted between them" in result.repairs

    def test_a_leg_over_the_date_line_is_divided_where_it_lies(self) -> None:
        points = (replace(at(0.0), longitude_deg=179.98), replace(at(0.0), longitude_deg=-179.98))
        inserted = joined(repair(Mission(points), profile()).parts).waypoints[1]
        assert abs(inserted.longitude_deg) == pytest.approx(180.0, abs=1e-6)


class TestCorners:
    def test_ends_are_sharp_and_the_rest_is_in_range(self) -> None:
        radii = (5.0, 0.0, 2_000.0, 5.0)
        points = [
            at(north_m, corner_radius_m=radius_m)
            for north_m, radius_m in zip((0.0, 40.0, 1_400.0, 1_500.0), radii, strict=True)
        ]
        result = repaired(*points, curved=True)
        fitted = [point.corner_radius_m for point in result.parts[0].waypoints]
        assert fitted[0] == fitted[3] == fitted[1] == 0.2
        assert fitted[2] == pytest.approx(99.8, abs=0.02)
        assert passes_dji_limits(result.parts[0])
        assert "waypoints 1 to 4: corner radius" in result.repairs[0]

    def test_two_corners_share_a_leg_that_is_too_short_for_both(self) -> None:
        radii = (0.2, 30.0, 10.0, 0.2)
        points = [
            at(north_m, corner_radius_m=radius_m)
            for north_m, radius_m in zip((0.0, 60.0, 80.0, 140.0), radii, strict=True)
        ]
        fitted = repaired(*points, curved=True).parts[0].waypoints
        assert fitted[1].corner_radius_m == pytest.approx(15.0, abs=0.02)
        assert fitted[2].corner_radius_m == pytest.approx(5.0, abs=0.02)

    def test_a_straight_missions_radii_are_nobodys_matter(self) -> None:
        assert repaired(*row(0.0, 10.0, 20.0, corner_radius_m=50.0)).repairs == ()


class TestParts:
    def test_230_waypoints_are_three_parts_that_begin_where_the_one_before_ended(self) -> None:
        points = row(*(2.0 * number for number in range(230)))
        result = repaired(*points, lands=True)
        assert [len(part.waypoints) for part in result.parts] == [99, 99, 34]
        assert [part.land_at_end for part in result.parts] == [False, False, True]
        for before, after in pairwise(result.parts):
            assert before.waypoints[-1] == after.waypoints[0]
        assert joined(result.parts).waypoints == points
        assert result.repairs == (
            "flown in 3 parts (waypoints 1 to 99, 99 to 197, 197 to 230): 230 waypoints "
            "exceed the 99 that its app accepts; it hovers at the end of each part, and continues "
            "only if link and authority were uninterrupted since the order",
        )

    def test_an_app_that_takes_fewer_gets_smaller_parts(self) -> None:
        result = repaired(*row(*range(0, 1_000, 10)), most=25)
        assert all(len(part.waypoints) <= 25 for part in result.parts)
        assert len(result.parts) == 5

    def test_a_round_trip_is_two_parts(self) -> None:
        result = repaired(at(0.0), at(50.0), at(50.0, 50.0), at(0.0, 50.0), at(0.2))
        assert [len(part.waypoints) for part in result.parts] == [4, 2]
        assert "it ends 0.20 m from where it begins" in result.repairs[0]

    def test_a_path_too_long_for_one_is_two_parts(self) -> None:
        legs = [at(1_500.0 * (number % 2), 10.0 * number) for number in range(25)]
        result = repaired(*legs)
        assert len(result.parts) == 2
        assert "its path is 36.0 km" in result.repairs[0]

    def test_the_actions_at_the_shared_waypoint_are_done_once(self) -> None:
        points = row(*range(0, 1_000, 10), loiter_s=2.0, gimbal_pitch_deg=-60.0)
        first, second = repaired(*points).parts
        assert (first.waypoints[-1].loiter_s, first.waypoints[-1].gimbal_pitch_deg) == (2.0, -60.0)
        assert (second.waypoints[0].loiter_s, second.waypoints[0].gimbal_pitch_deg) == (None, None)
        assert joined((first, second)).waypoints == points

    def test_a_flight_around_the_world_is_not_cut_up(self) -> None:
        points = tuple(replace(at(0.0), longitude_deg=10.0 * n) for n in range(18))
        assert repaired(*points).repairs == ()


# --- random missions ---------------------------------------------------------------------------

SPANS = st.one_of(
    st.floats(0.0, 3.0), st.floats(-60.0, 60.0), st.floats(-60.0, 60.0), st.floats(-6_000, 6_000)
)


@st.composite
def missions(draw: st.DrawFn) -> Mission:
    """Missions with typical mistakes: near and far, slow and fast."""
    count = draw(st.integers(2, 40))
    curved = draw(st.booleans())
    north_m = east_m = 0.0
    points = []
    for _ in range(count):
        north_m += draw(SPANS)
        east_m += draw(SPANS)
        points.append(
            at(
                north_m,
                east_m,
                draw(st.floats(-200.0, 500.0)),
                speed_mps=draw(st.floats(0.0, 40.0)),
                corner_radius_m=draw(st.floats(0.0, 1_500.0)),
                loiter_s=None if curved else draw(st.none() | st.floats(0.0, 100.0)),
                gimbal_pitch_deg=None if curved else draw(st.none() | st.floats(-180.0, 90.0)),
            )
        )
    return Mission(tuple(points), draw(st.booleans()), curved, "random")


MISSIONS = missions()
COUNTS = st.sampled_from([2, 3, 7, 25, 99])


@settings(max_examples=examples(300), deadline=None)
@given(MISSIONS, COUNTS)
def test_what_is_repaired_passes_dji_limits(mission: Mission, most: int) -> None:
    result = repair(mission, profile(most))
    if result.repairs:
        assert all(passes_dji_limits(part, most) for part in result.parts)
    else:
        assert result.parts == (mission,)


@settings(max_examples=examples(300), deadline=None)
@given(MISSIONS, COUNTS)
def test_repairing_again_changes_nothing(mission: Mission, most: int) -> None:
    for part in repair(mission, profile(most)).parts:
        assert repair(part, profile(most)) == Repaired((part,), ())


@settings(max_examples=examples(300), deadline=None)
@given(MISSIONS)
def test_a_mission_that_passes_needs_no_repair_but_for_the_margins(mission: Mission) -> None:
    points = mission.waypoints
    legs_m = [
        hypot(*(b - a for a, b in zip(metres(p), metres(q), strict=True)))
        for p, q in (*pairwise(points), (points[0], points[-1]))
    ]
    radii_m = [p.corner_radius_m + q.corner_radius_m for p, q in pairwise(points)]
    is_tight = min(legs_m) < 1.01 or max(legs_m) > 1_990.0 or sum(legs_m[:-1]) > 29_800.0
    has_tight_corners = mission.curved and any(
        radius_m > leg_m - 0.2 for radius_m, leg_m in zip(radii_m, legs_m, strict=False)
    )
    if not is_tight and not has_tight_corners and passes_dji_limits(mission):
        assert repair(mission, profile()) == Repaired((mission,), ())


@settings(max_examples=examples(300), deadline=None)
@given(MISSIONS, COUNTS)
def test_the_path_stays_where_it_was_ordered(mission: Mission, most: int) -> None:
    """Each ordered waypoint is within 1 m of the repaired path, and each repaired one within 1 m,
    or 0.1 % of the leg it divides, of the ordered path."""
    flown = joined(repair(mission, profile(most)).parts).waypoints
    ordered = [metres(point) for point in mission.waypoints]
    after = [metres(point) for point in flown]
    assert _to_path_m(ordered, after).max() < LARGEST_MOVE_M + 0.01
    longest_m = max(hypot(*np.subtract(b, a)) for a, b in pairwise(ordered))
    assert _to_path_m(after, ordered).max() < LARGEST_MOVE_M + 0.001 * longest_m
    assert flown[0].latitude_deg == mission.waypoints[0].latitude_deg


@settings(max_examples=examples(300), deadline=None)
@given(MISSIONS, COUNTS)
def test_waypoints_that_stay_are_the_ordered_ones_to_the_bit(mission: Mission, most: int) -> None:
    result = repair(mission, profile(most))
    ordered = {
        (p.latitude_deg, p.longitude_deg, p.height_above_takeoff_m) for p in mission.waypoints
    }
    flown = joined(result.parts).waypoints
    kept = [
        p for p in flown if (p.latitude_deg, p.longitude_deg, p.height_above_takeoff_m) in ordered
    ]
    reported_new = sum(
        int(text.split(": ")[1].split()[0]) for text in result.repairs if "apart" in text
    )
    assert len(flown) - len(kept) == reported_new


@settings(max_examples=examples(200), deadline=None)
@given(MISSIONS, COUNTS)
def test_every_change_is_said(mission: Mission, most: int) -> None:
    result = repair(mission, profile(most))
    assert bool(result.repairs) == (result.parts != (mission,))
    assert [part.land_at_end for part in result.parts[:-1]] == [False] * (len(result.parts) - 1)
    assert result.parts[-1].land_at_end is mission.land_at_end
    assert {part.curved for part in result.parts} == {mission.curved}


@settings(max_examples=examples(200), deadline=None)
@given(
    st.lists(
        st.builds(
            Waypoint,
            *[st.floats(allow_nan=True, allow_infinity=True)] * 5,
            loiter_s=st.none() | st.floats(),
            gimbal_pitch_deg=st.none() | st.floats(),
        ),
        max_size=6,
    ),
    st.booleans(),
)
def test_nonsense_is_left_to_the_gate(points: list[Waypoint], curved: bool) -> None:
    mission = Mission(tuple(points), curved=curved)
    result = repair(mission, profile())
    assert result.parts == (mission,) or all(passes_dji_limits(part) for part in result.parts)


def _to_path_m(points: list[Place], path: list[Place]) -> FloatArray:
    """Each point's distance to a polyline: where it stands square on a leg, or to its ends."""
    here, line = np.array(points)[:, np.newaxis], np.array(path)
    along = np.diff(line, axis=0)
    squares = np.maximum((along**2).sum(axis=1), 1e-18)
    share = np.clip(((here - line[:-1]) * along).sum(axis=2) / squares, 0.0, 1.0)
    apart_m = np.linalg.norm(here - (line[:-1] + share[..., np.newaxis] * along), axis=2)
    nearest_m: FloatArray = apart_m.min(axis=1)
    return nearest_m


def test_the_repairs_limits_are_within_the_gates() -> None:
    gate = situation().settings
    assert REPAIR_LIMITS.least_leg_m >= gate.min_leg_m
    assert REPAIR_LIMITS.max_leg_m <= gate.max_leg_m
    assert REPAIR_LIMITS.max_path_m <= gate.max_path_m
    assert REPAIR_LIMITS.max_speed_mps <= gate.max_speed_mps
    assert REPAIR_LIMITS.max_loiter_s <= gate.max_loiter_s
