"""Moves upwind by themselves, in virtual time: simulated apps, the real station and gate."""

from collections.abc import Callable
from dataclasses import replace
from math import hypot, radians

import numpy as np
import pytest
from tests.flown_once import flown_once
from tests.station.imager_world import GRID, IMAGER, ImagerWorld, imager_world
from tests.station.surveyed_world import SURVEY_ID, asked

from recon.forecast import ForecastState
from recon.model.airspace import Region, Zone, ZoneKind
from recon.model.command import GoTo, Hover, Phase, StartCamera, issued_by_station
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AllStopped,
    AuthorityTaken,
    OperatorOrder,
    SideStepOrdered,
    SurveyStarted,
    ZoneDrawn,
)
from recon.model.imagery import Outlook
from recon.model.shade import ShadeMap, SunForecast
from recon.model.survey import SurveyPhase
from recon.model.temporary_zone import Circle, DrawnZone, TemporaryZoneKind
from recon.station.operations.imager_motion.execution import put
from recon.station.operations.imager_motion.move_upwind import MOVE_UPWIND
from recon.station.operations.imager_motion.side_step import refusal
from recon.station.state.imager_motion import MotionStage, MoveUpwind, SideStep
from recon.station.state.steps import StepTaken

EASTWARD, NORTHWARD = (5.0, 0.0), (0.0, 5.0)
FIELD = Region(190.0 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]))
NO_VALUE = np.full((GRID.rows, GRID.cols), np.nan, np.float32)
NOTHING = ShadeMap(
    GRID, 0, (), NO_VALUE, np.zeros(NO_VALUE.shape, np.bool_), np.zeros_like(NO_VALUE), NO_VALUE
)
"""Shade that has left the view is followed, and there is none."""
PERSON = {"issued_by": "bob", "serial": IMAGER, "person": "ann"}


def blows(world: ImagerWorld, velocity: tuple[float, float] | None) -> None:
    """A forecast of now, with this motion of the shadows."""
    cells = (GRID.rows, GRID.cols)
    sun = SunForecast(
        GRID,
        world.surveyed.driver.now_ns,
        np.array([0.0]),
        np.zeros((1, *cells), np.uint8),
        np.zeros(cells, np.float32),
        0.5,
        "advection",
        velocity,
    )
    shade = replace(world.station.shade, sun=sun, forecast=ForecastState(followed=NOTHING))
    world.station = replace(world.station, shade=shade)


def blowing(
    world: ImagerWorld, seconds: float, velocity: tuple[float, float] | None = EASTWARD
) -> None:
    for _ in range(round(seconds)):
        blows(world, velocity)
        world.surveyed.runs(1.0)


def starts(world: ImagerWorld) -> None:
    started = SurveyStarted(SURVEY_ID, ("SIM-2",), "ann", takeoff=False, person="ann")
    world.surveyed.driver.handle(started)


@flown_once
def surveying(*, allowed: bool = True, **options: object) -> ImagerWorld:
    """A survey drone at work, and an imaging drone above the middle of its field."""
    world = imager_world(1, place_m=(0.0, 0.0), height_m=118.0, **options)  # type: ignore[arg-type]
    imager = replace(world.station.imaging.imagers[IMAGER], outlook=Outlook(radians(65.0)))
    imaging = replace(world.station.imaging, imagers={IMAGER: imager})
    world.station = replace(world.station, imaging=imaging)
    world.surveyed.asks(asked(FIELD, upwind_allowed=allowed))
    blows(world, EASTWARD)
    starts(world)
    world.surveyed.runs(0.5)
    assert world.surveyed.phase() is SurveyPhase.RUNNING
    return world


def better_for_long(world: ImagerWorld) -> None:
    """The newest proposal is better, since half a minute, and one may begin."""
    motions = world.station.imager_motions
    assert motions.upwind.better_since_ns is not None
    since_ns = world.surveyed.driver.now_ns - 31_000_000_000
    start = replace(motions.start(MoveUpwind), due_ns=0)
    motions = replace(motions, upwind=replace(motions.upwind, better_since_ns=since_ns))
    world.station = replace(world.station, imager_motions=motions.with_start(MoveUpwind, start))


@flown_once
def under_way() -> ImagerWorld:
    """A move that has begun 4 s ago."""
    world = surveying()
    blowing(world, 2.0)
    better_for_long(world)
    blowing(world, 4.0)
    assert newest(world).stage is MotionStage.UPWIND
    return world


