"""Automatic side-steps: only for a survey that allows them, while light is mostly unknown."""

from math import hypot

from tests.flown_once import flown_once
from tests.station.imager_world import IMAGER, ImagerWorld, imager_world
from tests.station.surveyed_world import asked

from recon.guidance.side_step import SIDE_STEP_SETTINGS
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken
from recon.model.survey import SurveyPhase
from recon.station.operations.imager_motion.side_step import begin_if_due
from recon.station.operations.imager_motion.unknown_light import unknown_for_long
from recon.station.recording.keyframe import without_recorded
from recon.station.state.imager_motion import MotionStage, SideStep


@flown_once
def surveying(*, allowed: bool = True) -> ImagerWorld:
    """A survey drone at work, and an imaging drone that hovers away from the rows."""
    world = imager_world(1, place_m=(60.0, 200.0))
    world.surveyed.asks(asked(side_step_allowed=allowed))
    world.surveyed.starts("SIM-2")
    world.surveyed.runs(0.5)
    assert world.surveyed.phase() is SurveyPhase.RUNNING
    return world


def reads(world: ImagerWorld, known_share: float, *ages_s: float) -> None:
    """Shade maps captured so long ago, the oldest first; then a moment for the station."""
    for age_s in ages_s:
        world.reads_shade(known_share, age_s)
    world.surveyed.runs(0.2)


def has_begun(world: ImagerWorld) -> bool:
    return world.station.imager_motions.of(SideStep) is not None


def give_to(world: ImagerWorld, holder: AuthorityHolder) -> None:
    world.surveyed.driver.handle(AuthorityTaken(IMAGER, holder, "bob"))


def test_after_twenty_seconds_of_unknown_light() -> None:
    world = surveying()
    reads(world, 0.2, 19.0, 10.0, 0.0)
    assert not has_begun(world)
    world.surveyed.runs(2.0)
    reads(world, 0.2, 0.0)
    assert "survey field" in world.newest().by
    assert "side-steps for its survey" in world.alarms()["side_step:motion"]
    world.surveyed.runs(26.0)
    reads(world, 0.2, 0.0)
    assert world.newest().stage is MotionStage.DONE
    assert hypot(*world.off_m()) < 2.0
    assert world.holder() is AuthorityHolder.OPERATOR


def test_not_without_permission() -> None:
    world = surveying(allowed=False)
    reads(world, 0.0, 90.0, 0.0)
    assert not has_begun(world)
    assert world.alarms() == {}


def test_not_while_light_is_mostly_known() -> None:
    world = surveying()
    reads(world, 0.6, 90.0, 0.0)
    assert not has_begun(world)


def test_known_light_in_between_starts_the_time_anew() -> None:
    world = surveying()
    world.reads_shade(0.0, 30.0)
    world.reads_shade(0.9, 15.0)
    reads(world, 0.0, 14.0, 0.0)
    assert not has_begun(world)


def test_not_on_an_old_shade_map() -> None:
    """Without new maps nothing is known of now; there is an alarm of its own for that."""
    world = surveying()
    reads(world, 0.0, 90.0, 11.0)
    assert not has_begun(world)


def test_not_after_the_survey_has_paused() -> None:
    world = surveying()
    world.surveyed.pauses()
    reads(world, 0.0, 90.0, 0.0)
    assert not has_begun(world)


def test_not_again_within_five_minutes() -> None:
    world = surveying()
    reads(world, 0.0, 90.0, 0.0)
    world.surveyed.runs(26.0)
    first = world.newest()
    assert first.stage is MotionStage.DONE
    reads(world, 0.0, 0.0)
    assert world.newest() is first
    due_s = (world.station.imager_motions.start(SideStep).due_ns - first.begun_at_ns) / 1e9
    assert due_s == 300.0


def test_a_refused_one_is_an_alarm_and_is_tried_again_after_a_minute() -> None:
    world = surveying()
    give_to(world, AuthorityHolder.PILOT)
    reads(world, 0.0, 90.0, 0.0)
    assert not has_begun(world)
    assert "controlled by the pilot" in world.alarms()["side_step:refused"]
    assert world.holder() is AuthorityHolder.PILOT
    give_to(world, AuthorityHolder.OPERATOR)
    world.surveyed.runs(58.0)
    reads(world, 0.0, 0.0)
    assert not has_begun(world)
    world.surveyed.runs(2.0)
    reads(world, 0.0, 0.0)
    assert has_begun(world)
    assert "side_step:refused" not in world.alarms()


def test_the_alarm_of_a_refused_one_ends_with_the_unknown_light() -> None:
    world = surveying()
    give_to(world, AuthorityHolder.PILOT)
    reads(world, 0.0, 90.0, 0.0)
    assert "side_step:refused" in world.alarms()
    reads(world, 1.0, 0.0)
    assert "side_step:refused" not in world.alarms()


def test_a_pilot_ends_it_and_it_does_not_begin_again() -> None:
    world = surveying()
    reads(world, 0.0, 90.0, 0.0)
    world.surveyed.runs(3.0)
    world.surveyed.fleet.world.app(IMAGER).aircraft.pilot_takes()
    world.surveyed.runs(3.0)
    reads(world, 0.0, 0.0)
    assert world.newest().stage is MotionStage.STOPPED
    assert world.holder() is AuthorityHolder.PILOT
    assert world.alarms() == {}


def test_a_record_is_played_on_from_a_keyframe_which_holds_no_maps() -> None:
    world = surveying()
    reads(world, 0.2, 30.0, 10.0, 0.0)
    station = without_recorded(world.station)
    assert station.imager_motions.unknown_since_ns
    assert not station.shade.own
    now_ns = world.surveyed.driver.now_ns
    assert unknown_for_long(station, now_ns, SIDE_STEP_SETTINGS) is None
    assert begin_if_due(station, now_ns, SIDE_STEP_SETTINGS)[1] == ()
