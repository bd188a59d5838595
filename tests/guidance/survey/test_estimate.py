"""What a survey will take, against what vehicles then fly and against sums by hand."""

from dataclasses import replace

import pytest
from tests.guidance.survey.fields import (
    holed,
    l_shape,
    planned,
    rectangle,
    survey_of,
)
from tests.guidance.survey.flyers import Flights, begun, fleet

from recon.guidance.survey import Surveyor
from recon.guidance.survey.estimate import Batteries, SurveyEstimate, estimate
from recon.model.airspace import Region
from recon.model.command import Refusal
from recon.model.survey import Survey

LASTS = Batteries()


def estimated(survey: Survey, count: int, batteries: Batteries = LASTS) -> SurveyEstimate:
    vehicles = [flyer.surveyor() for flyer in fleet(count)]
    made = estimate(planned(survey), vehicles, batteries)
    assert isinstance(made, SurveyEstimate), made
    return made


@pytest.mark.parametrize(
    ("over", "count", "speed_mps"), [(rectangle(), 2, 8.0), (l_shape(), 1, 6.0), (holed(), 3, 8.0)]
)
def test_the_time_of_the_rows_is_what_vehicles_then_fly(
    over: Region, count: int, speed_mps: float
) -> None:
    survey = survey_of(over, speed_mps=speed_mps)
    flights = Flights(begun(survey, fleet(count)), fleet(count), tells_shade=False)
    last_s: dict[str, float] = {}

    def note(now: Flights) -> None:
        last_s.update({each.serial: now.time_s for each in now.flyers if each.is_flying})

    flights.run(each_second=note)
    expected = estimated(survey, count)
    assert {drone.serial for drone in expected.drones} == set(last_s)
    for drone in expected.drones:
        planned_s = sum(flight.missions_s for flight in drone.flights)
        assert planned_s == pytest.approx(last_s[drone.serial], rel=0.10)


def test_every_row_is_in_one_flight_and_photos_follow_from_its_length() -> None:
    survey = survey_of(l_shape())
    made = estimated(survey, 2, Batteries(400.0))
    plan = planned(survey)
    flown = [leg.piece for d in made.drones for f in d.flights for leg in f.route]
    assert sum(piece.length_m for piece in flown) == pytest.approx(
        sum(piece.length_m for piece in plan.pieces)
    )
    lead_m, photo_m = plan.swath.lead_m, plan.swath.photo_m
    assert made.photos == sum(int((p.length_m + 2 * lead_m) // photo_m) + 1 for p in flown)
    assert made.photos_in_all > made.photos
    assert made.flown_s == pytest.approx(sum(d.flown_s for d in made.drones))


def test_a_small_battery_makes_more_flights_that_each_fit_it() -> None:
    survey = survey_of(rectangle(600.0, 300.0))
    whole = estimated(survey, 1)
    parts = estimated(survey, 1, Batteries(500.0, swap_s=100.0, landing_s=40.0))
    assert whole.batteries is None
    assert parts.batteries == len(parts.drones[0].flights) > 1
    assert all(flight.missions_s <= 500.0 for flight in parts.drones[0].flights)
    swaps_s = 100.0 * (parts.batteries - 1)
    assert parts.time_s == pytest.approx(parts.flown_s + swaps_s)
    assert parts.photos == whole.photos
    assert parts.flown_s > whole.flown_s


def test_a_battery_too_empty_for_a_row_is_changed_first() -> None:
    survey = survey_of(rectangle())
    vehicle = Surveyor("S-1", (0.0, -40.0), time_left_s=20.0)
    made = estimate(planned(survey), [vehicle], Batteries(900.0))
    assert isinstance(made, SurveyEstimate)
    assert made.batteries == 1


def test_a_region_too_far_for_any_battery_is_a_sentence() -> None:
    vehicle = Surveyor("S-1", (0.0, -3000.0))
    made = estimate(planned(survey_of(rectangle())), [vehicle], Batteries(300.0))
    assert isinstance(made, Refusal)
    assert made.reason.startswith("a full battery gives 240 s for rows, and row ")
    assert ", with the flights there and back, takes " in made.reason
    assert "take off nearer to it, divide the region, or turn the rows" in made.reason


@pytest.mark.parametrize(("left_s", "changes"), [(1200.0, 0), (30.0, 1), (0.0, 1)])
def test_a_first_battery_that_lasts_for_no_row_is_changed_before(
    left_s: float, changes: int
) -> None:
    plan = planned(survey_of(rectangle(200.0, 100.0)))
    drone = Surveyor("A", (0.0, -20.0), home_m=(0.0, -20.0), time_left_s=left_s)
    made, full = (
        estimate(plan, [replace(drone, time_left_s=each)], Batteries(1200.0, swap_s=180.0))
        for each in (left_s, 1200.0)
    )
    assert isinstance(made, SurveyEstimate)
    assert isinstance(full, SurveyEstimate)
    assert made.time_s == pytest.approx(full.time_s + 180.0 * changes)
    assert made.batteries == 1
