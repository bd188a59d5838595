"""Plans of fleet returns: heights, zones, turns, waves; and whole returns flown in 10 Hz steps."""

from dataclasses import replace
from itertools import pairwise
from math import hypot

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from tests.examples import examples
from tests.guidance.returning_fleet import fly
from tests.guidance.returning_scenes import (
    FRAME,
    HIGH_GROUND_M,
    KEPT,
    LEAST,
    LOW_GROUND_M,
    SETTINGS,
    Scene,
    box,
    drawn_scene,
    keep_out,
    row_of_pads,
    scene_of,
)

from recon.geo import enu_from_geo
from recon.guidance.fleet_return import (
    CalledVehicle,
    Pad,
    ReturnFlight,
    ReturnPlan,
    Separation,
    mission_of,
    plan_return,
)
from recon.guidance.fleet_return.turn import hindrance
from recon.model.airspace import HeightDatum, Region, Zone, ZoneKind

CEILINGS_M = st.sampled_from([30.0, 45.0, 60.0, 120.0])


def scenes(most: int = 40) -> st.SearchStrategy[Scene]:
    return st.builds(
        drawn_scene,
        st.integers(0, 10**9),
        st.integers(2, most),
        st.integers(1, 20),
        CEILINGS_M,
        st.integers(0, 4),
        is_fenced=st.booleans(),
        hovers_apart=st.booleans(),
    )


def hovering_row(count: int, pads: list[Pad], up_m: float = 30.0) -> list[CalledVehicle]:
    """Vehicles side by side 200 m north of their pads, the first with the lowest battery."""
    return [
        CalledVehicle(
            f"S-{i + 1}",
            f"Drone {i + 1}",
            (40.0 * i, 200.0, up_m),
            0.0,
            pads[i % len(pads)],
            0.15 + 0.1 * i,
        )
        for i in range(count)
    ]


@pytest.mark.parametrize("gap_m", [6.5, 7.8])
def test_two_that_hover_too_near_one_above_the_other_part(gap_m: float) -> None:
    pads = row_of_pads(2, 30.0)
    low, high = hovering_row(2, pads, 60.0)
    high = replace(high, place_m=(*low.place_m[:2], low.place_m[2] + gap_m), battery_fraction=0.1)
    plan = scene_of([high, low]).plan()
    assert [flight.serial for flight in plan.flights] == [low.serial, high.serial]
    first, second = plan.flights
    assert first.layer_up_m <= low.place_m[2] - KEPT.vertical_m
    assert hindrance(second, [], [], [low.hovering], KEPT) is not None
    assert hindrance(first, [], [], [high.hovering], KEPT) is None


@settings(max_examples=examples(200), deadline=None)
@given(scene=scenes())
@example(scene=drawn_scene(671, 2, 1, 30.0, 4, is_fenced=False, hovers_apart=False))
@example(scene=drawn_scene(8840, 18, 17, 45.0, 1))  # begins 0.27 m from a corner of its detour
def test_plans_of_drawn_scenes(scene: Scene) -> None:
    """One plan per scene, as planning takes most of the time; the checks follow below."""
    plan = scene.plan()
    check_every_vehicle_is_planned_or_left_out_with_a_reason(scene, plan)
    check_layers_are_10_m_apart_between_ground_zones_and_ceiling(scene, plan)
    check_no_flight_enters_a_keep_out_zone_or_leaves_the_site(scene, plan)
    check_the_lowest_battery_goes_first_then_the_nearest(scene, plan)
    check_every_flight_is_a_mission_that_dji_accepts(plan)


def check_every_vehicle_is_planned_or_left_out_with_a_reason(
    scene: Scene, plan: ReturnPlan
) -> None:
    named = [f.serial for f in plan.flights] + [left.serial for left in plan.excluded]
    assert sorted(named) == sorted(v.serial for v in scene.vehicles)
    assert all(len(left.reason) > 20 for left in plan.excluded)


def check_layers_are_10_m_apart_between_ground_zones_and_ceiling(
    scene: Scene, plan: ReturnPlan
) -> None:
    limits = scene.airspace.limits
    assert all(b - a == pytest.approx(10.0) for a, b in pairwise(plan.layers_up_m))
    for wave in plan.waves:
        heights = [flight.layer_up_m for flight in wave]
        assert len(set(heights)) == len(heights)
    for flight in plan.flights:
        assert flight.layer_up_m in plan.layers_up_m
        assert flight.layer_up_m >= HIGH_GROUND_M + limits.min_height_above_ground_m
        assert flight.layer_up_m < LOW_GROUND_M + limits.max_height_above_ground_m


