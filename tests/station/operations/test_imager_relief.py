"""Reliefs of imaging drones, in virtual time: simulated apps, the real station and gate."""

from dataclasses import replace
from math import dist

import numpy as np
import pytest
from tests.flown_once import flown_once
from tests.station.relieved_world import (
    FIRST,
    FIRST_UP_M,
    PLACE_M,
    SPARE,
    SURVEY_M,
    RelievedWorld,
    relieved_world,
)
from tests.station.surveyed_world import SURVEY_ID, asked, field

from recon.api.schema import SurveyLightView
from recon.guidance.survey.settings import DEFAULT as SURVEY_DEFAULT
from recon.model.airspace import Region, Zone, ZoneKind
from recon.model.command import Hover, Phase, Refusal
from recon.model.control import AuthorityHolder
from recon.model.event import AllStopped, AuthorityTaken, OperatorOrder, ReliefOrdered
from recon.model.imagery import Outlook
from recon.model.survey import SurveyPhase
from recon.model.units import seconds_to_ns
from recon.station.api_views.operation_views import survey_view
from recon.station.api_views.relief_views import unknown_from_s
from recon.station.imaging.at_work import imagers_at_work
from recon.station.imaging.upwind import upwind_question
from recon.station.operations.imager_motion.execution import put
from recon.station.operations.imager_motion.side_step import meant
from recon.station.operations.imager_relief.commands import audit_entries, refusal
from recon.station.operations.imager_relief.conditions import conditions
from recon.station.state.fleet_return_record import Stage
from recon.station.state.imager_motion import ImagerRelief, MotionStage
from recon.station.state.steps import StepTaken

REGION = field(120.0, 100.0, south_m=-20.0)
LOW = 0.44
"""Of the first one: two and a half minutes above the field."""
SHORT = 0.375
"""About a minute."""
AT_ONCE = 0.32
WALL = Zone(
    "wall",
    ZoneKind.KEEP_OUT,
    Region(np.array([[-40.0, -900.0], [-30.0, -900.0], [-30.0, 900.0], [-40.0, 900.0]])),
)


@flown_once
def surveying(
    spare: str | None = SPARE,
    *,
    allowed: bool = True,
    takeoff: bool = True,
    first: float = LOW,
    planner: str = "lawnmower_again",
    region: Region = REGION,
    **options: object,
) -> RelievedWorld:
    """A survey of one drone that goes on for longer than the first imaging drone's battery."""
    world = relieved_world(1, **options)  # type: ignore[arg-type]
    world.charges(FIRST, first)
    survey = asked(
        region,
        height_above_takeoff_m=SURVEY_M,
        speed_mps=5.0,
        planner=planner,
        relief_allowed=allowed,
        spare_serial=spare,
    )
    world.surveyed.asks(survey)
    world.surveyed.starts("SIM-1", takeoff=takeoff)
    world.runs(3.0)
    assert world.surveyed.phase() is SurveyPhase.RUNNING
    world.worst_age_s = 0.0
    return world


@flown_once
def ordered(**options: object) -> RelievedWorld:
    """A relief that a person has ordered, under way for 20 s."""
    world = relieved_world(**options)  # type: ignore[arg-type]
    world.orders()
    world.runs(20.0)
    assert world.newest().stage is MotionStage.TO_PLACE
    assert world.holder(SPARE) is AuthorityHolder.GUIDANCE
    return world


def why_not(world: RelievedWorld, event: ReliefOrdered) -> Refusal | None:
    return refusal(world.station, event, world.surveyed.driver.now_ns)


def left_at_home(world: RelievedWorld) -> bool:
    return not world.surveyed.fleet.flies(FIRST)


