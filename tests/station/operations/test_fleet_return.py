"""Fleets recalled with the real station and simulated apps, in virtual time.

Distances and places are the simulator's own truth, not what the station believes.
"""

from math import hypot
from random import Random

import pytest
from tests.examples import IS_THOROUGH
from tests.flown_once import flown_once
from tests.station.returning_world import LEAST_LEVEL_M, ReturningWorld, returning_world
from tests.station.station_world import square_mission

from recon.model.command import FlyMission, Hover, LandNow, Phase, ReturnHome
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken, OperatorOrder, SeparationHoldSwitched
from recon.model.units import NS_PER_S
from recon.station.api_views.operation_views import operation_fields
from recon.station.state.fleet_return_record import Stage

FIELD = [(-60, 70, 30), (0, 80, 38), (60, 70, 30), (-80, 140, 34), (0, 160, 30), (80, 140, 34)]
"""Six that hover over a field, east, north, up."""

CROSSED = [(45, -20), (-15, -20), (-45, -20), (75, -20), (15, -20), (-75, -20)]
"""Their pads in a row, each on the other side of it: their paths cross."""

SIX = [f"SIM-{number}" for number in range(1, 7)]
LOW_CEILING_M = 43.0
"""Room for three layers: 20, 30 and 40 m."""


def six_in_the_air(pads: list[tuple[int, int]] = CROSSED, **options: object) -> ReturningWorld:
    return returning_world(FIELD, pads, max_height_m=LOW_CEILING_M, **options)  # type: ignore[arg-type]


FOUR = SIX[:4]


@flown_once
def four_in_the_air() -> ReturningWorld:
    """The first four with room for two layers, 20 and 30 m; a fifth hovers and is not called."""
    return returning_world(FIELD[:5], CROSSED[:5], max_height_m=33.0)


@flown_once
def first_wave() -> ReturningWorld:
    """All four are called: SIM-1 and SIM-2 fly home, SIM-3 and SIM-4 wait."""
    world = four_in_the_air()
    world.call(*FOUR)
    world.runs(8.0)
    assert [world.member(serial).stage for serial in FOUR] == [Stage.FLYING] * 2 + [
        Stage.WAITING
    ] * 2
    return world


@flown_once
def first_wave_descends() -> ReturningWorld:
    """The same a little later: SIM-3 and SIM-4 wait for some seconds more."""
    world = first_wave()
    world.runs(24.0)
    assert [world.member(serial).stage for serial in FOUR[2:]] == [Stage.WAITING] * 2
    return world


@flown_once
def two_left_out() -> ReturningWorld:
    """All four are called; the app of SIM-3 refuses its mission, that of SIM-4 ignores it."""
    world = first_wave_descends()
    world.world.fails("negative-ack:SIM-3:0:30")
    world.world.fails("ack-then-nothing:SIM-4:0:900")
    assert world.runs_until_over(900.0)
    return world


def landed_on_its_pad(world: ReturningWorld, serial: str) -> bool:
    east_m, north_m, _ = world.place_m(serial)
    pad = world.pads_m[serial]
    return not world.flies(serial) and hypot(east_m - pad[0], north_m - pad[1]) < 3.0


@pytest.fixture(scope="module")
def flown() -> ReturningWorld:
    world = six_in_the_air()
    world.call(*SIX)
    assert world.runs_until_over(900.0)
    return world


@pytest.mark.flight
class TestSixInTwoWaves:
    def test_all_land_on_their_pads(self, flown: ReturningWorld) -> None:
        assert set(flown.stages().values()) == {Stage.LANDED}
        assert all(landed_on_its_pad(flown, serial) for serial in SIX)

    def test_they_kept_apart(self, flown: ReturningWorld) -> None:
        assert flown.nearest.level_m >= LEAST_LEVEL_M, flown.nearest.who

    def test_a_low_ceiling_makes_two_waves_of_three_layers(self, flown: ReturningWorld) -> None:
        flights = [flown.member(serial).flight for serial in SIX]
        waves = {flight.wave for flight in flights if flight is not None}
        assert waves == {1, 2}
        for wave in waves:
            heights = sorted(f.layer_up_m for f in flights if f is not None and f.wave == wave)
            assert heights == pytest.approx([20.0, 30.0, 40.0])

    def test_each_flew_level_in_its_layer(self, flown: ReturningWorld) -> None:
        """Away from the place where it hovered and from its pad it is nowhere but there."""
        for serial, start in zip(SIX, FIELD, strict=True):
            flight, pad = flown.member(serial).flight, flown.pads_m[serial]
            assert flight is not None
            start_far_m = hypot(start[0] - pad[0], start[1] - pad[1])
            between = [
                up_m
                for _, up_m, far_m in flown.heights_m[serial]
                if 6.0 < far_m < start_far_m - 6.0
            ]
            assert len(between) > 50
            assert max(abs(up_m - flight.layer_up_m) for up_m in between) < 1.5

    def test_the_second_wave_waited_for_its_layers(self, flown: ReturningWorld) -> None:
        book = flown.world.driver.station.orders.records
        for serial in SIX:
            flight = flown.member(serial).flight
            assert flight is not None
            if flight.wave == 1:
                continue
            given_ns = book[flown.member(serial).mission_id or 0].command.issued_at_ns
            before = [
                member
                for member in map(flown.member, SIX)
                if member.flight is not None
                and member.flight.wave == 1
                and member.flight.layer_up_m == flight.layer_up_m
            ]
            assert [member.since_ns <= given_ns for member in before] == [True]

    def test_every_mission_passed_the_gate_in_the_callers_name(self, flown: ReturningWorld) -> None:
        for serial in SIX:
            member = flown.member(serial)
            record = flown.world.record(member.mission_id or 0)
            assert record.command.issued_by == "test: fleet return"
            assert Phase.REFUSED_BY_STATION not in [c.phase for c in record.history]
            assert (member.mission_id or 0) < 0

    def test_no_alarm_is_left(self, flown: ReturningWorld) -> None:
        assert flown.alarms() == set()


