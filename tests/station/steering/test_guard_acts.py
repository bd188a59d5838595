"""What the guard did automatically is an alarm here, and ends the orders that it held against."""

from tests.station.station_world import World
from tests.station.steered_world import SERIAL, steered

from recon.model.command import Phase
from recon.model.event import GuardActed
from recon.station.host.guard_line import link_pictures

WHY = "the station was silent for 1 s"


def alarm_texts(world: World) -> list[str]:
    alarms = world.driver.station.alarms.alarms.values()
    return [alarm.condition.text for alarm in alarms if alarm.condition.rule == "guard"]


def test_a_goto_that_the_guard_held_against_ends_with_a_hold() -> None:
    s = steered()
    order = s.goto(200.0)
    s.run_for(6.0)
    held_at_s = s.now_s
    s.w.driver.handle(GuardActed(WHY, (SERIAL,), ("Drone 1",), (), None))
    s.run_for(10.0)
    assert s.phase(order) is Phase.FAILED
    assert WHY in s.note(order)
    assert s.moving_sticks(held_at_s + 0.2) == []
    assert s.hovers(held_at_s)
    assert alarm_texts(s.w) == [
        f"The guard held Drone 1: {WHY}. Check every vehicle before you give orders"
    ]


def test_others_are_steered_on() -> None:
    s = steered()
    order = s.goto(200.0)
    s.run_for(6.0)
    s.w.driver.handle(GuardActed(WHY, ("SIM-9",), (), ("Drone 9",), None))
    s.run_for(4.0)
    assert s.stream is not None
    assert not s.phase(order).is_final
    assert "could not hold Drone 9" in alarm_texts(s.w)[0]


def test_a_persons_all_stop_there_names_the_person() -> None:
    s = steered()
    s.w.driver.handle(GuardActed("all stop at the guard", (SERIAL,), ("Drone 1",), (), "ann"))
    assert "all stop at the guard by ann" in alarm_texts(s.w)[0]


def test_the_guards_picture_shows_what_is_steered() -> None:
    s = steered()

    def picture() -> tuple[str | None, bool | None, bool]:
        (link,) = link_pictures(s.w.driver.station, s.w.driver.now_ns)
        return link.serial, link.is_flying, link.is_steered

    assert picture() == (SERIAL, True, False)
    s.goto(200.0)
    s.run_for(2.0)
    assert picture() == (SERIAL, True, True)
    s.holder_goes()
    s.run_for(5.0)
    assert picture() == (SERIAL, True, False)
