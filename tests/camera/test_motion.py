"""The marked pose moved by telemetry."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.camera.constructions import FRAME, LEVEL, moved, tilted_pose

from recon.camera import TelemetryReference, mounted_pose
from recon.geo import geo_from_enu
from recon.model.geo import GeoPoint
from recon.model.vehicle import Attitude, Mount

MARKED = TelemetryReference(44.5, -92.9, 120.0, 30.0, 2.0, -3.0)
POSE = tilted_pose(3.0, -4.0, 118.0, (2.0, -1.0, -30.0))


def at(east_m: float, north_m: float, **changes: float) -> TelemetryReference:
    (latitude,), (longitude,), _ = geo_from_enu(FRAME, [[east_m, north_m, 0.0]])
    return replace(MARKED, latitude_deg=float(latitude), longitude_deg=float(longitude), **changes)


@pytest.mark.parametrize("mount", list(Mount))
def test_the_same_telemetry_gives_the_same_pose(mount: Mount) -> None:
    pose = moved(POSE, MARKED, MARKED, mount)
    assert np.abs(pose.rotation_enu_camera - POSE.rotation_enu_camera).max() < 1e-12
    assert np.abs(pose.position_enu_m - POSE.position_enu_m).max() < 1e-6
    assert pose.covariance is None


@given(st.floats(-500, 500), st.floats(-500, 500), st.floats(-100, 200))
def test_the_camera_moves_as_the_aircraft_does(east_m: float, north_m: float, up_m: float) -> None:
    now = at(east_m, north_m, height_above_takeoff_m=120.0 + up_m)
    pose = moved(POSE, MARKED, now, Mount.GIMBAL)
    offset = pose.position_enu_m - POSE.position_enu_m
    assert offset == pytest.approx([east_m, north_m, up_m], abs=0.002)


@pytest.mark.parametrize("mount", list(Mount))
def test_a_turn_to_the_right_swings_the_frames_top_from_north_to_east(mount: Mount) -> None:
    level = replace(MARKED, yaw_deg=0.0, pitch_deg=0.0, roll_deg=0.0)
    marked_pose = mounted_pose(level, np.array([0.0, 0.0, 120.0]))
    assert np.abs(marked_pose.rotation_enu_camera - LEVEL).max() < 1e-12
    turned = moved(marked_pose, level, replace(level, yaw_deg=90.0), mount)
    top_enu = turned.rotation_enu_camera @ [0.0, -1.0, 0.0]
    assert top_enu == pytest.approx([1.0, 0.0, 0.0], abs=1e-12)


def test_a_tilted_camera_looks_to_the_front_and_turns_with_the_aircraft() -> None:
    level = replace(MARKED, yaw_deg=0.0, pitch_deg=0.0, roll_deg=0.0)
    tilted = mounted_pose(level, np.array([0.0, 0.0, 120.0]), 20.0)
    sine, cosine = math.sin(math.radians(20.0)), math.cos(math.radians(20.0))
    assert tilted.rotation_enu_camera[:, 2] == pytest.approx([0.0, sine, -cosine], abs=1e-12)
    assert np.linalg.det(tilted.rotation_enu_camera) == pytest.approx(1.0)
    # A gimbal keeps the tilt; only the heading turns it.
    to_the_east = replace(level, yaw_deg=90.0, pitch_deg=5.0)
    axis = moved(tilted, level, to_the_east, Mount.GIMBAL).rotation_enu_camera[:, 2]
    assert axis == pytest.approx([sine, 0.0, -cosine], abs=1e-12)


def test_a_gimbal_takes_out_pitch_and_roll_and_a_fixed_mount_does_not() -> None:
    level = replace(MARKED, yaw_deg=0.0, pitch_deg=0.0, roll_deg=0.0)
    marked_pose = mounted_pose(level, np.array([0.0, 0.0, 120.0]))
    nose_up = replace(level, pitch_deg=10.0)
    axis = moved(marked_pose, level, nose_up, Mount.GIMBAL).rotation_enu_camera[:, 2]
    assert axis == pytest.approx([0.0, 0.0, -1.0], abs=1e-12)
    tenth = math.radians(10.0)
    # Nose up (towards north): a camera that looked down now looks down and forward.
    axis = moved(marked_pose, level, nose_up, Mount.FIXED).rotation_enu_camera[:, 2]
    assert axis == pytest.approx([0.0, math.sin(tenth), -math.cos(tenth)], abs=1e-12)
    # Right side down: it looks to the left.
    rolled = replace(level, roll_deg=10.0)
    axis = moved(marked_pose, level, rolled, Mount.FIXED).rotation_enu_camera[:, 2]
    assert axis == pytest.approx([-math.sin(tenth), 0.0, -math.cos(tenth)], abs=1e-12)


angles = st.floats(-180, 180)


@given(angles, angles, angles, st.sampled_from(list(Mount)))
def test_there_and_back_is_the_marked_pose(
    yaw_deg: float, pitch_deg: float, roll_deg: float, mount: Mount
) -> None:
    there = at(40.0, -70.0, yaw_deg=yaw_deg, pitch_deg=pitch_deg, roll_deg=roll_deg)
    gone = moved(POSE, MARKED, there, mount)
    back = moved(gone, there, MARKED, mount)
    assert np.abs(back.rotation_enu_camera - POSE.rotation_enu_camera).max() < 1e-9
    assert np.abs(back.position_enu_m - POSE.position_enu_m).max() < 1e-6


def test_a_report_with_everything_known_gives_a_reference() -> None:
    reference = TelemetryReference.from_report(
        GeoPoint(44.5, -92.9, 0.0), 120.0, Attitude(30.0, 2.0, -3.0)
    )
    assert reference == MARKED


@pytest.mark.parametrize("missing", ["position", "height", "attitude", "finite"])
def test_a_report_with_a_part_unknown_gives_none(missing: str) -> None:
    reference = TelemetryReference.from_report(
        None if missing == "position" else GeoPoint(44.5, -92.9, 0.0),
        None if missing == "height" else 120.0,
        None
        if missing == "attitude"
        else Attitude(math.nan if missing == "finite" else 30.0, 2.0, -3.0),
    )
    assert reference is None
