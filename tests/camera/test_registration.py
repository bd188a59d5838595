"""Registration: frames of known poses, found by their content. Truth by construction."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.camera.constructions import tilted_pose
from tests.camera.registered_scenes import (
    CAMERA,
    CIRCLE,
    FIELD,
    VIEW,
    displacements_m,
    field,
    pose_at,
    relation_error,
    seen,
)

from recon.camera.registration import (
    RegisteredPose,
    RegistrationSettings,
    RegistrationState,
    step,
    view_of,
)
from recon.camera.registration.robust_fit import fit_to_rays
from recon.model.imagery import CameraPose, Registration, RgbImage

SETTINGS = RegistrationSettings()
HOME = pose_at()
BLACK = np.zeros((360, 640, 3), dtype=np.uint8)
angles = st.floats(-20.0, 20.0)


class Flight:
    """Frames given one by one; telemetry shows the drone at home unless told otherwise."""

    def __init__(self) -> None:
        self.state = RegistrationState()
        self.at_s = 0.0

    def takes(
        self, rgb: RgbImage, prior: CameraPose = HOME, after_s: float = 1.0
    ) -> RegisteredPose:
        self.at_s += after_s
        self.state, found = step(VIEW, self.state, rgb, prior, self.at_s)
        return found


@pytest.fixture(scope="module")
def at_home() -> RgbImage:
    return seen(HOME)


@pytest.fixture
def flight(at_home: RgbImage) -> Flight:
    """A flight with its first reference."""
    begun = Flight()
    begun.takes(at_home)
    begun.takes(at_home)
    assert len(begun.state.references) == 1
    return begun


@given(st.tuples(angles, angles, st.floats(-180.0, 180.0)), st.tuples(angles, angles, angles))
def test_rays_of_two_poses_are_related_by_a_homography(turn_deg, moved) -> None:
    east_m, north_m, up_m = moved
    first, second = (
        tilted_pose(3.0, -4.0, 120.0, (1.0, 2.0, 30.0)),
        tilted_pose(east_m, north_m, 120.0 + up_m, turn_deg),
    )
    assert relation_error(first, second) < 1e-9


def test_the_fit_finds_the_pose_though_a_third_of_the_features_moves_together() -> None:
    """A shadow's edge: its features agree with each other, not with the land."""
    random = np.random.default_rng(5)
    ground_m = np.column_stack([random.uniform(-200, 200, (300, 2)), np.zeros(300)])
    true = pose_at(3.0, -2.0, 121.0, (1.0, -2.0, 1.5))
    shown_m = ground_m + np.where(np.arange(300)[:, None] < 100, (15.0, 4.0, 0.0), 0.0)
    rays = (shown_m - true.position_enu_m) @ true.rotation_enu_camera
    rays += random.normal(0.0, 0.0005, rays.shape) * np.linalg.norm(rays, axis=1)[:, None]
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    fit = fit_to_rays(ground_m, rays, HOME, HOME, 250.0, SETTINGS)
    assert np.median(displacements_m(fit.pose, true, HOME, HOME)) < 0.05
    assert (fit.residuals_px[:100] > SETTINGS.inlier_px).all()
    assert (fit.residuals_px[100:] < SETTINGS.inlier_px).mean() > 0.98


def test_directions_that_no_feature_fixes_stay_with_telemetry() -> None:
    ground_m = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    rays = (ground_m - HOME.position_enu_m) @ HOME.rotation_enu_camera
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    fit = fit_to_rays(ground_m, rays, HOME, pose_at(2.0, 1.0, 119.0), 250.0, SETTINGS)
    assert np.linalg.norm(fit.pose.position_enu_m - HOME.position_enu_m) < 5.0
    assert np.isfinite(fit.pose.covariance).all()


@pytest.mark.parametrize(
    "true",
    [
        pose_at(0.5, -0.4, 120.3, (0.1, -0.1, 0.1)),
        pose_at(4.0, -5.0, 121.0, (1.5, -2.0, 1.0)),
        pose_at(-3.0, 8.0, 118.0, (2.5, 3.0, -7.0)),
    ],
    ids=["hover", "wobble", "gust and compass"],
)
def test_a_frame_is_placed_to_decimetres_where_telemetry_errs_by_metres(
    flight: Flight, true: CameraPose
) -> None:
    found = flight.takes(seen(true))
    assert found.registration is Registration.REGISTERED
    off_m = displacements_m(found.pose, true, HOME, HOME)
    assert np.median(off_m) < 0.2
    assert np.percentile(off_m, 95) < 0.6
    assert found.residual_m is not None
    assert found.residual_m < 0.5


@pytest.mark.parametrize("yaw_deg", [90.0, 180.0])
def test_a_turned_drone_is_placed_as_well(flight: Flight, yaw_deg: float) -> None:
    true = pose_at(1.0, 2.0, 120.0, (0.5, -0.5, yaw_deg + 1.0))
    found = flight.takes(seen(true), pose_at(turn_deg=(0.0, 0.0, yaw_deg)))
    assert found.registration is Registration.REGISTERED
    assert np.percentile(displacements_m(found.pose, true, HOME, HOME), 95) < 0.6


