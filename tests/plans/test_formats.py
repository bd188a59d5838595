"""What formats hold, how flights become files, and what is refused."""

import itertools
from dataclasses import replace
from math import nan
from pathlib import Path
from xml.etree import ElementTree

import pytest
from tests.plans.readers import read_litchi, read_qgc, read_waypoints, read_wpml
from tests.plans.surveyed import flights, survey_plan

from recon.plans.aircraft import aircraft_named
from recon.plans.features import CANNOT, FlightFeature, FormatName, NotHeld, by_hand, features_of
from recon.plans.flight_plan import AtEnd, ExportedPlan, PhotoTrigger, PlanExportError
from recon.plans.formats import FileFacts, exported, format_of
from recon.plans.parts import parts_of

STATED = FileFacts(1_700_000_000_000, aircraft_named("Mavic 3E", None))
FLY = FileFacts(1_700_000_000_000, aircraft_named("DJI Fly", None))


def long_flight(rows: int, points_a_row: int = 2) -> ExportedPlan:
    """Return the triangle's flight with many rows."""
    (plan,) = flights("triangle")
    first = plan.waypoints[0]
    waypoints = tuple(
        replace(first, latitude_deg=first.latitude_deg + 1e-4 * k, gimbal_pitch_deg=None)
        for k in range(rows * points_a_row)
    )
    ends = tuple((points_a_row * k, points_a_row * (k + 1) - 1) for k in range(rows))
    start = replace(waypoints[0], gimbal_pitch_deg=-90.0)
    return replace(plan, waypoints=(start, *waypoints[1:]), rows=ends)


@pytest.mark.parametrize("name", FormatName)
def test_what_a_file_holds_is_in_it_and_the_rest_is_said(name: FormatName, tmp_path: Path) -> None:
    (plan,) = flights("rectangle")
    found = exported(name, [plan], "field", STATED)
    (data,) = found.files.values()
    said = " ".join(found.by_hand)
    held = features_of(plan) - CANNOT[name].keys()
    if name in (FormatName.KML, FormatName.GPX):
        assert held == set()
        return
    readers = {
        FormatName.WPML: read_wpml,
        FormatName.LITCHI: read_litchi,
        FormatName.WAYPOINTS: lambda data: read_waypoints(data, tmp_path),
    }
    read = readers.get(name, read_qgc)(data)
    first = read.waypoints[0]
    assert (first.height_above_takeoff_m, first.speed_mps) == pytest.approx((35.0, 5.0))
    assert first.gimbal_pitch_deg == -90.0
    assert (read.every_s == 2.0) == (FlightFeature.PHOTO_TIMER in held)
    assert (read.every_m is not None) == (name is FormatName.QGC_SURVEY)
    assert read.returns is (True if FlightFeature.RETURN_HOME in held else None)
    assert ("return home" in said) == (FlightFeature.LOST_SIGNAL not in held)


def test_a_survey_items_photos_are_as_far_apart_as_the_timers() -> None:
    (plan,) = flights("rectangle")
    found = exported(FormatName.QGC_SURVEY, [plan], "field", STATED)
    (data,) = found.files.values()
    assert read_qgc(data).every_m == pytest.approx(2.0 * 5.0)
    assert "one every 10.0 m, which is 2 s at 5 m/s" in " ".join(found.by_hand)


@pytest.mark.parametrize("name", [FormatName.QGC_MISSION, FormatName.WAYPOINTS, FormatName.LITCHI])
def test_photos_by_distance_and_stays_are_read_back(name: FormatName, tmp_path: Path) -> None:
    (plan,) = flights("rectangle")
    stays = replace(plan.waypoints[1], loiter_s=3.0, speed_mps=4.0)
    waypoints = (plan.waypoints[0], stays, *plan.waypoints[2:])
    plan = replace(plan, waypoints=waypoints, photos=PhotoTrigger(every_m=7.5))
    (data,) = exported(name, [plan], "field", STATED).files.values()
    read = {
        FormatName.QGC_MISSION: read_qgc,
        FormatName.WAYPOINTS: lambda data: read_waypoints(data, tmp_path),
        FormatName.LITCHI: read_litchi,
    }[name](data)
    assert (read.every_s, read.every_m) == (None, 7.5)
    assert [each.loiter_s for each in read.waypoints[:3]] == [None, 3.0, None]
    assert [each.speed_mps for each in read.waypoints[:3]] == [5.0, 4.0, 5.0]


