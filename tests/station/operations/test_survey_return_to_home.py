"""A survey's vehicles fly home when there is nothing left for them to fly, in virtual time."""

from dataclasses import replace
from random import Random

import pytest
from tests.examples import IS_THOROUGH
from tests.flown_once import flown_once
from tests.station.surveyed_world import SurveyedWorld, asked, field, surveyed_world

from recon.model.command import FlyMission, Hover, LandNow
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken
from recon.model.survey import SurveyBudget, SurveyPhase, WhenDone
from recon.safety.airspace import PreparedAirspace
from recon.station.operations.survey.availability import may_stay
from recon.station.state.fleet_return_record import Stage
from recon.station.state.station import Station

LONG_FIELD = field(300.0, 90.0)
SECOND_ID = 501


def battery_of(world: SurveyedWorld, serial: str, fraction: float) -> None:
    """Set a battery's charge, as after a flight or a change of battery."""
    battery = world.fleet.world.app(serial).aircraft.battery
    battery.fraction = fraction
    world.runs(2.0)


def alarm_text(world: SurveyedWorld, serial: str, rule: str = "survey") -> str:
    """The text of the one active alarm of a rule about a vehicle."""
    alarms = [a.condition for a in world.driver.station.alarms.alarms.values() if a.is_active]
    (text,) = [each.text for each in alarms if (each.rule, each.serial) == (rule, serial)]
    return text


def is_home(world: SurveyedWorld, serial: str) -> bool:
    east_m, north_m, up_m = world.fleet.place_m(serial)
    pad = world.fleet.pads_m[serial]
    near = abs(east_m - pad[0]) < 3.0 and abs(north_m - pad[1]) < 3.0
    return near and up_m < 0.5 and not world.fleet.flies(serial)


def runs_until_home(world: SurveyedWorld, serials: tuple[str, ...], at_most_s: float) -> bool:
    for _ in range(round(at_most_s)):
        if all(is_home(world, serial) for serial in serials):
            world.runs(2.0)
            return True
        world.runs(1.0)
    return False


@pytest.fixture(scope="module")
def done() -> SurveyedWorld:
    """Three flew a field together."""
    world = surveyed_world(3)
    world.asks(asked(field(200.0)))
    world.starts("SIM-1", "SIM-2", "SIM-3")
    assert world.runs_until(SurveyPhase.DONE, 600.0), world.record()
    assert runs_until_home(world, ("SIM-1", "SIM-2", "SIM-3"), 400.0), world.fleet.stages()
    return world


@pytest.mark.flight
class TestDone:
    def test_all_stand_on_their_pads_and_are_the_operators(self, done: SurveyedWorld) -> None:
        assert set(done.fleet.stages().values()) == {Stage.LANDED}
        assert {done.holder(f"SIM-{n}") for n in (1, 2, 3)} == {AuthorityHolder.OPERATOR}

    def test_they_kept_apart(self, done: SurveyedWorld) -> None:
        assert done.fleet.nearest.level_m >= 15.0, done.fleet.nearest.who

    def test_every_order_is_guidances_in_the_users_name(self, done: SurveyedWorld) -> None:
        orders = done.driver.station.orders.records.values()
        returns = [each.command for each in orders if "fleet return" in each.command.issued_by]
        assert {c.serial for c in returns} == {"SIM-1", "SIM-2", "SIM-3"}
        assert all(isinstance(c.body, FlyMission) for c in returns)
        holds = [each.command for each in orders if isinstance(each.command.body, Hover)]
        assert {c.role for c in (*returns, *holds)} == {AuthorityHolder.GUIDANCE}
        assert {c.issued_by.split(":")[0] for c in (*returns, *holds)} == {"ann"}

    def test_no_alarm_is_left(self, done: SurveyedWorld) -> None:
        assert not {rule for rule, _ in done.fleet.alarms()} & {
            "survey",
            "survey_over",
            "survey_home",
            "fleet_return",
        }


@flown_once
def going_home(when_done: WhenDone = WhenDone.RETURN_HOME) -> SurveyedWorld:
    """Two whose survey has just ended."""
    world = surveyed_world(2)
    world.asks(asked(when_done=when_done))
    world.starts("SIM-1", "SIM-2")
    assert world.runs_until(SurveyPhase.DONE, 400.0)
    return world


class TestSecondSurveyOfOneName:
    def test_the_vehicles_that_fly_it_do_not_hover_for_the_first(self) -> None:
        world = going_home(WhenDone.HOVER)
        assert ("survey_over", "SIM-1") in world.fleet.alarms()
        world.asks(asked(id=SECOND_ID))
        world.starts("SIM-1", "SIM-2", number=SECOND_ID)
        world.runs(5.0)
        assert len(world.missions("SIM-1")) > 1
        assert "survey_over" not in {rule for rule, _ in world.fleet.alarms()}