def test_shade_exposure_and_noise_do_not_move_it(flight: Flight) -> None:
    """Half of the frame in shade with a soft edge, one stop darker, with noise."""
    true = pose_at(2.0, 1.0, 120.0, (0.5, 0.8, -0.5))
    shade = 1.0 - 0.45 / (1.0 + np.exp((np.arange(640) - 330) / 6.0))
    lit = seen(true) * shade[np.newaxis, :, np.newaxis] * 0.73
    noisy = lit + np.random.default_rng(2).normal(0.0, 2.0, lit.shape)
    found = flight.takes(np.clip(noisy, 0, 255).astype(np.uint8))
    assert found.registration is Registration.REGISTERED
    off_m = displacements_m(found.pose, true, HOME, HOME)
    assert np.median(off_m) < 0.2
    assert np.percentile(off_m, 95) < 0.6


def test_lost_after_three_seconds_and_found_by_itself(flight: Flight, at_home: RgbImage) -> None:
    first = flight.takes(BLACK)
    assert first.registration is Registration.UNREGISTERED
    assert "features" in first.problem
    assert first.pose is HOME
    statuses = [flight.takes(BLACK).registration for _ in range(3)]
    assert statuses == [Registration.UNREGISTERED, Registration.UNREGISTERED, Registration.LOST]
    found = flight.takes(at_home)
    assert found.registration is Registration.REGISTERED
    assert found.problem == ""


def test_another_field_is_rejected_not_fitted(flight: Flight) -> None:
    found = flight.takes(seen(HOME, field(2)))
    assert found.registration is Registration.UNREGISTERED
    assert "at least" in found.problem


def test_lost_for_long_it_begins_anew_and_returns_to_the_first_reference(
    flight: Flight, at_home: RgbImage
) -> None:
    elsewhere = seen(HOME, field(2))
    for _ in range(31):
        found = flight.takes(elsewhere)
    assert found.registration is Registration.LOST or "becomes the reference" in found.problem
    flight.takes(elsewhere)
    assert len(flight.state.references) == 2
    assert flight.takes(elsewhere).registration is Registration.REGISTERED
    flight.takes(at_home)
    assert flight.takes(at_home).registration is Registration.REGISTERED
    assert flight.state.used == 0


def test_a_changed_field_is_handed_on_and_the_oldest_reference_that_fits_is_preferred(
    flight: Flight, at_home: RgbImage
) -> None:
    """Most of the land changes: the rest still fits, and its pose is handed on."""
    true = pose_at(1.0, -1.0, 120.0, (0.3, 0.2, 0.4))
    changed = FIELD.copy()
    is_new = np.arange(len(FIELD)) // 40 % 4 > 0
    changed[:, is_new] = field(4)[:, is_new]
    half, whole = seen(true, changed), seen(true, field(4))
    flight.at_s += 10.0
    first = flight.takes(half)
    assert first.registration is Registration.REGISTERED
    assert first.generation == 0
    assert len(flight.state.references) == 2
    second = flight.takes(whole)
    assert second.registration is Registration.REGISTERED
    assert second.generation == 1
    assert np.percentile(displacements_m(second.pose, true, HOME, HOME), 95) < 0.6
    for _ in range(2):
        third = flight.takes(at_home)
    assert third.generation == 0
    assert flight.state.used == 0


def test_references_are_bounded(at_home: RgbImage) -> None:
    flight = Flight()
    flight.takes(at_home)
    for seed in range(2, 8):
        strange = seen(HOME, field(seed))
        flight.takes(strange, after_s=40.0)
        flight.takes(strange)
    assert len(flight.state.references) == SETTINGS.references
    assert flight.state.used == SETTINGS.references - 1


@pytest.mark.parametrize(
    ("frame", "prior", "reason"),
    [
        (BLACK, HOME, "too dark"),
        (None, pose_at(up_m=5.0), "5 m above the ground"),
        (None, pose_at(east_m=9.0), "moving"),
    ],
)
def test_no_reference_begins_in_the_dark_near_the_ground_or_in_motion(
    at_home: RgbImage, frame: RgbImage | None, prior: CameraPose, reason: str
) -> None:
    flight = Flight()
    flight.takes(BLACK, HOME if reason != "5 m above the ground" else prior)
    found = flight.takes(at_home if frame is None else frame, prior)
    assert reason in found.problem
    assert found.pose is prior
    assert flight.state.references == ()


def test_the_same_frames_give_the_same_poses_to_the_bit(at_home: RgbImage) -> None:
    frames = [at_home, at_home, seen(pose_at(2.0, 3.0, 120.0, (1.0, 1.0, 1.0)))]
    runs = []
    for _ in range(2):
        flight = Flight()
        runs.append([flight.takes(frame).pose for frame in frames])
    for first, second in zip(*runs, strict=True):
        assert np.array_equal(first.rotation_enu_camera, second.rotation_enu_camera)
        assert np.array_equal(first.position_enu_m, second.position_enu_m)


def test_a_large_frame_is_shrunk_to_the_working_size(at_home: RgbImage) -> None:
    large = view_of(
        CAMERA.scaled_to(720, 1280), CIRCLE.scaled(2.0), RegistrationSettings(working_cols=640)
    )
    assert large.camera == CAMERA
    assert large.mask.shape == VIEW.mask.shape
    grey = large.grey(np.repeat(np.repeat(at_home, 2, axis=0), 2, axis=1))
    assert np.array_equal(grey, VIEW.grey(at_home))
    assert math.isclose(large.px_per_rad, VIEW.px_per_rad)