@pytest.fixture(scope="module")
def flown() -> tuple[RelievedWorld, list[tuple[str, str | None]], dict[str, str]]:
    """An automatic relief from its beginning until the first one has landed; audit and alarms."""
    world = surveying()
    entries: list[tuple[str, str | None]] = []

    def observe(step: StepTaken) -> None:
        found = audit_entries(step.before, step.event, step.after, step.now_ns)
        entries.extend((each.kind, each.serial) for each in found)

    world.surveyed.driver.observe = observe
    assert world.runs_until(
        lambda: world.station.imager_motions.of(ImagerRelief) is not None, 240.0
    )
    world.runs(20.0)
    on_the_way = world.alarms()
    assert world.runs_until(lambda: left_at_home(world), 240.0)
    world.runs(2.0)
    world.surveyed.driver.observe = None
    return world, entries, on_the_way


@pytest.mark.flight
class TestFlown:
    Flown = tuple[RelievedWorld, list[tuple[str, str | None]], dict[str, str]]

    def test_no_moment_is_without_light(self, flown: Flown) -> None:
        world = flown[0]
        assert world.worst_age_s <= SURVEY_DEFAULT.shade_age_s < SURVEY_DEFAULT.forecast_age_s
        assert world.station.reliefs.surveys[SURVEY_ID].without_light is None

    def test_distances_are_kept(self, flown: Flown) -> None:
        world = flown[0]
        assert world.nearest_m > 7.0
        assert world.surveyed.fleet.nearest.level_m > 15.0

    def test_the_first_one_lands_with_its_reserve(self, flown: Flown) -> None:
        world = flown[0]
        limits = world.station.airspace.airspace.limits
        assert world.battery(FIRST) >= limits.battery_reserve_fraction
        assert world.surveyed.fleet.stages()[FIRST] is Stage.LANDED

    def test_the_spare_hovers_above_the_place_and_the_operator_has_it(self, flown: Flown) -> None:
        world = flown[0]
        assert world.newest().stage is MotionStage.DONE
        assert dist(world.place_m(SPARE)[:2], PLACE_M) < 3.0
        assert world.place_m(SPARE)[2] == pytest.approx(FIRST_UP_M + 10.0, abs=1.5)
        assert world.holder(SPARE) is AuthorityHolder.OPERATOR
        assert imagers_at_work(world.station) == (SPARE,)

    def test_it_is_the_imaging_drone_from_then_on(self, flown: Flown) -> None:
        """Side-steps and moves upwind mean it where none is named."""
        world = flown[0]
        assert meant(world.station) == SPARE
        shade = world.station.shade
        assert shade.sun is not None
        moving = replace(shade, sun=replace(shade.sun, velocity_mps=(5.0, 0.0)))
        imagers = {
            serial: replace(each, outlook=Outlook(1.1))
            for serial, each in world.station.imaging.imagers.items()
        }
        imaging = replace(world.station.imaging, imagers=imagers)
        station = replace(world.station, shade=moving, imaging=imaging)
        asked = upwind_question(station, [REGION], None, world.surveyed.driver.now_ns)
        assert not isinstance(asked, str)
        assert asked.serial == SPARE

    def test_each_stage_is_audited_and_the_way_is_an_information(self, flown: Flown) -> None:
        world, entries, on_the_way = flown
        stages = ["imager_relief.to_place", "imager_relief.maps", "imager_relief.done"]
        assert [kind for kind, _ in entries] == stages
        assert {serial for _, serial in entries} == {SPARE}
        assert list(on_the_way) == ["imager_relief:motion"]
        assert "relieves CAM-1 for its survey" in on_the_way["imager_relief:motion"]
        assert world.alarms() == {}

    def test_the_takeoff_was_allowed_once(self, flown: Flown) -> None:
        assert not flown[0].surveyed.record().spare_may_take_off


