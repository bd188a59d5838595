"""Each format's file, read by a reader of its own and flown in the simulator: the plan's flight."""

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree
from tests.plans.readers import (
    Read,
    read_by_gdal,
    read_litchi,
    read_qgc,
    read_waypoints,
    read_wpml,
)
from tests.plans.surveyed import FIELDS, flights

from recon.geo.distance import offset_north_east_m
from recon.model.arrays import FloatArray
from recon.model.geo import LatLon
from recon.model.mission import Waypoint
from recon.model.vehicle import FlightMode
from recon.plans.aircraft import aircraft_named
from recon.plans.features import FormatName
from recon.plans.formats import FileFacts, exported
from recon.sim.flight.aircraft import TICK_NS, Aircraft
from recon.sim.flight.flight_modes import PositionHold
from recon.sim.flight.kinematics import AircraftMotion
from recon.sim.flight.mission import MissionPoint

NS_PER_S = 1e9
STATED = FileFacts(1_700_000_000_000, aircraft_named("Mavic 3E", None))


def read_back(name: FormatName, data: bytes, by_hand: tuple[str, ...], folder: Path) -> Read:
    match name:
        case FormatName.WPML:
            return read_wpml(data)
        case FormatName.QGC_MISSION | FormatName.QGC_SURVEY:
            return read_qgc(data)
        case FormatName.WAYPOINTS:
            return read_waypoints(data, folder)
        case FormatName.LITCHI:
            return read_litchi(data)
    said = " ".join(by_hand)
    height_m = re.search(r"to ([\d.]+) m above takeoff", said)
    speed_mps = re.search(r"speed: set it to ([\d.]+) m/s", said)
    assert height_m
    assert speed_mps
    layer = "routes" if name is FormatName.GPX else None
    return read_by_gdal(data, layer, float(height_m[1]), float(speed_mps[1]))


def flown(waypoints: tuple[Waypoint, ...], home: LatLon) -> tuple[FloatArray, float]:
    """Return (N, 3) metres north, east and up every 50 ms, and the seconds that it took."""
    aircraft = Aircraft(0, motion=AircraftMotion(height_m=10.0), active_mode=PositionHold())
    points = tuple(
        MissionPoint(
            *offset_north_east_m(home, each),
            each.height_above_takeoff_m,
            each.speed_mps,
            loiter_s=each.loiter_s,
            gimbal_pitch_deg=each.gimbal_pitch_deg,
        )
        for each in waypoints
    )
    aircraft.fly_mission(points, is_curved=False, lands_at_end=False)
    track = []
    while aircraft.flight_mode is FlightMode.GPS_WAYPOINT:
        aircraft.advance(aircraft.now_ns + TICK_NS)
        motion = aircraft.motion
        track.append((motion.north_m, motion.east_m, motion.height_m))
        assert len(track) < 20_000, "the flight does not end"
    return np.array(track), aircraft.now_ns / NS_PER_S


@cache
def planned(field: str) -> tuple[cKDTree, float]:
    (plan,) = flights(field)
    assert plan.takeoff is not None
    track, seconds = flown(plan.waypoints, plan.takeoff)
    shares = np.linspace(0.0, 1.0, 11)[:-1, np.newaxis, np.newaxis]
    dense = track[:-1] + shares * np.diff(track, axis=0)
    return cKDTree(dense.reshape(-1, 3)), seconds


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("name", FormatName)
def test_a_file_is_flown_as_its_plan(name: FormatName, field: str, tmp_path: Path) -> None:
    (plan,) = flights(field)
    assert plan.takeoff is not None
    found = exported(name, [plan], "field", STATED)
    ((file_name, data),) = found.files.items()
    assert file_name == f"field{name.value}"
    read = read_back(name, data, found.by_hand, tmp_path)
    assert len(read.waypoints) == len(plan.waypoints) == found.waypoints[file_name]
    track, seconds = flown(read.waypoints, plan.takeoff)
    tree, planned_s = planned(field)
    off_m, _ = tree.query(track)
    assert off_m.max() < 0.1
    assert seconds == pytest.approx(planned_s, abs=1.0)


def test_a_file_of_another_height_or_speed_is_told_apart() -> None:
    (plan,) = flights("triangle")
    assert plan.takeoff is not None
    tree, planned_s = planned("triangle")
    higher = tuple(
        Waypoint(w.latitude_deg, w.longitude_deg, w.height_above_takeoff_m + 0.5, 4.5)
        for w in plan.waypoints
    )
    track, seconds = flown(higher, plan.takeoff)
    assert tree.query(track)[0].max() > 0.3
    assert seconds - planned_s > 1.0