@pytest.mark.flight
def test_the_control_all_returning_at_one_height_come_too_near() -> None:
    """Why there are layers: the same fleet and pads, the return of the ICD, equal heights.

    With its holds on, the separation watchdog would stop them on the way: kept apart, but not home.
    """
    world = six_in_the_air(go_home_height_m=35.0)
    world.world.driver.handle(SeparationHoldSwitched(is_on=False, by="test"))
    for serial in SIX:
        world.world.order(serial, ReturnHome())
    while world.nearest.level_m >= LEAST_LEVEL_M:
        assert world.world.driver.now_ns < 120 * NS_PER_S
        world.runs(1.0)


@pytest.mark.flight
@pytest.mark.drawn
@pytest.mark.parametrize("seed", range(4) if IS_THOROUGH else range(1))
def test_drawn_fleets_land_by_the_real_gate_on_shared_pads(seed: int) -> None:
    rng = Random(seed)
    places: list[tuple[float, float, float]] = []
    while len(places) < (6 if IS_THOROUGH else 4):
        place = rng.uniform(-200, 200), rng.uniform(20, 250), rng.uniform(15, 100)
        if all(
            abs(place[2] - p[2]) >= 7.0 or hypot(place[0] - p[0], place[1] - p[1]) >= 18.0
            for p in places
        ):
            places.append(place)
    world = returning_world(
        places, [(-40 + 40 * (i % 3), -40) for i in range(len(places))], seed=seed
    )
    world.call(*world.pads_m)
    assert world.runs_until_over(900.0)
    assert set(world.stages().values()) == {Stage.LANDED}
    assert all(landed_on_its_pad(world, serial) for serial in world.pads_m)
    assert world.nearest.level_m >= LEAST_LEVEL_M, world.nearest.who