@pytest.mark.parametrize(
    ("leaves_s", "needs_s", "unknown_from"),
    [
        ([600.0], 900.0, 600.0),
        ([600.0], 500.0, None),
        ([600.0, 800.0], 900.0, 800.0),
        ([600.0, None], 900.0, None),
        ([], 900.0, None),
        ([600.0], None, None),
        ([240.0], None, 240.0),
    ],
)
def test_light_is_stated_to_end_where_a_survey_goes_on_or_the_end_is_near(
    leaves_s: list[float | None], needs_s: float | None, unknown_from: float | None
) -> None:
    assert unknown_from_s(leaves_s, needs_s) == unknown_from


class TestWithoutRelief:
    """The baseline: the same survey, and a survey that allows the route home alone."""

    @pytest.mark.flight
    def test_light_becomes_unknown_and_stays_so_and_the_view_states_both(self) -> None:
        world = surveying(None, allowed=False, first=0.39)
        world.runs(62.0)
        light = light_of(world)
        assert light.needs_s is not None
        (first,) = light.imagers
        assert first.return_due_in_s is not None
        assert light.unknown_in_s == pytest.approx(first.return_due_in_s)
        assert light.unknown_for_s == pytest.approx(light.needs_s - first.return_due_in_s)
        assert (light.without_age_s, light.absent) == (None, [])
        assert world.runs_until(lambda: left_at_home(world), 200.0)
        assert "light is unknown from then on. Recall it" in leaves_texts(world)[-1]
        world.runs(45.0)
        assert world.surveyed.phase() is SurveyPhase.RUNNING
        assert world.worst_age_s > 45.0 > SURVEY_DEFAULT.forecast_age_s
        assert "counts as light unknown" in world.alarms()[f"imager_relief:light:{SURVEY_ID}"]
        light = light_of(world)
        assert light.imagers == []
        assert light.without_age_s == pytest.approx(world.worst_age_s, abs=2.0)
        assert light.without_m2 is not None
        assert light.without_m2 > 0.0
        (absent,) = light.absent
        assert (absent.serial, absent.is_on_ground) == (FIRST, True)
        assert absent.gone_age_s > 45.0

    @pytest.mark.flight
    def test_it_is_called_home_when_it_must_leave_and_sent_back_with_a_fresh_battery(self) -> None:
        world = surveying(None, first=0.36)
        assert world.runs_until(lambda: bool(world.alarms()), 60.0)
        text = world.alarms()["imager_relief:return:CAM-1"]
        assert "Relieve it, or it is recalled then" in text
        assert world.runs_until(lambda: left_at_home(world), 200.0)
        world.runs(2.0)
        assert world.surveyed.fleet.stages()[FIRST] is Stage.LANDED
        assert world.battery(FIRST) >= 0.25
        assert world.holder(FIRST) is AuthorityHolder.OPERATOR
        world.surveyed.aborts()
        world.charges(FIRST, 0.97)
        world.runs(2.0)
        assert why_not(world, ReliefOrdered(FIRST, FIRST, "ann")) is not None  # without takeoff
        world.orders(FIRST)
        assert world.newest().comes_back
        assert world.runs_until(lambda: world.newest().is_over, 120.0)
        assert world.newest().stage is MotionStage.DONE
        assert dist(world.place_m(FIRST), (*PLACE_M, FIRST_UP_M)) < 3.0
        assert world.alarms() == {}


def leaves_texts(world: RelievedWorld) -> list[str]:
    """All texts of the alarm that a drone must return, ended or not."""
    book = world.station.alarms.alarms.values()
    return [a.condition.text for a in book if a.condition.key.startswith("imager_relief:return")]