def check_no_flight_enters_a_keep_out_zone_or_leaves_the_site(
    scene: Scene, plan: ReturnPlan
) -> None:
    """Sampled each half metre, with a box's own arithmetic instead of the planner's geometry."""
    margin_m = scene.airspace.limits.boundary_margin_m
    for flight in plan.flights:
        places_m = sampled(flight)
        for zone in scene.airspace.zones:
            low, high = zone.region.outline_m[[0, 2]]
            top_m = np.inf if zone.ceiling_m is None else zone.ceiling_m + HIGH_GROUND_M
            is_beside = box_distance_m(places_m[:, :2], low, high) >= margin_m
            assert (is_beside | (places_m[:, 2] > top_m)).all(), (flight.name, zone.name)
        if scene.airspace.boundary is not None:
            low, high = scene.airspace.boundary.outline_m[[0, 2]]
            assert (low + margin_m <= places_m[:, :2]).all()
            assert (high - margin_m >= places_m[:, :2]).all()


def check_the_lowest_battery_goes_first_then_the_nearest(scene: Scene, plan: ReturnPlan) -> None:
    """Where nothing is in the way, turn and height follow battery and distance alone."""
    batteries = [scene.vehicle(f.name).battery_fraction or 0.0 for f in plan.flights]
    if scene.airspace.zones or plan.excluded or not _is_spread(scene):
        return
    tenths = [int(battery * 10.0) for battery in batteries]
    assert tenths == sorted(tenths)
    for wave in plan.waves:
        heights = [flight.layer_up_m for flight in wave]
        assert heights == sorted(heights)


def check_every_flight_is_a_mission_that_dji_accepts(plan: ReturnPlan) -> None:
    for flight in plan.flights:
        mission = mission_of(flight, FRAME, flight.start_m, SETTINGS, 15.0)
        places = [
            (w.latitude_deg, w.longitude_deg, w.height_above_takeoff_m) for w in mission.waypoints
        ]
        latitude, longitude, height = np.array(places).T
        enu = enu_from_geo(FRAME, latitude, longitude, 275.0)
        enu[:, 2] = height + flight.takeoff_up_m
        legs_m = np.linalg.norm(np.diff(enu, axis=0), axis=1)
        assert mission.land_at_end
        assert 2 <= len(places) <= 99
        assert legs_m.min() >= 0.5
        assert np.linalg.norm(enu[-1] - enu[0]) >= 0.5
        assert np.hypot(*(enu[0] - flight.start_m)[:2]) < 0.05
        assert np.hypot(*(enu[-1, :2] - flight.pad.east_north_m)) < 0.05
        assert np.abs(enu[:-1, 2] - flight.layer_up_m).max() < 0.01


class TestFlown:
    @settings(max_examples=examples(15), deadline=None)
    @given(
        seed=st.integers(0, 10**9),
        count=st.integers(2, 20),
        pads=st.integers(1, 10),
        ceiling_m=CEILINGS_M,
        zone_count=st.integers(0, 3),
    )
    @pytest.mark.flight
    def test_every_planned_vehicle_lands_and_none_comes_too_near(
        self, seed: int, count: int, pads: int, ceiling_m: float, zone_count: int
    ) -> None:
        scene = drawn_scene(seed, count, pads, ceiling_m, zone_count)
        plan = scene.plan()
        others = {left.name: scene.vehicle(left.name).place_m for left in plan.excluded}
        flown = fly(plan, others, KEPT, LEAST, SETTINGS, seed)
        landed = {name for name, flier in flown.fliers.items() if flier.is_on_ground}
        assert landed == {flight.name for flight in plan.flights}
        assert flown.nearest_m >= LEAST.horizontal_m, flown.nearest_pair
        assert flown.most_at_a_pad <= 1
        assert flown.most_at_once <= max(1, len(plan.layers_up_m))

    def test_with_a_pad_each_a_whole_wave_is_in_the_air_at_once(self) -> None:
        """One after the other would take four times as long."""
        plan = scene_of(hovering_row(5, row_of_pads(5, 40.0)), ceiling_m=70.0).plan()
        flown = fly(plan, {}, KEPT, LEAST, SETTINGS, seed=1)
        assert len(plan.waves) == 1
        assert flown.most_at_once == 5
        assert flown.nearest_m >= LEAST.horizontal_m

    def test_layers_of_flights_under_way_are_left_to_them_while_others_are_free(self) -> None:
        scene = scene_of(hovering_row(2, row_of_pads(2, 40.0)), ceiling_m=50.0)
        lowest_m, second_m, third_m = scene.plan().layers_up_m

        def layers_m(*occupied_m: float) -> list[float]:
            plan = plan_return(
                scene.vehicles, scene.home, KEPT, SETTINGS, (), 2, occupied_m=occupied_m
            )
            assert plan.excluded == ()
            return [flight.layer_up_m for flight in plan.flights]

        assert layers_m() == [lowest_m, second_m]
        assert layers_m(lowest_m + 0.5) == [second_m, third_m]
        assert layers_m(lowest_m, second_m, third_m) == [lowest_m, second_m]

    def test_all_at_one_height_would_come_too_near(self) -> None:
        """The control: the same paths without layers, begun together, and the checker sees it."""
        vehicles = hovering_row(5, list(reversed(row_of_pads(5, 40.0))))
        plan = scene_of(vehicles, ceiling_m=70.0).plan()
        lowest_m = plan.layers_up_m[0]
        level = tuple(
            replace(flight, layer_up_m=lowest_m + 1e-6 * number)
            for number, flight in enumerate(plan.flights)
        )
        unchecked = Separation(0.0, 0.0)
        flown = fly(ReturnPlan((lowest_m,), level, ()), {}, unchecked, LEAST, SETTINGS, seed=1)
        assert flown.most_at_once == 5
        assert flown.nearest_m < LEAST.horizontal_m