def newest(world: ImagerWorld) -> MoveUpwind:
    found = world.station.imager_motions.of(MoveUpwind)
    assert found is not None
    return found


def has_begun(world: ImagerWorld) -> bool:
    return world.station.imager_motions.of(MoveUpwind) is not None


def alarms(world: ImagerWorld) -> dict[str, str]:
    book = world.station.alarms.alarms.values()
    conditions = [alarm.condition for alarm in book if alarm.is_active]
    return {each.key: each.text for each in conditions if each.rule == "move_upwind"}


def paths(world: ImagerWorld) -> list[GoTo]:
    records = world.station.orders.records.values()
    return [
        each.command.body
        for each in records
        if each.command.serial == IMAGER and isinstance(each.command.body, GoTo)
    ]


@pytest.fixture(scope="module")
def flown() -> tuple[ImagerWorld, list[tuple[str, str]], dict[str, str]]:
    """A move from its beginning to its end; its audit, and its alarms on the way."""
    world = surveying()
    entries: list[tuple[str, str]] = []

    def observe(step: StepTaken) -> None:
        found = MOVE_UPWIND.audit(step.before, step.event, step.after, step.now_ns)
        entries.extend((each.kind, each.by) for each in found)

    world.surveyed.driver.observe = observe
    blowing(world, 38.0)
    on_the_way = alarms(world)
    blowing(world, 50.0)
    world.surveyed.driver.observe = None
    return world, entries, on_the_way


class TestFlown:
    Flown = tuple[ImagerWorld, list[tuple[str, str]], dict[str, str]]

    def test_it_hovers_upwind_and_the_operator_has_it(self, flown: Flown) -> None:
        world = flown[0]
        assert newest(world).stage is MotionStage.DONE
        east_m, north_m = world.off_m()
        assert east_m < -40.0
        assert hypot(east_m, north_m) == pytest.approx(newest(world).proposal.distance_m, abs=3.0)
        assert world.holder() is AuthorityHolder.OPERATOR
        assert world.station.control(IMAGER).stream is None
        assert alarms(world) == {}

    def test_one_goto_of_guidance_passed_the_gate(self, flown: Flown) -> None:
        world = flown[0]
        (path,) = paths(world)
        assert path.target == newest(world).place
        order = world.station.orders.records[newest(world).command_id]
        assert order.command.role is AuthorityHolder.GUIDANCE
        assert "survey field" in order.command.issued_by

    def test_it_states_what_it_costs_and_sees(self, flown: Flown) -> None:
        world, _, on_the_way = flown
        sentence = newest(world).proposal.sentence
        assert on_the_way["move_upwind:motion"].endswith(sentence)
        assert "% of its shade in 60 s" in sentence
        assert f"{newest(world).proposal.distance_m:.0f} m away" in sentence

    def test_each_stage_is_audited(self, flown: Flown) -> None:
        kinds = [kind for kind, _ in flown[1]]
        assert kinds == ["move_upwind.upwind", "move_upwind.done"]
        assert all("ann" in by for _, by in flown[1])

    @pytest.mark.flight
    def test_it_stays_while_the_wind_does_and_moves_when_it_turns(self, flown: Flown) -> None:
        world = flown[0]
        first = newest(world)
        blowing(world, 60.0, NORTHWARD)
        assert newest(world) is first  # three minutes have not passed
        blowing(world, 65.0, NORTHWARD)
        second = newest(world)
        assert second.begun_at_ns - first.begun_at_ns >= 180_000_000_000
        blowing(world, 60.0, NORTHWARD)
        assert newest(world).stage is MotionStage.DONE
        assert world.off_m()[1] < -40.0


def test_not_for_a_survey_that_does_not_allow_it() -> None:
    world = surveying(allowed=False)
    blowing(world, 15.0)
    assert not has_begun(world)
    assert world.station.imager_motions.upwind.next_job_id == 1
    assert alarms(world) == {}


def test_not_after_the_survey_was_paused() -> None:
    world = surveying()
    blowing(world, 5.0)
    better_for_long(world)
    world.surveyed.pauses()
    blowing(world, 5.0)
    assert not has_begun(world)
    assert world.station.imager_motions.upwind.survey_id is None