class TestForeseen:
    def test_the_moment_is_where_home_and_reserve_take_the_charge(self) -> None:
        world = relieved_world()
        world.charges(FIRST, 0.60)
        world.runs(90.0)  # its use is observed by now
        outlook = world.station.reliefs.outlooks[FIRST]
        assert outlook.return_due_ns is not None
        in_s = (outlook.return_due_ns - world.surveyed.driver.now_ns) / 1e9
        home_s = 1.2 * (FIRST_UP_M / 1.5 + 15.0 + 50.0 / 8.0 + 8.0 / 2.5)
        """Landing, the path and its stop, in wind that is not reported."""
        reserve = 0.25 + 0.01
        left_s = (
            (world.battery(FIRST) - reserve) * 1500.0 - home_s - SURVEY_DEFAULT.route_home_waits_s
        )
        assert in_s == pytest.approx(left_s, abs=20.0)  # a percent is 15 s

    def test_unknown_without_endurance(self) -> None:
        world = relieved_world(endurance_s=None)
        outlook = world.station.reliefs.outlooks[FIRST]
        assert outlook.return_due_ns is None
        assert "endurance unknown" in outlook.unknown

    @pytest.mark.flight
    def test_what_the_survey_needs_comes_true_and_a_battery_that_outlasts_it_stays(self) -> None:
        world = surveying(first=0.97, planner="lawnmower_once", region=field(100.0, 60.0))
        world.runs(75.0)
        needs_s = world.station.reliefs.surveys[SURVEY_ID].needs_s
        assert needs_s is not None
        began_s = world.surveyed.driver.now_ns / 1e9
        assert world.surveyed.runs_until(SurveyPhase.DONE, 400.0)
        took_s = world.surveyed.driver.now_ns / 1e9 - began_s
        assert 0.7 * took_s < needs_s < 1.4 * took_s
        assert world.station.imager_motions.of(ImagerRelief) is None
        assert leaves_texts(world) == []


def light_of(world: RelievedWorld) -> SurveyLightView:
    view = survey_view(world.station, world.surveyed.record(), world.surveyed.driver.now_ns)
    assert view.light is not None
    return view.light


class TestAnotherShowsTheField:
    """The first one must return soon; another one hovers over the field too."""

    @staticmethod
    def texts(world: RelievedWorld, maps_are_old_s: float) -> list[str]:
        station = world.station
        other, own = station.fleet.vehicles[SPARE], station.shade.own[FIRST]
        flying = replace(other, is_flying=replace(other.is_flying, value=True))
        fleet = replace(station.fleet, vehicles={**station.fleet.vehicles, SPARE: flying})
        shade = replace(station.shade, own={**station.shade.own, SPARE: own})
        checked_ns = own.shade.captured_at_ns + seconds_to_ns(maps_are_old_s)
        reliefs = replace(station.reliefs, checked_at_ns=checked_ns)
        station = replace(station, fleet=fleet, shade=shade, reliefs=reliefs)
        return [each.text for each in conditions(station) if "return threshold" in each.text]

    def test_its_maps_of_now_are_light_and_old_ones_are_not(self) -> None:
        world = surveying(allowed=False, first=SHORT)
        assert self.texts(world, 2.0) == []
        (text,) = self.texts(world, 60.0)
        assert "light is unknown from then on" in text