class TestWays:
    def test_a_zone_with_a_top_is_flown_over(self) -> None:
        zone = keep_out("barn", box(0.0, 100.0, 20.0), ceiling_m=30.0)
        plan = scene_of([lone(0.0, 200.0)], zones=(zone,)).plan()
        assert plan.layers_up_m[0] == pytest.approx(30.0 + HIGH_GROUND_M + 6.0)
        assert len(plan.flights[0].path_m) == 2

    def test_a_zone_without_a_top_is_flown_around(self) -> None:
        zone = keep_out("road", box(0.0, 100.0, 20.0))
        (flight,) = scene_of([lone(0.0, 200.0)], zones=(zone,)).plan().flights
        length_m = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(flight.path_m))
        assert len(flight.path_m) > 2
        assert 240.0 < length_m < 265.0

    def test_a_zone_far_from_every_way_raises_no_layer(self) -> None:
        zone = keep_out("mast", box(3_000.0, 0.0, 20.0), ceiling_m=100.0)
        plan = scene_of([lone(0.0, 200.0)], zones=(zone,)).plan()
        assert plan.layers_up_m[0] == pytest.approx(HIGH_GROUND_M + 20.0)

    def test_a_zone_outside_the_hull_is_kept_clear_of_by_a_detour(self) -> None:
        """The short path around the road leads out of the hull, across the barn's corner."""
        road = keep_out("road", box(30.0, 100.0, 40.0))
        barn = keep_out("barn", box(-60.0, 60.0, 43.0))
        scene = scene_of([lone(0.0, 200.0)], zones=(road, barn))
        plan = scene.plan()
        assert len(plan.flights) == 1
        check_no_flight_enters_a_keep_out_zone_or_leaves_the_site(scene, plan)

    def test_a_least_height_raises_the_lowest_layer(self) -> None:
        over = box(0.0, 100.0, 30.0)
        high = Zone("village", ZoneKind.HEIGHT, over, 325.0, None, HeightDatum.WGS84)
        assert scene_of([lone(0.0, 200.0)], zones=(high,)).plan().layers_up_m[0] == pytest.approx(
            325.0 - 275.0 + 1.0
        )

    def test_a_zones_own_ceiling_is_flown_around_by_those_above_it(self) -> None:
        over = box(0.0, 100.0, 20.0)
        zone = Zone("under wires", ZoneKind.HEIGHT, over, None, 30.0, HeightDatum.GROUND)
        vehicles = [lone(0.0, 200.0), lone(3.0, 260.0, "B")]
        vehicles[1] = CalledVehicle(
            "B", "B", (3.0, 260.0, 40.0), 0.0, Pad("q", 40.0, -40.0, 0.0), 0.9
        )
        low, high = scene_of(vehicles, zones=(zone,)).plan().flights
        assert (low.layer_up_m, len(low.path_m)) == (pytest.approx(23.0), 2)
        assert high.layer_up_m == pytest.approx(33.0)
        assert len(high.path_m) > 2

    def test_a_wall_from_fence_to_fence_leaves_no_way(self) -> None:
        across = np.array([(-500.0, 90.0), (500.0, 90.0), (500.0, 110.0), (-500.0, 110.0)])
        wall = keep_out("wall", Region(across))
        scene = scene_of([lone(0.0, 200.0)], zones=(wall,), boundary=box(0.0, 100.0, 420.0))
        (left,) = scene.plan().excluded
        assert "no path to its pad" in left.reason

    def test_a_pad_in_a_zone_and_a_vehicle_over_one_have_different_reasons(self) -> None:
        zone = keep_out("house", box(0.0, 200.0, 20.0))
        over = scene_of([lone(0.0, 200.0)], zones=(zone,)).plan().excluded
        assert "it is over the keep-out zone house" in over[0].reason
        pad = Pad("p", 0.0, 200.0, 0.0)
        inside = CalledVehicle("A", "A", (0.0, 0.0, 30.0), 0.0, pad, 0.5)
        (left,) = scene_of([inside], zones=(zone,)).plan().excluded
        assert "its pad p is in the keep-out zone house" in left.reason

    def test_a_pad_outside_the_fence_is_left_out_with_the_reason(self) -> None:
        vehicle = CalledVehicle("A", "A", (0.0, 100.0, 30.0), 0.0, Pad("p", 0.0, -600.0, 0.0), 0.5)
        (left,) = scene_of([vehicle], boundary=box(0.0, 100.0, 420.0)).plan().excluded
        assert "its pad p is outside the site" in left.reason

    def test_a_vehicle_outside_the_fence_is_left_out_with_the_reason(self) -> None:
        (left,) = scene_of([lone(0.0, 900.0)], boundary=box(0.0, 100.0, 420.0)).plan().excluded
        assert left.reason.startswith("it is outside the site")

    def test_no_room_under_the_ceiling_is_the_reason(self) -> None:
        (left,) = scene_of([lone(0.0, 200.0)], ceiling_m=20.0).plan().excluded
        assert "above the ceiling" in left.reason

    def test_two_that_hover_too_near_are_both_left_to_their_pilots(self) -> None:
        near = CalledVehicle("B", "B", (5.0, 200.0, 32.0), 0.0, Pad("q", 60.0, -40.0, 0.0), 0.9)
        plan = scene_of([lone(0.0, 200.0), near]).plan()
        assert [left.name for left in plan.excluded] == ["A", "B"]
        assert "B hovers where it would climb, sink or land" in plan.excluded[0].reason

    def test_one_above_the_other_the_lower_goes_first(self) -> None:
        """The upper would have to sink through the lower one, whatever their batteries say."""
        low = CalledVehicle("L", "L", (0.0, 200.0, 15.0), 0.0, Pad("p", 0.0, -40.0, 0.0), 0.9)
        high = CalledVehicle("H", "H", (0.0, 200.0, 90.0), 0.0, Pad("q", 60.0, -40.0, 0.0), 0.2)
        names = [flight.name for flight in scene_of([low, high], ceiling_m=40.0).plan().flights]
        assert sorted(names) == ["H", "L"]
        flown = fly(scene_of([low, high], ceiling_m=40.0).plan(), {}, KEPT, LEAST, SETTINGS, seed=3)
        assert all(flier.is_on_ground for flier in flown.fliers.values())
        assert flown.nearest_m >= LEAST.horizontal_m