def test_every_flight_of_every_drone_has_a_file_of_its_name() -> None:
    several = flights("bay", drones=2, level_s=90.0)
    assert len(several) > 2
    found = exported(FormatName.WAYPOINTS, several, "bay", STATED)
    assert next(iter(found.files)) == "bay-drone-1-flight-1.waypoints"
    assert len(found.files) == len(several)
    assert list(exported(FormatName.KML, several, "bay", STATED).files) == ["bay.kml"]


def test_flights_whose_names_make_the_same_file_have_numbers() -> None:
    (plan,) = flights("triangle")
    same = [replace(plan, name="drone 1, flight 1"), replace(plan, name="drone-1 flight 1")]
    files = exported(FormatName.LITCHI, same, "a", STATED).files
    assert list(files) == ["a-drone-1-flight-1.csv", "a-drone-1-flight-1-2.csv"]


@pytest.mark.parametrize(
    ("name", "stated", "most"), [(FormatName.LITCHI, STATED, 99), (FormatName.WPML, FLY, 200)]
)
def test_three_hundred_waypoints_are_cut_between_rows(
    name: FormatName, stated: FileFacts, most: int
) -> None:
    plan = long_flight(150)
    found = exported(name, [plan], "long", stated)
    assert all("-part-" in each for each in found.files)
    assert max(found.waypoints.values()) <= most
    read = [
        read_litchi(d) if name is FormatName.LITCHI else read_wpml(d) for d in found.files.values()
    ]
    joined = list(itertools.chain.from_iterable(each.waypoints for each in read))
    assert [w.latitude_deg for w in joined] == pytest.approx(
        [w.latitude_deg for w in plan.waypoints], abs=1e-8
    )
    # Each part begins on the ground, and turns its camera down again.
    assert all(each.waypoints[0].gimbal_pitch_deg == -90.0 for each in read)


def test_a_row_longer_than_a_program_holds_is_refused() -> None:
    with pytest.raises(PlanExportError, match=r"Litchi holds 99 waypoints, and one row has 120"):
        exported(FormatName.LITCHI, [long_flight(2, 120)], "long", STATED)


def test_parts_are_as_few_as_whole_rows_allow() -> None:
    parts = parts_of(long_flight(7), 6, "it")
    assert [len(part.waypoints) for part in parts] == [6, 6, 2]
    assert [part.rows[0] for part in parts] == [(0, 1)] * 3
    assert parts_of(long_flight(3), 6, "it") == (long_flight(3),)


def test_dji_fly_is_told_to_set_the_timer_and_gets_no_photos() -> None:
    (plan,) = flights("triangle")
    found = exported(FormatName.WPML, [plan], "field", FLY)
    (data,) = found.files.values()
    assert read_wpml(data).every_s is None
    assert "set the camera's timer to 2.0 s" in found.by_hand[-1]


@pytest.mark.parametrize(
    ("name", "change", "expected"),
    [
        (FormatName.KML, "slope", r"\.kml cannot hold heights that follow the ground: .*write"),
        (FormatName.GPX, "slope", "no heights above takeoff"),
        (FormatName.WAYPOINTS, "curved", r"\.waypoints cannot hold curved turns"),
        (FormatName.QGC_SURVEY, "stays", "a survey item has no stays"),
        (FormatName.GPX, "stays", "no stays"),
    ],
)
def test_what_would_be_flown_wrong_is_refused(name: FormatName, change: str, expected: str) -> None:
    (plan,) = flights("rectangle")
    first, *rest = plan.waypoints
    changed = {
        "slope": replace(plan, waypoints=(replace(first, height_above_takeoff_m=36.0), *rest)),
        "curved": replace(plan, curved=True),
        "stays": replace(plan, waypoints=(replace(first, loiter_s=2.0), *rest)),
    }[change]
    with pytest.raises(PlanExportError, match=expected):
        exported(name, [changed], "field", STATED)


