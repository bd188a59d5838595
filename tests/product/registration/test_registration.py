"""Which way the top of a picture looks, and where it was taken, by photos with known poses."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.product.registration.made_photos import Card, card, flown, gimbal_off
from tests.product.registration.real_photos import timed_of

from recon.product.headings import AIRCRAFT, GIMBAL, RECORDED, signed_deg
from recon.product.registration import read_grey, register, with_headings
from recon.product.registration.heading import Run, heading_of
from recon.product.timing import TimedPhoto


def off_deg(photos: list[TimedPhoto], made: Card) -> list[float]:
    return [
        abs(signed_deg(each.view.aim.yaw_deg - true.aim.yaw_deg))
        for each, true in zip(photos, made.true, strict=True)
    ]


@pytest.mark.parametrize("wrong_deg", [53.0, 180.0])
def test_a_wrong_gimbal_is_found_out_by_neighbours_and_named_with_its_error(
    wrong_deg: float,
) -> None:
    made = card(flown(), gimbal_off(wrong_deg))
    assert made.photos[0].view.aim.yaw_deg == pytest.approx(wrong_deg)
    turned, (found,) = with_headings(made.photos, made.read)
    assert max(off_deg(turned, made)) < 3.0
    assert found.is_verified
    assert found.pairs >= 4
    (warning,) = found.warnings
    named = re.search(r"the gimbal's yaw is (\d+) degrees off", warning)
    assert named is not None
    assert float(named[1]) == pytest.approx(wrong_deg, abs=2.0)


def test_a_right_gimbal_is_used_without_a_warning() -> None:
    made = card(flown(), gimbal_off(0.0))
    turned, (found,) = with_headings(made.photos, made.read)
    assert max(off_deg(turned, made)) < 3.0
    assert found.warnings == []
    assert "within" in str(found)


def test_a_flight_line_whose_pictures_are_turned_has_its_own_offset() -> None:
    aims = [replace(aim, yaw_deg=0.0) if aim.yaw_deg else aim for aim in flown(4)[:18]]
    made = card(aims, lambda n, aim: {GIMBAL: 180.0 if 6 <= n < 12 else 0.0})
    turned, (found,) = with_headings(made.photos, made.read)
    assert max(off_deg(turned, made)) < 3.0
    assert "on some flight lines" in " ".join(found.warnings)


def test_single_photos_that_state_a_turned_yaw_are_told_by_the_other_sources() -> None:
    made = card(
        flown(),
        lambda number, aim: {
            GIMBAL: aim.yaw_deg + (180.0 if number % 5 == 0 else 0.0),
            AIRCRAFT: aim.yaw_deg + 2.0,
            RECORDED: aim.yaw_deg - 2.0,
        },
    )
    turned, (found,) = with_headings(made.photos, made.read)
    assert max(off_deg(turned, made)) < 4.0
    assert "in 3 photos the gimbal's yaw contradicts" in " ".join(found.warnings)


def test_a_wrong_field_of_view_is_found_out_and_named() -> None:
    made = card(flown(3), gimbal_off(0.0), across_deg=60.0)
    turned, (found,) = with_headings(made.photos, made.read)
    # 1.12 times the ground: tan 33 over tan 30 degrees.
    assert turned[0].view.aim.height_m == pytest.approx(1.125 * 60.0, rel=0.02)
    assert "the pictures show 1.1" in " ".join(found.warnings)


def test_a_run_of_another_scale_is_similar_ground_wrongly_matched() -> None:
    made = card(flown(4), gimbal_off(0.0))
    headings = np.array([each.view.aim.yaw_deg for each in made.photos])
    numbers = np.arange(24).reshape(4, 6)
    runs = [Run(of_line, headings[of_line], 1.0, n) for n, of_line in enumerate(numbers)]
    runs[2] = Run(numbers[2], headings[numbers[2]] + 40.0, 0.6, 2)
    found = heading_of(made.photos, np.arange(24), runs)
    assert found.lines == {}
    assert found.pairs == 15


def test_pictures_that_show_nothing_alike_leave_the_heading_unverified_and_say_so() -> None:
    made = card(flown(), gimbal_off(53.0))
    turned, (found,) = with_headings(made.photos, lambda _: np.full((180, 240), 90, np.uint8))
    assert off_deg(turned, made) == pytest.approx(off_deg(made.photos, made))
    assert not found.is_verified
    assert "unverified" in str(found)
    assert "no two neighbouring photos could be registered" in found.warnings[0]


def test_places_headings_and_field_of_all_photos_are_evened_out() -> None:
    made = card(flown(2), gimbal_off(2.0), gnss_m=0.7, across_deg=60.0)
    found = register(made.photos, made.read)
    true = np.array([(v.aim.east_m, v.aim.north_m) for v in made.true])
    before, after = (
        np.array([(v.aim.east_m, v.aim.north_m) for v in views])
        for views in ([p.view for p in made.photos], found.views)
    )
    # The mean of all photos' errors stays, and what they turn the whole by.
    assert np.hypot(*(after - true).T).mean() < 0.75
    # Between neighbours, where an error shows as a step in a mosaic.
    apart = [np.hypot(*np.diff(places - true, axis=0).T).mean() for places in (before, after)]
    assert apart[1] < 0.3 * apart[0]
    assert (
        max(
            abs(signed_deg(view.aim.yaw_deg - each.aim.yaw_deg))
            for view, each in zip(found.views, made.true, strict=True)
        )
        < 1.0
    )
    # Height and field cannot be told apart; what they show together is the true ground.
    shown = [view.aim.height_m * np.tan(np.deg2rad(view.across_deg / 2.0))
             for view in (found.views[0], made.true[0])]  # fmt: skip
    assert shown[0] == pytest.approx(shown[1], rel=0.02)
    assert found.residual_m < 0.3


def test_photos_that_cannot_be_read_keep_the_poses_that_they_state() -> None:
    made = card(flown(), gimbal_off(0.0))
    found = register(made.photos, lambda _: None)
    for view, timed in zip(found.views, made.photos, strict=True):
        assert view.aim.east_m == pytest.approx(timed.view.aim.east_m)
        assert signed_deg(view.aim.yaw_deg - timed.view.aim.yaw_deg) == pytest.approx(0.0)
    assert found.links == 0
    assert np.isnan(found.residual_m)


def test_a_real_gimbal_that_is_53_degrees_off_at_nadir_is_found_out(photos_data: Path) -> None:
    photos = timed_of(photos_data / "thermal-mavic2")
    turned, (found,) = with_headings(photos[:5], read_grey)
    assert found.off_deg[GIMBAL] == pytest.approx(-53.0, abs=3.0)
    assert found.off_deg[AIRCRAFT] == pytest.approx(0.0, abs=3.0)
    # The other half of the flight line was not looked at.
    others, (rest,) = with_headings(photos[5:], read_grey)
    assert rest.off_deg[GIMBAL] == pytest.approx(found.off_deg[GIMBAL], abs=3.0)
    assert all(86.0 < each.view.aim.yaw_deg < 94.0 for each in turned + others)


def test_real_photos_that_are_turned_over_in_their_files_are_found_out(photos_data: Path) -> None:
    # Sun and shadows of the trees agree: the top looks to 50 degrees, the gimbal says -132.
    photos = timed_of(photos_data / "beach-phantom3")
    turned, (found,) = with_headings(photos, read_grey)
    assert [each.view.aim.yaw_deg for each in turned[1:]] == pytest.approx([50.0] * 3, abs=3.0)
    assert abs(found.off_deg[GIMBAL]) == pytest.approx(178.0, abs=3.0)