class TestNotByItself:
    def test_without_permission_to_take_off(self) -> None:
        world = surveying(takeoff=False, first=SHORT)
        world.runs(3.0)
        assert world.station.imager_motions.of(ImagerRelief) is None
        assert "Relieve it" in leaves_texts(world)[0]

    @pytest.mark.flight
    def test_where_the_gate_refuses_every_layer(self) -> None:
        world = surveying(zones=(WALL,), spare_pad_m=(-60.0, -20.0), first=SHORT)
        world.runs(2.0)
        text = world.alarms()["imager_relief:refused"]
        assert "wall" in text
        assert "every other height was refused as well" in text
        assert "imager_relief:return:CAM-1" in world.alarms()
        assert world.holder(SPARE) is AuthorityHolder.OPERATOR
        assert not world.surveyed.fleet.flies(SPARE)
        assert world.surveyed.record().spare_may_take_off  # nothing has used it

    @pytest.mark.flight
    def test_one_left_out_of_the_fleet_return_is_called_again_after_a_minute(self) -> None:
        world = surveying(None, first=AT_ONCE)
        assert world.runs_until(lambda: bool(world.surveyed.fleet.stages()), 10.0)
        returning = world.station.fleet_return
        assert returning is not None
        left = returning.members[FIRST].at(Stage.EXCLUDED, world.surveyed.driver.now_ns, "no layer")
        world.station = replace(world.station, fleet_return=returning.put(left))
        assert holds(world) == 1
        world.runs(5.0)
        assert holds(world) == 1
        called = world.station.reliefs.recalled[FIRST]
        again = {FIRST: replace(called, at_ns=called.at_ns - 60_000_000_000)}
        reliefs = replace(world.station.reliefs, recalled=again)
        world.station = replace(world.station, reliefs=reliefs)
        world.runs(2.0)
        assert holds(world) == 2

    @pytest.mark.flight
    def test_one_that_its_pilot_flies_is_not_called_home_and_an_alarm_states_why(self) -> None:
        world = surveying(None)
        taken = AuthorityTaken(FIRST, AuthorityHolder.PILOT, "bob")
        world.surveyed.driver.handle(taken)
        world.charges(FIRST, AT_ONCE)
        world.runs(5.0)
        text = world.alarms()["imager_relief:return:CAM-1"]
        assert "cannot be recalled automatically: CAM-1 is controlled by the pilot" in text
        assert holds(world) == 0


def holds(world: RelievedWorld) -> int:
    """The holds that began the first one's route home."""
    records = world.station.orders.records.values()
    return sum(
        each.command.serial == FIRST
        and each.command.name == "hover"
        and each.command.issued_by.endswith("relief")
        for each in records
    )


class TestEndedBefore:
    """Whatever ends it, the spare holds, the first one stays, and nothing resumes."""

    def stays(self, world: RelievedWorld, why: str) -> None:
        world.runs(6.0)
        ended = world.newest()
        assert ended.stage is MotionStage.STOPPED
        assert why in ended.reason
        here = world.place_m(SPARE)
        world.runs(20.0)
        assert dist(here, world.place_m(SPARE)) < 2.0
        assert world.newest() is ended
        assert dist(world.place_m(FIRST)[:2], PLACE_M) < 2.0
        assert world.surveyed.fleet.flies(FIRST)

    def test_by_a_lost_connection(self) -> None:
        world = ordered()
        connected = world.surveyed.fleet.world.connected[SPARE]
        world.surveyed.driver.disconnect(connected.link_id)
        world.runs(5.0)
        world.surveyed.fleet.world.connect(connected.app)
        self.stays(world, "its connection was interrupted")
        assert "Fix the cause and relieve again" in world.alarms()["imager_relief:stopped"]

    @pytest.mark.flight
    def test_by_telemetry_that_is_lost_for_longer(self) -> None:
        world = ordered(faults=("telemetry-dropout:CAM-2:26:6",))
        world.runs(10.0)
        self.stays(world, "no telemetry for 3 s")

    @pytest.mark.flight
    def test_by_its_pilot(self) -> None:
        world = ordered()
        world.app(SPARE).aircraft.pilot_takes()
        self.stays(world, "pilot")
        assert world.holder(SPARE) is AuthorityHolder.PILOT
        assert world.alarms() == {}

    def test_by_an_all_stop(self) -> None:
        world = ordered()
        world.surveyed.driver.handle(AllStopped("bob"))
        for number, serial in enumerate((FIRST, SPARE), 900):
            world.surveyed.driver.handle(OperatorOrder(number, Hover(), "bob", serial=serial))
        self.stays(world, "all stop by bob")
        again = why_not(world, ReliefOrdered(FIRST, SPARE, "ann", True))
        assert again is not None
        assert "held by an all stop" in again.reason

    @pytest.mark.flight
    def test_by_control_taken(self) -> None:
        world = ordered()
        taken = AuthorityTaken(SPARE, AuthorityHolder.OPERATOR, "ann", "ann")
        world.surveyed.driver.handle(taken)
        world.runs(1.0)
        assert world.newest().stage is MotionStage.STOPPED
        assert "taken over by ann" in world.newest().reason

    @pytest.mark.flight
    def test_without_maps_and_ordered_again_it_goes_on_from_the_place(self) -> None:
        world = ordered()
        world.blind_cameras = {SPARE}
        assert world.runs_until(lambda: world.newest().is_over, 120.0)
        assert world.app(SPARE).feed.is_on  # it was switched on
        self.stays(world, "no shade map within 60 s of its arrival: no frames")
        assert "relieve again" in world.alarms()["imager_relief:stopped"]
        world.blind_cameras = set()
        world.orders(takeoff=False)
        assert world.newest().stage is MotionStage.MAPS
        assert world.runs_until(lambda: world.newest().is_over, 10.0)
        assert world.newest().stage is MotionStage.DONE
        assert world.surveyed.fleet.stages()[FIRST] is Stage.STOPPING

    @pytest.mark.flight
    def test_by_maps_of_other_ground(self) -> None:
        world = ordered()
        world.charges(SPARE, 0.9)
        world.shown_m = {SPARE: 20.0}
        assert world.runs_until(lambda: world.newest().stage is MotionStage.MAPS, 60.0)
        assert world.runs_until(lambda: "of what CAM-1 shows" in world.newest().reason, 15.0)
        waits = world.newest()
        late = replace(waits, since_ns=waits.since_ns - 150_000_000_000)
        world.station = put(world.station, late)
        self.stays(world, "no 3 shade maps in a row within 150 s of its arrival: its shade map")