def lone(east_m: float, north_m: float, name: str = "A") -> CalledVehicle:
    return CalledVehicle(name, name, (east_m, north_m, 30.0), 0.0, Pad("p", 0.0, -40.0, 0.0), 0.5)


def sampled(flight: ReturnFlight) -> np.ndarray:
    corners = [
        flight.start_m,
        *((east_m, north_m, flight.layer_up_m) for east_m, north_m in flight.path_m),
        (*flight.pad.east_north_m, flight.pad.up_m),
    ]
    return np.concatenate(
        [
            np.linspace(a, b, max(2, int(np.linalg.norm(np.subtract(b, a)) / 0.5)))
            for a, b in pairwise(corners)
        ]
    )


def box_distance_m(places_m: np.ndarray, low_m: np.ndarray, high_m: np.ndarray) -> np.ndarray:
    beside = np.maximum(np.maximum(low_m - places_m, places_m - high_m), 0.0)
    return np.hypot(*beside.T)


def _is_spread(scene: Scene) -> bool:
    """Whether no vehicle hovers near another one's column, or near any pad."""
    spots = [v.place_m[:2] for v in scene.vehicles] + [v.pad.east_north_m for v in scene.vehicles]
    return all(
        hypot(v.place_m[0] - east_m, v.place_m[1] - north_m) >= KEPT.horizontal_m
        for v in scene.vehicles
        for east_m, north_m in spots
        if (east_m, north_m) != v.place_m[:2]
    )
