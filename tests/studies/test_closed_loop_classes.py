"""The classes of violations, by constructed marks."""

import pytest
from studies.closed_loop.marks import (
    Mark,
    StationMarks,
    VehicleMarks,
    ViolationClass,
    classify,
)
from tests.oracles.flown_air import Breach

NOW_S = 100.0
PAIR = Breach("separation", ("A", "B"), "", 3.0, "12 m apart")
FENCE = Breach("fence", ("A",), "", 3.0, "3 m outside")
EMPTY = Breach("forced landing", ("A",), "", 0.0, "its battery is empty")


def known() -> VehicleMarks:
    return VehicleMarks(known_since_s=0.0)


def marked(mark: Mark, ago_s: float) -> VehicleMarks:
    vehicle = known()
    vehicle.mark(mark, NOW_S - ago_s)
    return vehicle


def class_of(
    breach: Breach, *vehicles: VehicleMarks, station: StationMarks | None = None
) -> ViolationClass:
    return classify(breach, vehicles, station or StationMarks(), NOW_S)[0]


def test_without_any_mark_it_is_the_stations() -> None:
    assert class_of(PAIR, known(), known()) is ViolationClass.STATION
    assert class_of(FENCE, known()) is ViolationClass.STATION


@pytest.mark.parametrize(
    ("mark", "expected", "window_s"),
    [
        (Mark.PILOT_FLIES, ViolationClass.PILOT, 12.0),
        (Mark.NO_TELEMETRY, ViolationClass.FAULT, 12.0),
        (Mark.NO_COMMANDS, ViolationClass.FAULT, 12.0),
        (Mark.WRONG_HEIGHT, ViolationClass.FAULT, 12.0),
        (Mark.FORCED_LANDING, ViolationClass.FAULT, 12.0),
        (Mark.GUST, ViolationClass.PHYSICS, 8.0),
    ],
)
def test_a_mark_counts_for_a_while(mark: Mark, expected: ViolationClass, window_s: float) -> None:
    assert class_of(PAIR, known(), marked(mark, window_s - 0.5)) is expected
    assert class_of(PAIR, known(), marked(mark, window_s + 0.5)) is ViolationClass.STATION


def test_where_a_pilot_left_it_stays_the_pilots() -> None:
    vehicle = marked(Mark.PILOT_FLIES, 60.0)
    vehicle.left_by_pilot = True
    assert class_of(FENCE, vehicle) is ViolationClass.PILOT


def test_known_too_shortly_is_physics() -> None:
    assert class_of(PAIR, known(), VehicleMarks(known_since_s=NOW_S - 5.0)) is (
        ViolationClass.PHYSICS
    )
    restarted = StationMarks(started_s=NOW_S - 5.0)
    assert class_of(PAIR, known(), known(), station=restarted) is ViolationClass.PHYSICS


def test_orders_that_are_always_sent_are_the_persons() -> None:
    vehicle = known()
    vehicle.is_coming_down = True
    assert class_of(FENCE, vehicle) is ViolationClass.PERSON
    assert class_of(PAIR, vehicle, known()) is ViolationClass.STATION


def test_holds_switched_off_are_the_persons() -> None:
    off = StationMarks(are_holds_off=True)
    assert class_of(PAIR, known(), known(), station=off) is ViolationClass.PERSON
    assert class_of(FENCE, known(), station=off) is ViolationClass.STATION


def test_an_empty_battery_is_the_persons_only_under_an_alarm() -> None:
    vehicle = known()
    assert class_of(EMPTY, vehicle) is ViolationClass.STATION
    vehicle.battery_alarm_since_s = NOW_S - 30.0
    assert class_of(EMPTY, vehicle) is ViolationClass.PERSON


def test_what_has_no_excuse() -> None:
    pilots = Breach("pilot's vehicle", ("A",), "", 1.0, "a mission")
    assert class_of(pilots, marked(Mark.PILOT_FLIES, 0.0)) is ViolationClass.STATION
    shown = Breach("shown age", ("A",), "", 1.0, "shown live")
    assert class_of(shown, marked(Mark.NO_TELEMETRY, 0.0)) is ViolationClass.STATION


def test_takeoffs_and_holds() -> None:
    takeoff = Breach("takeoff", ("A",), "", 0.0, "")
    landed = known()
    landed.landed_s = NOW_S - 0.4
    assert class_of(takeoff, landed) is ViolationClass.PHYSICS
    assert class_of(takeoff, marked(Mark.NO_TELEMETRY, 1.0)) is ViolationClass.FAULT
    assert class_of(takeoff, known()) is ViolationClass.STATION
    hold = Breach("hold", ("A",), "", 0.0, "")
    assert class_of(hold, marked(Mark.NO_COMMANDS, 0.5)) is ViolationClass.FAULT
    assert class_of(hold, known()) is ViolationClass.STATION


def test_a_place_never_sent_is_a_fault_only_of_damaged_bytes() -> None:
    shown = Breach("shown place", ("A",), "", 0.0, "a place is shown that was never sent")
    assert class_of(shown, known()) is ViolationClass.STATION
    assert class_of(shown, marked(Mark.DAMAGED, 1.0)) is ViolationClass.FAULT
    assert class_of(shown, marked(Mark.DAMAGED, 13.0)) is ViolationClass.STATION


def test_a_return_of_a_vehicle_given_to_its_pilot_is_the_persons() -> None:
    given = known()
    given.is_given_to_pilot = True
    assert class_of(PAIR, given, known()) is ViolationClass.STATION
    given.is_coming_down = True
    assert class_of(PAIR, given, known()) is ViolationClass.PERSON
    given.is_given_to_pilot = False
    assert class_of(PAIR, given, known()) is ViolationClass.STATION
