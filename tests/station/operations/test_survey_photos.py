"""A survey counts the photos that an app reports, whatever its camera's timer does.

The truth is the simulator's: where the aircraft was at each photo that was taken.
"""

from math import cos, radians, sin
from typing import NamedTuple

import numpy as np
import pytest
from tests.flown_once import flown_once
from tests.station.surveyed_world import HEIGHT_M, SurveyedWorld, surveyed_world

from recon.guidance.survey import SurveyPlan
from recon.model.arrays import BoolArray
from recon.model.survey import CellState
from recon.model.units import NS_PER_S
from recon.model.vehicle import Failsafe
from recon.sim.app.reporting import TruePhoto
from recon.station.operations.survey.conditions import RULE_PHOTOS

INTERVAL_S = 2.0
FLOWN_S = 75.0


class Moment(NamedTuple):
    """What was true, and whether photos were an alarm."""

    at_s: float
    is_on_row: bool
    is_alarm: bool


@flown_once
def flown(fault: str | None) -> tuple[SurveyedWorld, list[Moment]]:
    """A survey by one drone, and its moments, ten a second."""
    faults = () if fault is None else (f"{fault}:SIM-1",)
    world = surveyed_world(1, photo_interval_s=INTERVAL_S, faults=faults, failsafe=Failsafe.GO_HOME)
    world.asks()
    world.starts("SIM-1")
    moments = []
    for _ in range(round(10 * FLOWN_S)):
        world.runs(0.1)
        is_alarm = any(rule == RULE_PHOTOS for rule, _ in world.fleet.alarms())
        moments.append(Moment(world.driver.now_ns / NS_PER_S, is_on_row(world), is_alarm))
    return world, moments


def is_on_row(world: SurveyedWorld) -> bool:
    """Whether the aircraft truly flies along a row, over the region."""
    plan = world.state().plan
    motion = world.fleet.world.app("SIM-1").aircraft.motion
    east_m, north_m, _ = world.fleet.place_m("SIM-1")
    course = radians(plan.lattice.bearing_deg)
    along_mps = motion.velocity_east_mps * sin(course) + motion.velocity_north_mps * cos(course)
    across_mps = motion.velocity_east_mps * cos(course) - motion.velocity_north_mps * sin(course)
    is_inside = 0.0 < east_m < 120.0 and 0.0 < north_m < 60.0
    is_along = abs(along_mps) > 1.0 and abs(across_mps) < 0.2 * abs(along_mps)
    return is_inside and is_along and abs(motion.height_m - HEIGHT_M) < 4.0


def taken(world: SurveyedWorld) -> list[TruePhoto]:
    reporter = world.fleet.world.app("SIM-1").reporter
    assert reporter is not None
    return reporter.taken


def shown(world: SurveyedWorld, photos: list[TruePhoto], less_m: float) -> BoolArray:
    """Cells on photos that were taken along rows at the survey's height, edges taken off."""
    plan: SurveyPlan = world.state().plan
    camera, cells = plan.survey.camera, plan.cells
    on_one = np.zeros(cells.is_inside.shape, dtype=np.bool_)
    pad_east_m, pad_north_m = world.fleet.pads_m["SIM-1"]
    for photo in photos:
        turned = radians(photo.yaw_deg - plan.lattice.bearing_deg)
        if abs(photo.height_m - HEIGHT_M) > 4.0 or abs(sin(turned)) > 0.27 * abs(cos(turned)):
            continue
        place_m = photo.east_m + pad_east_m, photo.north_m + pad_north_m
        ((along_m, across_m),) = plan.lattice.along_across_m([place_m])
        on_one |= (
            (np.abs(cells.along_m - along_m) <= camera.along_m(HEIGHT_M) / 2.0 - less_m)
            & (np.abs(cells.across_m - across_m) <= plan.counted_swath.half_across_m - less_m + 3.0)
            & cells.is_inside
        )
    return on_one


FAULTS = [None, "photo-timer-fails", "photo-timer-skips", "photo-timer-late"]


@pytest.mark.parametrize("fault", FAULTS)
def test_what_counts_is_on_photos_and_what_is_on_photos_counts(fault: str | None) -> None:
    world, _ = flown(fault)
    counted = world.state().progress.state >= CellState.IN_SHADE
    photos = taken(world)
    settled = [each for each in photos if each.at_ns < world.driver.now_ns - 5 * NS_PER_S]
    assert counted.sum() > 100
    assert (counted & ~shown(world, photos, 0.0)).sum() == 0
    assert (shown(world, settled, 5.0) & ~counted).sum() == 0


def silent_s(world: SurveyedWorld, moments: list[Moment]) -> list[float]:
    """How long no photo was taken on a row, at each moment; 0 beside rows."""
    shots_s = [each.at_ns / NS_PER_S for each in taken(world)]
    found, row_since_s = [], None
    for moment in moments:
        row_since_s = (row_since_s or moment.at_s) if moment.is_on_row else None
        newest_s = max((shot for shot in shots_s if shot <= moment.at_s), default=0.0)
        since_s = max(newest_s, row_since_s or 0.0)
        found.append(0.0 if row_since_s is None else moment.at_s - since_s)
    return found


def test_a_timer_that_runs_is_no_alarm() -> None:
    assert not any(moment.is_alarm for moment in flown(None)[1])


@pytest.mark.parametrize("fault", FAULTS[1:])
def test_a_timer_that_takes_none_is_an_alarm_within_two_intervals(fault: str) -> None:
    world, moments = flown(fault)
    silent = silent_s(world, moments)
    overdue = [m for m, gap_s in zip(moments, silent, strict=True) if gap_s >= 2.0 * INTERVAL_S]
    assert all(moment.is_alarm for moment in overdue)
    # For the station a row ends up to 1.2 s later: its lead beyond the region, and telemetry's age.
    begun = [
        max(silent[k - 12 : k + 1])
        for k in range(12, len(moments))
        if moments[k].is_alarm and not moments[k - 1].is_alarm
    ]
    assert begun
    assert all(INTERVAL_S < gap_s <= 2.0 * INTERVAL_S for gap_s in begun)


def test_a_plain_app_counts_as_before() -> None:
    world = surveyed_world(1)
    world.asks()
    world.starts("SIM-1")
    world.runs(40.0)
    assert (world.state().progress.state >= CellState.IN_SHADE).sum() > 100
    assert world.record().photo_watches == {}