def test_a_wind_that_is_lost_begins_the_half_minute_anew() -> None:
    world = surveying()
    blowing(world, 22.0)
    blowing(world, 10.0, None)
    assert world.station.imager_motions.upwind.better_since_ns is None
    blowing(world, 10.0)
    assert not has_begun(world)


def test_a_refused_one_is_an_alarm_and_is_tried_again_after_a_minute() -> None:
    world = surveying()
    taken = AuthorityTaken(IMAGER, AuthorityHolder.PILOT, "bob")
    world.surveyed.driver.handle(taken)
    blowing(world, 2.0)
    better_for_long(world)
    blowing(world, 1.0)
    assert not has_begun(world)
    text = alarms(world)["move_upwind:refused"]
    assert "controlled by the pilot" in text
    assert "% of its shade in 60 s" in text
    assert world.holder() is AuthorityHolder.PILOT
    world.surveyed.driver.handle(replace(taken, holder=AuthorityHolder.OPERATOR))
    blowing(world, 56.0)
    assert not has_begun(world)
    blowing(world, 5.0)
    assert newest(world).stage is MotionStage.UPWIND
    assert "move_upwind:refused" not in alarms(world)


def test_the_gate_refuses_a_way_through_a_zone() -> None:
    """The place is free; the straight path there is not."""
    wall = Region(np.array([[-30.0, -900.0], [-20.0, -900.0], [-20.0, 900.0], [-30.0, 900.0]]))
    world = surveying(zones=(Zone("wall", ZoneKind.KEEP_OUT, wall),))
    blowing(world, 2.0)
    better_for_long(world)
    blowing(world, 1.0)
    assert not has_begun(world)
    assert "wall" in alarms(world)["move_upwind:refused"]
    assert world.holder() is AuthorityHolder.OPERATOR
    assert paths(world) == []


class TestEndedBefore:
    """Whatever ends it, the vehicle holds and nothing resumes."""

    def stays(self, world: ImagerWorld, why: str) -> None:
        blowing(world, 5.0)
        ended = newest(world)
        assert ended.stage is MotionStage.STOPPED
        assert why in ended.reason
        off_m = world.off_m()
        count = len(paths(world))
        blowing(world, 11.0)
        if world.station.imager_motions.upwind.better_since_ns is not None:
            better_for_long(world)
        blowing(world, 2.0)
        assert newest(world) is ended
        assert len(paths(world)) == count
        assert hypot(world.off_m()[0] - off_m[0], world.off_m()[1] - off_m[1]) < 1.5
        assert world.station.control(IMAGER).stream is None

    def test_by_a_hold(self) -> None:
        world = under_way()
        world.surveyed.driver.handle(OperatorOrder(9, Hover(), **PERSON))  # type: ignore[arg-type]
        self.stays(world, "hover, ordered by bob")
        assert world.holder() is AuthorityHolder.OPERATOR
        assert "m from its place" in alarms(world)["move_upwind:stopped"]
        world.surveyed.pauses()
        world.surveyed.runs(1.0)
        starts(world)
        blowing(world, 2.0)
        better_for_long(world)
        blowing(world, 1.0)
        assert newest(world).stage is MotionStage.UPWIND  # started again, it is allowed again

    def test_by_an_all_stop(self) -> None:
        world = under_way()
        world.surveyed.driver.handle(AllStopped("bob"))
        world.surveyed.driver.handle(OperatorOrder(9, Hover(), **PERSON))  # type: ignore[arg-type]
        self.stays(world, "all stop by bob")

    def test_by_its_pilot(self) -> None:
        world = under_way()
        world.surveyed.fleet.world.app(IMAGER).aircraft.pilot_takes()
        self.stays(world, "pilot")
        assert world.holder() is AuthorityHolder.PILOT

    def test_by_control_taken(self) -> None:
        world = under_way()
        taken = AuthorityTaken(IMAGER, AuthorityHolder.OPERATOR, "ann", "ann")
        world.surveyed.driver.handle(taken)
        self.stays(world, "taken over by ann")

    def test_by_the_end_of_its_survey(self) -> None:
        world = under_way()
        world.surveyed.pauses()
        self.stays(world, "its survey no longer runs")
        assert alarms(world) == {}

    def test_by_a_refused_setpoint(self) -> None:
        world = under_way()
        zone = DrawnZone(TemporaryZoneKind.PERSON, Circle(newest(world).place, 100.0), "person")
        world.surveyed.driver.handle(ZoneDrawn(zone, "bob"))
        blowing(world, 15.0)
        self.stays(world, "the gate refused its setpoint")
        assert world.holder() is AuthorityHolder.OPERATOR

    def test_by_time(self) -> None:
        world = under_way()
        slow = replace(newest(world), since_ns=newest(world).since_ns - 120_000_000_000)
        world.station = put(world.station, slow)
        self.stays(world, "not arrived within")
        holds = [
            each
            for each in world.station.orders.records.values()
            if each.command.serial == IMAGER and isinstance(each.command.body, Hover)
        ]
        assert holds[-1].phase is Phase.DONE

    def test_by_a_lost_connection(self) -> None:
        world = under_way()
        connected = world.surveyed.fleet.world.connected[IMAGER]
        world.surveyed.driver.disconnect(connected.link_id)
        blowing(world, 6.0)
        ended = newest(world)
        assert ended.stage is MotionStage.STOPPED
        world.surveyed.fleet.world.connect(connected.app)
        blowing(world, 14.0)
        better_for_long(world)
        blowing(world, 2.0)
        assert newest(world) is ended
        assert len(paths(world)) == 1