@pytest.mark.flight
def test_a_relief_by_itself_that_a_person_stops_does_not_begin_again() -> None:
    world = surveying(first=LOW)
    assert world.runs_until(lambda: world.station.imager_motions.of(ImagerRelief) is not None, 60.0)
    world.runs(10.0)
    world.surveyed.driver.handle(OperatorOrder(900, Hover(), "bob", serial=SPARE))
    world.runs(2.0)
    stopped = world.newest()
    assert stopped.stage is MotionStage.STOPPED
    assert "hover, ordered by bob" in stopped.reason
    assert "imager_relief:return:CAM-1" in world.alarms()
    world.runs(20.0)
    assert world.newest() is stopped


@pytest.mark.flight
def test_a_first_one_that_cannot_be_called_home_in_the_end_is_an_alarm() -> None:
    world = ordered()
    assert world.runs_until(lambda: world.newest().stage is MotionStage.MAPS, 60.0)
    world.app(FIRST).aircraft.pilot_takes()
    assert world.runs_until(lambda: world.newest().is_over, 60.0)
    assert world.newest().stage is MotionStage.DONE
    world.runs(1.0)
    assert (
        "cannot be recalled: CAM-1 is controlled by the pilot"
        in (world.alarms()["imager_relief:stays"])
    )


@pytest.mark.flight
def test_a_first_one_that_must_leave_at_once_is_called_home_and_the_relief_follows() -> None:
    """A survey drone crosses above the spare: the relief is refused for the first seconds."""
    world = surveying(first=0.29)
    assert "relief cannot begin" in world.alarms()["imager_relief:refused"]
    assert world.surveyed.fleet.stages()[FIRST] in (Stage.STOPPING, Stage.WAITING, Stage.FLYING)
    assert world.runs_until(lambda: world.station.imager_motions.of(ImagerRelief) is not None, 60.0)
    assert world.runs_until(lambda: left_at_home(world), 120.0)
    names = [
        each.command.name
        for each in world.station.orders.records.values()
        if each.command.serial == FIRST
    ]
    assert names == ["hover", "return_home"]  # the failsafe matrix's return is not replaced
    assert world.runs_until(lambda: world.newest().is_over, 120.0)
    assert world.newest().stage is MotionStage.DONE
    assert world.nearest_m > 7.0


