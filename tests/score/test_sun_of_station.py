"""The station computes the sun that lights the simulated frames."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.score.scenes import SMALL, small
from tests.station.imagers import imager_of

from recon.score import StationRun
from recon.score.scenario_sky import sky_of
from recon.site import Site

START = "start_utc = 2025-06-20T16:00:00Z"


@pytest.mark.parametrize(
    ("start", "is_locked"), [(START, False), ("start_utc = 2025-09-02T21:30:00Z", True)]
)
def test_the_suns_direction_and_the_locked_exposure_come_with_each_ground_image(
    tmp_path: Path, start: str, is_locked: bool
) -> None:
    scenario = small(tmp_path, SMALL.replace(START, start))
    methods = replace(scenario.methods, detection="brightness_ratio")
    flown = StationRun(
        replace(scenario, methods=methods, site=with_exposure(scenario.site, is_locked)), 3
    )
    while imager_of(flown.driver.station).ground_image is None:
        flown.advance_a_second()
    image = imager_of(flown.driver.station).ground_image
    assert image is not None
    assert image.exposure_locked is is_locked
    assert image.toward_sun_enu is not None
    # The capture time is estimated within a second: the sun moves by 0.004 degrees.
    truth = sky_of(scenario, 3).sun_at(image.captured_at_ns / 1e9).toward_enu
    apart_deg = np.degrees(np.linalg.norm(image.toward_sun_enu - truth))
    assert apart_deg < 0.001
    assert image.toward_sun_enu[2] > 0.3


def with_exposure(site: Site, is_locked: bool) -> Site:
    assert site.imager is not None
    return site.with_imager(replace(site.imager, exposure_locked=is_locked))