def test_curved_turns_are_litchis_curve_sizes() -> None:
    (plan,) = flights("rectangle")
    waypoints = tuple(replace(each, corner_radius_m=6.0) for each in plan.waypoints)
    (data,) = exported(
        FormatName.LITCHI, [replace(plan, waypoints=waypoints, curved=True)], "f", STATED
    ).files.values()
    sizes = [line.split(",")[4] for line in data.decode().splitlines()[1:]]
    assert sizes == ["0.000", *["6.000"] * (len(waypoints) - 2), "0.000"]


def test_silly_plans_are_refused_in_a_sentence() -> None:
    (plan,) = flights("triangle")
    first, *rest = plan.waypoints
    for waypoints, expected in (
        ((first,), "expected at least 2 waypoints, got 1"),
        ((replace(first, latitude_deg=nan), *rest), "waypoint 1: expected a latitude"),
        ((replace(first, speed_mps=0.0), *rest), "expected a speed of 0.1 to 15 m/s, got 0"),
        ((replace(first, height_above_takeoff_m=9e9), *rest), "height above takeoff of -200"),
    ):
        for name in FormatName:
            with pytest.raises(PlanExportError, match=expected):
                exported(name, [replace(plan, waypoints=waypoints)], "f", STATED)
    with pytest.raises(PlanExportError, match="no rows to write"):
        exported(FormatName.KML, [], "f", STATED)
    for wrong in ({}, {"every_s": 0.0}, {"every_s": 1.0, "every_m": 1.0}, {"every_m": nan}):
        with pytest.raises(ValueError, match="seconds or metres above 0"):
            PhotoTrigger(**wrong)


def test_a_survey_item_needs_one_area() -> None:
    (plan,) = flights("triangle")
    assert plan.ground is not None
    with pytest.raises(PlanExportError, match=r"has one area, and these rows are 0: write \.plan"):
        exported(FormatName.QGC_SURVEY, [replace(plan, ground=None)], "f", STATED)


def test_names_with_markup_or_control_characters_are_text() -> None:
    (plan,) = flights("triangle")
    hostile = replace(plan, title="<a>&\x00\n", name="../../x <b>,\x01 flight 1")
    for name in (FormatName.KML, FormatName.GPX):
        (data,) = exported(name, [hostile], "f", STATED).files.values()
        root = ElementTree.fromstring(data)
        texts = {each.text for each in root.iter() if each.tag.endswith("}name")}
        assert "../../x <b>, flight 1" in texts
    files = exported(FormatName.LITCHI, [hostile, plan], "f", STATED).files
    assert next(iter(files)) == "f-x-b-flight-1.csv"


def test_rows_are_found_among_the_waypoints() -> None:
    (plan,) = flights("bay")
    assert len(plan.rows) == len(survey_plan("bay").pieces)
    assert plan.rows[0][0] == 0
    assert plan.rows[-1][1] == len(plan.waypoints) - 1
    assert all(a[1] < b[0] for a, b in itertools.pairwise(plan.rows))


def test_the_longest_suffix_counts() -> None:
    assert format_of("north.survey.plan") is FormatName.QGC_SURVEY
    assert format_of("north.PLAN") is FormatName.QGC_MISSION
    with pytest.raises(PlanExportError, match=r"expected a file named \.kmz, \.plan"):
        format_of("north.doc")


def test_every_sentence_can_be_said() -> None:
    (plan,) = flights("triangle")
    for name, photos, at_end in itertools.product(
        FormatName, (None, PhotoTrigger(every_s=2.0), PhotoTrigger(every_m=5.0)), AtEnd
    ):
        for sentence in by_hand(name, [replace(plan, photos=photos, at_end=at_end)]):
            assert "{" not in sentence
    refusals = [r for row in CANNOT.values() for r in row.values() if isinstance(r, NotHeld)]
    assert refusals