class TestRefused:
    def test_what_is_no_imaging_drone_or_not_connected(self) -> None:
        world = relieved_world(1)
        for event in (ReliefOrdered(FIRST, "SIM-1", "ann"), ReliefOrdered("X", SPARE, "ann")):
            refused = why_not(world, event)
            assert refused is not None
            assert "expected CAM-1, CAM-2" in refused.reason
        connected = world.surveyed.fleet.world.connected[SPARE]
        world.surveyed.driver.disconnect(connected.link_id)
        world.runs(4.0)
        refused = why_not(world, ReliefOrdered(FIRST, SPARE, "ann", True))
        assert refused is not None

    def test_without_takeoff_and_with_a_weak_battery(self) -> None:
        world = relieved_world()
        refused = why_not(world, ReliefOrdered(FIRST, SPARE, "ann"))
        assert refused is not None
        assert "not in the air, and takeoff was not allowed" in refused.reason
        world.charges(SPARE, 0.48)
        world.runs(2.0)
        refused = why_not(world, ReliefOrdered(FIRST, SPARE, "ann", True))
        assert refused is not None
        assert "min at the place; expected 5 min or more" in refused.reason

    def test_while_the_first_one_is_its_pilots_or_flies(self) -> None:
        world = relieved_world()
        taken = AuthorityTaken(FIRST, AuthorityHolder.PILOT, "bob")
        world.surveyed.driver.handle(taken)
        refused = why_not(world, ReliefOrdered(FIRST, SPARE, "ann", True))
        assert refused is not None
        assert "controlled by the pilot" in refused.reason

    def test_without_a_place(self) -> None:
        world = relieved_world()
        refused = why_not(world, ReliefOrdered(SPARE, FIRST, "ann"))
        assert refused is not None
        assert "has not hovered over the field yet" in refused.reason

    def test_a_refused_one_changes_nothing_and_is_audited(self) -> None:
        world = relieved_world()
        before = world.station
        event = ReliefOrdered(FIRST, SPARE, "ann")
        now_ns = world.surveyed.driver.now_ns
        world.orders(takeoff=False)
        assert world.station.imager_motions.of(ImagerRelief) is None
        (entry,) = audit_entries(before, event, world.station, now_ns)
        assert entry.kind == "imager_relief.refused"
        assert world.station.control(SPARE).authority is before.control(SPARE).authority

    def test_below_a_low_ceiling_it_goes_underneath_and_leaves_the_route_home_free(self) -> None:
        world = relieved_world(max_height_m=50.0)
        world.orders()
        assert world.newest().height_above_takeoff_m == pytest.approx(FIRST_UP_M - 20.0, abs=0.5)
        assert world.runs_until(lambda: world.newest().is_over, 120.0)
        world.runs(10.0)
        assert world.newest().stage is MotionStage.DONE
        assert world.surveyed.fleet.stages()[FIRST] is Stage.FLYING
        assert world.runs_until(lambda: left_at_home(world), 120.0)
        assert world.nearest_m > 7.0

    def test_the_return_way_is_an_order_of_guidance(self) -> None:
        world = ordered()
        record = world.station.orders.records[world.newest().command_id]
        assert record.command.role is AuthorityHolder.GUIDANCE
        assert record.phase in (Phase.STARTED, Phase.CONFIRMED)
        assert record.command.issued_by == "ann: relief"


class TestPermissionOfTheSpare:
    def test_a_vehicle_that_joins_in_the_air_does_not_take_it_away(self) -> None:
        world = surveying()
        world.surveyed.starts("SIM-1")
        assert world.surveyed.record().spare_may_take_off

    def test_a_vehicle_that_joins_from_the_ground_does_not_give_it_again(self) -> None:
        world = surveying(first=SHORT)
        assert world.runs_until(
            lambda: world.station.imager_motions.of(ImagerRelief) is not None, 60.0
        )
        world.surveyed.starts("SIM-1", takeoff=True)
        assert not world.surveyed.record().spare_may_take_off