class TestInterruptions:
    def test_a_pilot_takes_one_and_the_others_continue(self) -> None:
        world = first_wave()
        (taken, *_) = [m.serial for m in map(world.member, FOUR) if m.stage is Stage.FLYING]
        world.world.driver.handle(AuthorityTaken(taken, AuthorityHolder.PILOT, "the pilot"))
        world.world.app(taken).aircraft.hover()
        assert world.runs_until_over(900.0)
        stages = world.stages()
        assert stages.pop(taken) is Stage.RELEASED
        assert world.flies(taken)
        landed = {serial for serial, stage in stages.items() if stage is Stage.LANDED}
        left = {serial for serial, stage in stages.items() if stage is Stage.EXCLUDED}
        assert len(landed) >= 2
        assert landed | left == set(stages)
        assert {("fleet_return", serial) for serial in left} <= world.alarms()
        assert world.nearest.level_m >= LEAST_LEVEL_M, world.nearest.who

    @pytest.mark.flight
    def test_by_the_order_of_a_person_whose_name_begins_as_the_station_does(self) -> None:
        world = returning_world([(0, 100, 30), (60, 100, 40)], [(0, -20), (0, -20)])
        world.call("SIM-1", "SIM-2")
        world.runs(10.0)
        (waiting,) = [m.serial for m in map(world.member, world.pads_m) if m.mission_id is None]
        label, person = "station-2 (10.0.0.9)", "station-2"
        hold = OperatorOrder(7, Hover(), label, serial=waiting, person=person)
        world.world.driver.handle(hold)
        world.runs(1.0)
        assert world.member(waiting).stage is Stage.RELEASED

    def test_all_stop_ends_it_for_all_that_are_held(self) -> None:
        world = first_wave()
        for serial in FOUR:
            world.world.order(serial, Hover())
        world.runs(20.0)
        assert set(world.stages().values()) == {Stage.RELEASED}
        assert all(world.flies(serial) for serial in FOUR)

    @pytest.mark.flight
    def test_of_those_that_wait_one_with_a_newer_order_or_a_broken_link_is_not_resumed(
        self,
    ) -> None:
        world = first_wave_descends()
        world.world.order("SIM-3", LandNow())
        world.world.fails("restart:SIM-4:0:5")
        assert world.runs_until_over(900.0)
        stages = world.stages()
        assert stages.pop("SIM-3") is Stage.RELEASED
        assert "replaced by land, ordered by test" in world.member("SIM-3").reason
        assert stages.pop("SIM-4") is Stage.EXCLUDED
        assert world.member("SIM-4").mission_id is None
        assert world.flies("SIM-4")
        assert ("fleet_return", "SIM-4") in world.alarms()
        assert set(stages.values()) == {Stage.LANDED}
        assert world.nearest.level_m >= LEAST_LEVEL_M, world.nearest.who

    @pytest.mark.flight
    def test_one_whose_app_ignores_its_mission_is_an_alarm_and_the_others_go_on(self) -> None:
        world = two_left_out()
        stages = world.stages()
        assert [stages.pop(serial) for serial in ("SIM-3", "SIM-4")] == [Stage.EXCLUDED] * 2
        assert ("fleet_return", "SIM-4") in world.alarms()
        assert set(stages.values()) == {Stage.LANDED}
        newest = list(world.world.driver.station.orders.records.values())
        holds = [r for r in newest if "was ignored" in r.command.issued_by]
        assert [(r.command.serial, r.command.body) for r in holds] == [("SIM-4", Hover())]

    @pytest.mark.flight
    def test_one_whose_link_breaks_in_flight_or_falls_silent_lands_without_further_orders(
        self,
    ) -> None:
        world = first_wave()
        world.world.fails("restart:SIM-1:1:5")
        world.world.fails("telemetry-dropout:SIM-2:1:4")
        given = world.member("SIM-1").mission_id
        assert world.runs_until_over(900.0)
        assert set(world.stages().values()) == {Stage.LANDED}
        assert landed_on_its_pad(world, "SIM-1")
        book = world.world.driver.station.orders.records.values()
        assert [r.command.id for r in book if r.command.serial == "SIM-1"][-1] == given
        assert world.nearest.level_m >= LEAST_LEVEL_M, world.nearest.who

    @pytest.mark.flight
    def test_one_left_out_stays_an_alarm_when_others_are_called(self) -> None:
        pads = [(0, -20), (0, -20), (60, -20)]
        world = returning_world(FIELD[:3], pads, faults=("restart:SIM-1:10:2",))
        world.call("SIM-1", "SIM-2")
        assert world.runs_until_over(300.0)
        assert world.member("SIM-1").stage is Stage.EXCLUDED
        world.call("SIM-3")
        world.runs(1.0)
        assert ("fleet_return", "SIM-1") in world.alarms()
        world.call("SIM-1")
        world.runs(1.0)
        assert ("fleet_return", "SIM-1") not in world.alarms()
        assert world.runs_until_over(300.0)
        assert landed_on_its_pad(world, "SIM-1")

    @pytest.mark.flight
    def test_the_hold_takes_a_vehicle_from_guidance(self) -> None:
        world = returning_world([(0, 100, 30)], [(0, 0)])
        world.world.driver.handle(AuthorityTaken("SIM-1", AuthorityHolder.GUIDANCE, "guidance"))
        world.call("SIM-1")
        assert world.runs_until_over(300.0)
        assert landed_on_its_pad(world, "SIM-1")

    @pytest.mark.flight
    def test_one_whose_app_refuses_is_reported_with_that(self) -> None:
        assert "refused by app" in two_left_out().member("SIM-3").reason

    @pytest.mark.flight
    def test_the_alarm_of_one_left_out_ends_with_a_new_order(self) -> None:
        world = two_left_out()
        assert ("fleet_return", "SIM-3") in world.alarms()
        world.world.order("SIM-3", LandNow())
        world.runs(2.0)
        assert ("fleet_return", "SIM-3") not in world.alarms()

    @pytest.mark.flight
    def test_a_vehicle_that_comes_to_hover_in_the_way_is_flown_around(self) -> None:
        world = first_wave_descends()
        (waiting, *_) = [m for m in map(world.member, FOUR) if m.stage is Stage.WAITING]
        assert waiting.flight is not None
        start, end = waiting.flight.path_m[0], waiting.flight.path_m[-1]
        ahead = (0.8 * start[0] + 0.2 * end[0], 0.8 * start[1] + 0.2 * end[1])
        world.put("SIM-5", (*ahead, waiting.flight.layer_up_m))
        assert world.runs_until_over(900.0)
        assert set(world.stages().values()) == {Stage.LANDED}
        assert world.nearest.level_m >= LEAST_LEVEL_M, world.nearest.who

    @pytest.mark.flight
    def test_a_vehicle_hovering_over_its_pad_leaves_it_out(self) -> None:
        world = first_wave_descends()
        (waiting, *_) = [m for m in map(world.member, FOUR) if m.stage is Stage.WAITING]
        world.put("SIM-5", (*world.pads_m[waiting.serial], 10.0))
        assert world.runs_until_over(900.0)
        stages = world.stages()
        assert stages.pop(waiting.serial) is Stage.EXCLUDED
        assert "SIM-5 hovers where it would" in world.member(waiting.serial).reason
        assert set(stages.values()) == {Stage.LANDED}