class TestOnTheWayHome:
    def test_surveys_set_to_hover_leave_them_hovering(self) -> None:
        world = going_home(WhenDone.HOVER)
        world.runs(60.0)
        assert world.fleet.stages() == {}
        assert all(world.fleet.flies(serial) for serial in ("SIM-1", "SIM-2"))
        assert {world.holder("SIM-1"), world.holder("SIM-2")} == {AuthorityHolder.OPERATOR}

    @pytest.mark.flight
    def test_an_abort_holds_them_though_the_survey_is_done(self) -> None:
        world = going_home()
        world.runs(8.0)
        world.aborts()
        world.runs(10.0)
        assert world.phase() is SurveyPhase.DONE
        assert set(world.fleet.stages().values()) == {Stage.RELEASED}
        assert {world.holder("SIM-1"), world.holder("SIM-2")} == {AuthorityHolder.OPERATOR}
        world.runs(60.0)
        assert all(world.fleet.flies(serial) for serial in ("SIM-1", "SIM-2"))

    @pytest.mark.flight
    def test_a_hold_takes_one_out_and_the_other_flies_home(self) -> None:
        world = going_home()
        world.runs(3.0)
        world.fleet.world.order("SIM-1", Hover())
        assert runs_until_home(world, ("SIM-2",), 300.0)
        assert world.fleet.flies("SIM-1")
        assert world.fleet.member("SIM-1").stage is Stage.RELEASED
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR

    @pytest.mark.flight
    def test_a_vehicle_under_pilot_control_is_left_to_the_pilot(self) -> None:
        world = going_home()
        world.driver.handle(AuthorityTaken("SIM-1", AuthorityHolder.PILOT, "the pilot"))
        before = len(world.missions("SIM-1"))
        assert runs_until_home(world, ("SIM-2",), 300.0)
        assert world.fleet.member("SIM-1").stage is Stage.RELEASED
        assert len(world.missions("SIM-1")) == before
        assert world.holder("SIM-1") is AuthorityHolder.PILOT

    @pytest.mark.flight
    def test_another_survey_cannot_have_them_before_they_are_home(self) -> None:
        world = going_home()
        world.asks(asked(id=2, name="other"))
        world.starts("SIM-1", number=2)
        assert world.phase(2) is SurveyPhase.CREATED
        assert runs_until_home(world, ("SIM-1", "SIM-2"), 300.0)
        world.starts("SIM-1", number=2, takeoff=True)
        world.runs(20.0)
        assert world.fleet.flies("SIM-1")
        assert world.holder("SIM-1") is AuthorityHolder.GUIDANCE


class TestWithoutBattery:
    @pytest.mark.flight
    def test_low_battery_home_full_battery_joined_done_home(self) -> None:
        """The whole line of a long survey with one battery too few."""
        world = surveyed_world(endurance_s=800.0)
        world.asks(asked(LONG_FIELD))
        battery_of(world, "SIM-1", 0.55)
        world.starts("SIM-1")
        assert runs_until_home(world, ("SIM-1",), 900.0)
        assert world.phase() is SurveyPhase.RUNNING
        first = world.figures().not_yet_m2
        assert 0.0 < first < world.figures().region_m2
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR
        assert "Change its battery, then let it join survey" in alarm_text(world, "SIM-1")

        world.runs(30.0)
        assert not world.fleet.flies("SIM-1")
        battery_of(world, "SIM-1", 1.0)
        assert "Its battery is good: let it join" in alarm_text(world, "SIM-1")
        world.starts("SIM-1", takeoff=True)
        world.runs(30.0)
        assert world.fleet.flies("SIM-1")
        assert ("survey", "SIM-1") not in world.fleet.alarms()

        assert world.runs_until(SurveyPhase.DONE, 900.0), world.record()
        assert world.figures().not_yet_m2 < 0.02 * world.figures().region_m2
        assert runs_until_home(world, ("SIM-1",), 300.0)
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR

    @pytest.mark.flight
    def test_one_comes_home_while_the_other_flies_on(self) -> None:
        world = surveyed_world(2, endurance_s=600.0)
        world.asks(asked(field(360.0, 90.0)))
        battery_of(world, "SIM-1", 0.55)
        world.starts("SIM-1", "SIM-2")
        assert runs_until_home(world, ("SIM-1",), 600.0), world.record().members
        assert world.phase() is SurveyPhase.RUNNING
        assert world.fleet.flies("SIM-2")
        assert world.runs_until(SurveyPhase.DONE, 900.0)
        assert runs_until_home(world, ("SIM-2",), 300.0)
        assert world.fleet.nearest.level_m >= 15.0, world.fleet.nearest.who

    def test_on_the_ground_no_vehicle_is_called_home(self) -> None:
        world = surveyed_world(height_m=0.0, endurance_s=1_500.0)
        world.asks()
        battery_of(world, "SIM-1", 0.24)
        world.starts("SIM-1", takeoff=True)
        world.runs(8.0)
        assert ("survey_takeoff", "SIM-1") not in world.fleet.alarms()
        world.runs(22.0)
        assert not world.fleet.flies("SIM-1")
        assert world.missions() == [] or not world.fleet.stages()

        # It would take off for a row that its battery lasts for: who stands there must know.
        assert "Keep clear of it" in alarm_text(world, "SIM-1", "survey_takeoff")
        world.pauses()
        world.runs(2.0)
        assert ("survey_takeoff", "SIM-1") not in world.fleet.alarms()

    @pytest.mark.flight
    def test_a_hovering_vehicle_with_that_setting_waits(self) -> None:
        world = surveyed_world(endurance_s=1_500.0)
        world.asks(asked(LONG_FIELD, when_done=WhenDone.HOVER))
        battery_of(world, "SIM-1", 0.40)
        world.starts("SIM-1")
        world.runs(150.0)
        assert world.fleet.flies("SIM-1")
        assert world.fleet.stages() == {}

    @pytest.mark.flight
    def test_a_survey_paused_by_hand_holds_the_one_on_its_way_too(self) -> None:
        world = surveyed_world(endurance_s=800.0)
        world.asks(asked(LONG_FIELD))
        battery_of(world, "SIM-1", 0.55)
        world.starts("SIM-1")
        for _ in range(600):
            world.runs(1.0)
            if world.record().members["SIM-1"].return_reason:
                break
        world.runs(5.0)
        world.pauses()
        world.runs(30.0)
        assert world.phase() is SurveyPhase.PAUSED
        assert world.holder("SIM-1") is AuthorityHolder.OPERATOR
        assert world.fleet.flies("SIM-1")


