"""Which pieces of a path keep to a column of takeoff or landing, at its very edges."""

from dataclasses import replace

import numpy as np
import pytest
from tests.safety.fenced import FRAME, airspace, flier, here

from recon.model.vehicle import Failsafe
from recon.safety.heights import columns
from recon.safety.path.pieces import Departure, Kind, PathVolume, block
from recon.safety.settings import FenceSettings, SafetySettings

SETTINGS = FenceSettings(column_radius_m=5.0, not_worse_m=0.25, stop_slack_m=2.0)
HOME_M = np.array([0.0, 0.0, 0.0])
HERE_M = np.array([100.0, 0.0, 10.0])


def keeps_to_a_column(
    east_m: float, north_m: float, low_m: float, *, is_entry: bool = False, is_stop: bool = False
) -> bool:
    """Whether a leg does that begins 100 m east of home, 10 m high, or at home."""
    begin_m = HERE_M[:2] if is_entry else HOME_M[:2]
    end_m = begin_m + np.array([east_m, north_m])
    piece = block(
        Kind.FLIGHT,
        np.array([[begin_m, end_m, end_m]]),
        np.array([low_m]),
        np.array([low_m]),
        ("leg",),
        is_entry=np.array([is_entry]),
    )
    vehicle = flier(100.0, 0.0, 10.0)
    departure = Departure(FRAME, HERE_M, HOME_M, (60.0, 60.0), Failsafe.GO_HOME, vehicle)
    settings = SafetySettings(fences=SETTINGS)
    situation = replace(here(airspace(), vehicle), settings=settings)
    return bool(columns(PathVolume(piece, departure), situation, is_stop)[0])


@pytest.mark.parametrize("is_entry", [False, True])
@pytest.mark.parametrize(
    ("east_m", "north_m", "is_near"), [(5.0, 0.0, True), (3.0, 4.0, True), (3.01, 4.0, False)]
)
def test_a_column_is_as_wide_as_its_radius(
    east_m: float, north_m: float, is_near: bool, is_entry: bool
) -> None:
    assert keeps_to_a_column(east_m, north_m, 10.0, is_entry=is_entry) is is_near


@pytest.mark.parametrize(
    ("low_m", "is_stop", "is_column"),
    [(9.75, False, True), (9.74, False, False), (8.0, True, True), (7.99, True, False)],
)
def test_one_where_the_vehicle_is_goes_as_low_as_the_slack(
    low_m: float, is_stop: bool, is_column: bool
) -> None:
    assert keeps_to_a_column(0.0, 0.0, low_m, is_entry=True, is_stop=is_stop) is is_column