@pytest.mark.flight
class TestOnePad:
    def test_one_at_a_time_with_time_to_carry_each_away(self) -> None:
        world = returning_world(FIELD[:2], [(0, -20)] * 2)
        world.call(*SIX[:2])
        cleared: set[tuple[str, str | None]] = set()
        landed_s: list[float] = []
        last_down = ""
        for _ in range(900):
            world.runs(1.0)
            cleared |= {alarm for alarm in world.alarms() if alarm[0] == "pad_to_clear"}
            last_down = next((s for s in SIX[:2] if world.flies(s)), last_down)
            down = sum(not world.flies(serial) for serial in SIX[:2])
            landed_s += [world.world.driver.now_ns / 1e9] * (down - len(landed_s))
            if len(landed_s) == 2:
                break
        assert len(landed_s) == 2
        assert landed_s[1] - landed_s[0] > 30.0
        assert cleared == {("pad_to_clear", s) for s in SIX[:2] if s != last_down}
        assert world.nearest.level_m >= LEAST_LEVEL_M, world.nearest.who


class TestCalling:
    def test_on_the_ground_under_pilot_control_unknown_or_called_already_is_refused(self) -> None:
        world = returning_world(
            [(0, 100, 30), (60, 100, 40), (0, 0, 0)], [(0, 0), (60, 0), (90, 0)]
        )
        station = world.world.driver
        station.handle(AuthorityTaken("SIM-2", AuthorityHolder.PILOT, "the pilot"))
        answers = world.called("SIM-1", "SIM-2", "SIM-3", "SIM-9")
        assert [phase is Phase.REFUSED_BY_STATION for phase, _ in answers] == [
            False,
            True,
            True,
            True,
        ]
        assert "controlled by the pilot" in answers[1][1]
        assert answers[2][1].startswith("flying")
        assert answers[3][1].startswith("reachable")
        again = world.called("SIM-1")
        assert "already returning home" in again[0][1]
        assert list(world.stages()) == ["SIM-1"]

    @pytest.mark.flight
    def test_one_called_later_gets_a_free_layer_or_waits_for_one(self) -> None:
        world = four_in_the_air()
        world.call("SIM-1")
        world.runs(10.0)
        assert world.member("SIM-1").stage is Stage.FLYING
        world.call("SIM-3")
        world.runs(10.0)
        first, second = (world.member(serial) for serial in ("SIM-1", "SIM-3"))
        assert (first.stage, second.stage) == (Stage.FLYING, Stage.FLYING)
        assert first.flight is not None
        assert second.flight is not None
        assert second.flight.layer_up_m == first.flight.layer_up_m + 10.0
        world.call("SIM-2", "SIM-4")
        world.runs(3.0)
        assert {world.member(serial).stage for serial in ("SIM-2", "SIM-4")} == {Stage.WAITING}
        assert world.runs_until_over(400.0)
        assert list(world.stages().values()) == [Stage.LANDED] * 4
        assert world.nearest.level_m >= LEAST_LEVEL_M, world.nearest.who

    def test_a_mission_is_stopped_before_its_vehicle_is_planned_for(self) -> None:
        world = returning_world([(0, 100, 30)], [(0, 0)])
        world.world.order("SIM-1", FlyMission(square_mission(30.0, 200.0)))
        world.runs(12.0)
        world.call("SIM-1")
        assert world.runs_until_over(300.0)
        assert landed_on_its_pad(world, "SIM-1")

    def test_the_view_has_waves_layers_and_reasons(self) -> None:
        world = six_in_the_air()
        world.call(*SIX)
        world.runs(20.0)
        driver = world.world.driver
        shown = operation_fields(driver.station, driver.now_ns)["fleet_return"]
        assert shown is not None
        assert not shown.is_over
        assert [v.wave for v in shown.vehicles] == [1, 1, 1, 2, 2, 2]
        assert [v.layer_height_m for v in shown.vehicles] == pytest.approx([20, 30, 40] * 2)
        assert "flying" in {v.stage for v in shown.vehicles[:3]}
        assert all(v.reason for v in shown.vehicles[3:])