@pytest.mark.flight
def test_a_budget_that_ends_brings_them_home_too() -> None:
    world = surveyed_world()
    world.asks(asked(budget=SurveyBudget(time_s=20.0)))
    world.starts("SIM-1")
    assert world.runs_until(SurveyPhase.DONE, 400.0)
    assert runs_until_home(world, ("SIM-1",), 300.0)


@pytest.mark.flight
def test_one_whose_mission_failed_is_left_to_the_operator() -> None:
    world = surveyed_world(2, faults=("ack-then-nothing:SIM-1:1:900",))
    world.asks()
    world.starts("SIM-1", "SIM-2")
    assert world.runs_until(SurveyPhase.DONE, 600.0)
    assert runs_until_home(world, ("SIM-2",), 300.0)
    assert "SIM-1" not in world.fleet.stages()
    assert world.holder("SIM-1") is AuthorityHolder.OPERATOR
    world.fleet.world.order("SIM-1", LandNow())


@pytest.mark.flight
@pytest.mark.drawn
@pytest.mark.parametrize("seed", range(4) if IS_THOROUGH else range(1))
def test_whatever_the_field_and_the_batteries_they_keep_apart_and_land(seed: int) -> None:
    """Random fields, pads and batteries: vehicles that return early pass those that fly rows."""
    random = Random(seed)
    pads = [(40.0 * n + random.uniform(-8.0, 8.0), random.uniform(-70.0, -40.0)) for n in range(3)]
    world = surveyed_world(3, pads=pads)
    world.asks(asked(field(random.uniform(160.0, 320.0), random.uniform(60.0, 140.0))))
    serials = ("SIM-1", "SIM-2", "SIM-3")
    for serial in serials:
        battery_of(world, serial, random.uniform(0.35, 0.9))
    world.starts(*serials)
    assert runs_until_home(world, serials, 1_500.0), (world.record().members, world.fleet.stages())
    assert {world.holder(serial) for serial in serials} == {AuthorityHolder.OPERATOR}
    assert set(world.fleet.stages().values()) == {Stage.LANDED}
    assert world.fleet.nearest.level_m >= 15.0, world.fleet.nearest.who


@pytest.mark.parametrize(
    ("reserve", "fraction", "stays"),
    [(0.25, 0.5, True), (0.25, 0.49, False), (0.4, 0.6, False), (0.4, 0.65, True)],
)
def test_a_battery_stays_in_with_half_of_its_charge_well_above_the_reserve(
    reserve: float, fraction: float, stays: bool
) -> None:
    station = Station()
    limits = replace(station.airspace.airspace.limits, battery_reserve_fraction=reserve)
    airspace = PreparedAirspace(replace(station.airspace.airspace, limits=limits))
    assert may_stay(replace(station, airspace=airspace), fraction) == stays