class TestNeverWithASideStep:
    def test_it_waits_for_a_side_step(self) -> None:
        world = surveying()
        blowing(world, 2.0)
        world.ordered("ann")
        better_for_long(world)
        while not world.newest().is_over:
            assert not has_begun(world)
            assert alarms(world) == {}
            blowing(world, 1.0)
        blowing(world, 2.0)
        assert newest(world).stage is MotionStage.UPWIND

    @pytest.mark.parametrize("is_asked", [True, False], ids=["asked for", "automatic"])
    def test_no_side_step_begins_during_a_move(self, is_asked: bool) -> None:
        world = under_way()
        if is_asked:
            event = SideStepOrdered("ann", person="ann")
            why = refusal(world.station, event, world.surveyed.driver.now_ns)
            assert why is not None
            assert "moves upwind already" in why.reason
            world.ordered("ann")
        else:
            record = world.surveyed.record()
            survey = replace(record.survey, side_step_allowed=True)
            surveys = world.station.surveys.put(replace(record, survey=survey))
            world.station = replace(world.station, surveys=surveys)
            world.reads_shade(0.0, 30.0)
            world.reads_shade(0.0)
        world.surveyed.runs(1.0)
        assert world.station.imager_motions.of(SideStep) is None
        assert world.station.imager_motions.start(SideStep).refused is None
        assert newest(world).stage is MotionStage.UPWIND


@pytest.mark.parametrize(
    "ordered",
    [
        lambda world: OperatorOrder(7, Hover(), **PERSON),  # type: ignore[arg-type]
        lambda world: OperatorOrder(
            7,
            GoTo(world.station.fleet.vehicles[IMAGER].position.value, 110.0, 3.0),
            **PERSON,  # type: ignore[arg-type]
        ),
    ],
    ids=["hold", "goto"],
)
def test_where_a_person_has_sent_it_there_it_stays(
    ordered: Callable[[ImagerWorld], OperatorOrder],
) -> None:
    world = surveying()
    world.surveyed.driver.handle(ordered(world))
    blowing(world, 8.0)
    better_for_long(world)
    blowing(world, 2.0)
    assert not has_begun(world)
    assert "move_upwind:refused" not in alarms(world)


def test_a_hold_of_the_station_does_not_decide_where_it_stays() -> None:
    world = surveying()
    hold = OperatorOrder(-999, Hover(), issued_by_station("separation"), IMAGER)
    world.surveyed.driver.handle(hold)
    blowing(world, 8.0)
    better_for_long(world)
    blowing(world, 2.0)
    assert newest(world).stage is MotionStage.UPWIND


def test_a_persons_hold_counts_for_longer_than_its_order_is_kept() -> None:
    world = surveying()
    world.surveyed.driver.handle(OperatorOrder(9001, Hover(), **PERSON))
    blowing(world, 3.0)
    number = 9100
    while 9001 in world.station.orders.records:
        photo = OperatorOrder(number, StartCamera(1.0), "bob", "SIM-2", person="ann")
        world.surveyed.driver.handle(photo)
        number += 1
        assert number < 9100 + 2 * world.station.settings.orders_kept
    blowing(world, 5.0)
    better_for_long(world)
    blowing(world, 3.0)
    assert not has_begun(world)
