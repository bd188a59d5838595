"""Vehicles whose battery lasts for no row return to home instead of waiting in the air."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st
from tests.guidance.survey.fields import rectangle, survey_of
from tests.guidance.survey.flyers import fleet
from tests.guidance.survey.test_flown import begun

from recon.guidance.survey import NO_BATTERY, Surveyor, SurveyState, returning, step
from recon.model.survey import SurveyPhase
from recon.model.units import seconds_to_ns

FLYERS = fleet(2)
HERE = tuple(flyer.surveyor() for flyer in FLYERS)
STATE = begun(survey_of(rectangle()), FLYERS)
LASTS_S = st.floats(0.0, 2_000.0)
PLACE_M = st.tuples(st.floats(-200.0, 400.0), st.floats(-200.0, 400.0))


def with_time(*left_s: float | None) -> list[Surveyor]:
    return [replace(each, time_left_s=s) for each, s in zip(HERE, left_s, strict=True)]


def stepped(state: SurveyState, positions: list[Surveyor], at_s: float = 10.0) -> SurveyState:
    return step(state, positions, seconds_to_ns(at_s))[0]


@given(st.none() | LASTS_S, st.none() | LASTS_S, PLACE_M)
def test_no_vehicle_gets_rows_and_is_called_home_at_once(
    one_s: float | None, other_s: float | None, place_m: tuple[float, float]
) -> None:
    positions = with_time(one_s, other_s)
    positions[0] = replace(positions[0], place_m=place_m)
    after = stepped(STATE, positions)
    home = returning(after, positions)
    assert not set(home) & set(after.flights)
    assert not {each.serial for each in positions if each.time_left_s is None} & set(home)


@given(LASTS_S, st.floats(0.0, 500.0), PLACE_M)
def test_more_battery_never_calls_one_home(
    left_s: float, more_s: float, place_m: tuple[float, float]
) -> None:
    def is_called(seconds: float) -> bool:
        one = replace(HERE[0], time_left_s=seconds, place_m=place_m, home_m=(0.0, -40.0))
        return set(returning(STATE, [one])) == {one.serial}

    assert is_called(left_s) >= is_called(left_s + more_s)


def test_an_empty_battery_is_called_and_a_full_one_flies() -> None:
    positions = with_time(5.0, 2_000.0)
    after = stepped(STATE, positions)
    assert returning(after, positions) == {HERE[0].serial: NO_BATTERY}
    assert set(after.flights) == {HERE[1].serial}


def test_who_waits_for_what_others_leave_keeps_enough_for_the_route_home() -> None:
    positions = with_time(None, None)
    after = stepped(STATE, positions)
    first, second = (each.serial for each in positions)
    flights = {second: after.flights[second]}
    waits = replace(after, flights=flights, waiting={})
    settings, speed_mps = after.plan.settings, after.plan.survey.speed_mps
    transit_s = 100.0 / speed_mps + settings.route_home_waits_s
    far = replace(positions[0], place_m=(0.0, 60.0), home_m=(0.0, -40.0))
    for spare_s, called in ((1.0, ()), (-1.0, (first,))):
        left_s = (transit_s + spare_s) / settings.flight_time_share
        assert returning(waits, [replace(far, time_left_s=left_s)]) == dict.fromkeys(
            called, NO_BATTERY
        )


def test_who_cannot_fly_or_is_not_asked_is_not_called() -> None:
    empty = with_time(0.0, 0.0)
    assert returning(STATE, [replace(empty[0], is_available=False)]) == {}
    assert returning(replace(STATE, phase=SurveyPhase.PAUSED), empty) == {}
    assert returning(STATE, [replace(empty[0], serial="stranger")]) == {}
