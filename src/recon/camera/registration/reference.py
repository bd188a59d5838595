"""Reference frames, and the alignment of a later frame with one of them."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from recon.camera.registration.lens_view import GreyImage, LensView, homography
from recon.camera.registration.robust_fit import fit_to_rays
from recon.camera.registration.settings import RegistrationSettings
from recon.camera.registration.tracking import choose_features, coarse_places, track
from recon.model.arrays import BoolArray, FloatArray
from recon.model.imagery import CameraPose

ENOUGH_SHARE = 0.7
"""Share of the features in view as inliers: another round of tracking finds few more."""
LEAST_SLOPE = 0.05
"""Least downward slope (sine) of a ray that meets the ground."""


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """A frame whose pose is known, and its features with their places on the ground.

    `generation` counts how often the pose was handed on since telemetry gave it.
    """

    contrast: GreyImage
    pixels: FloatArray
    ground_m: FloatArray
    pose: CameraPose
    taken_at_s: float
    generation: int


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """A frame's pose by one reference; `problem` states why it must not be used, else empty."""

    pose: CameraPose
    inliers: int
    in_view: int
    residual_m: float
    problem: str

    @property
    def inlier_share(self) -> float:
        """Return the share of the reference's features in view that are inliers."""
        return self.inliers / max(1, self.in_view)


def reference_of(
    view: LensView,
    contrast: GreyImage,
    pose: CameraPose,
    at_s: float,
    generation: int,
) -> Reference:
    """Return a frame's local contrast as a reference with this pose."""
    pixels = choose_features(view, contrast)
    rays = view.rays(pixels) @ pose.rotation_enu_camera.T
    # NaN compares as false: features beyond the lens's range go as well.
    is_used = -rays[:, 2] > np.cos(np.deg2rad(view.settings.largest_nadir_deg))
    ground_m = _ground_m(pose, rays[is_used])
    return Reference(contrast, pixels[is_used], ground_m, pose, at_s, generation)


def align(
    view: LensView, reference: Reference, contrast: GreyImage, prior: CameraPose
) -> Alignment:
    """Return the frame's pose by a reference.

    Tracking begins at telemetry's pose and near it: far tracks follow the edges of cloud shadow. If
    no pose is found, it begins where the frames correlate best, and last it looks far. A pose that
    few features support is the start of one more round, which brings in those that were lost.
    """
    settings = view.settings
    near, coarse, far = settings.near_levels, settings.coarse_levels, settings.far_levels
    warped, best = _aligned_from(view, reference, contrast, prior, prior, near)
    if best.problem:
        start = _coarse_start(view, reference, warped, prior)
        best = _better(best, _aligned_from(view, reference, contrast, start, prior, coarse)[1])
    if best.problem:
        best = _better(best, _aligned_from(view, reference, contrast, prior, prior, far)[1])
    if not best.problem and best.inlier_share < ENOUGH_SHARE:
        best = _better(best, _aligned_from(view, reference, contrast, best.pose, prior, near)[1])
    return best


def _better(first: Alignment, second: Alignment) -> Alignment:
    return second if second.inliers > first.inliers else first


def _coarse_start(
    view: LensView,
    reference: Reference,
    warped: GreyImage,
    prior: CameraPose,
) -> CameraPose:
    """Return roughly the frame's pose; `warped` is the frame as seen from the prior pose."""
    places = coarse_places(reference.contrast, warped, reference.pixels)
    rays = view.rays(places) @ homography(reference.pose, prior).T
    is_seen = np.isfinite(rays).all(axis=1)
    unit = rays[is_seen] / np.linalg.norm(rays[is_seen], axis=1, keepdims=True)
    ground_m = reference.ground_m[is_seen]
    return fit_to_rays(ground_m, unit, prior, prior, view.px_per_rad, view.settings).pose


def _aligned_from(
    view: LensView,
    reference: Reference,
    contrast: GreyImage,
    start: CameraPose,
    prior: CameraPose,
    levels: int,
) -> tuple[GreyImage, Alignment]:
    """Return the frame warped to the reference's view from `start`, and the fit."""
    settings, relation = view.settings, homography(reference.pose, start)
    maps = view.warp_map(relation)
    warped = cv2.remap(contrast, *maps, cv2.INTER_LINEAR).astype(np.uint8, copy=False)
    in_view = _in_view(view, reference.pixels, maps)
    pixels, is_found = track(reference.contrast, warped, reference.pixels, levels, settings)
    rays = view.rays(pixels) @ relation.T
    is_used = in_view & is_found & np.isfinite(rays).all(axis=1)
    rays = rays[is_used] / np.linalg.norm(rays[is_used], axis=1, keepdims=True)
    ground_m = reference.ground_m[is_used]
    count = int(in_view.sum())
    if len(rays) < settings.fewest_inliers:
        problem = (
            f"{len(rays)} of {count} features in view found again, at least "
            f"{settings.fewest_inliers} are needed"
        )
        return warped, Alignment(prior, 0, count, np.inf, problem)
    fit = fit_to_rays(ground_m, rays, start, prior, view.px_per_rad, settings)
    is_inlier = fit.residuals_px < settings.inlier_px
    residual_m = _residual_m(fit.pose, ground_m[is_inlier], rays[is_inlier], settings)
    problem = _problem(view, fit.pose, prior, pixels[is_used][is_inlier], count)
    if not problem and not residual_m < np.inf:
        problem = f"no feature within {settings.residual_within_m:g} m"
    return warped, Alignment(fit.pose, int(is_inlier.sum()), count, residual_m, problem)


def _in_view(
    view: LensView, pixels: FloatArray, maps: tuple[npt.NDArray[np.float32], ...]
) -> BoolArray:
    """Return which of the reference's features (N,) the frame can show."""
    col, row = np.rint(pixels).astype(int).T
    rows, cols = view.mask.shape
    seen_col, seen_row = (np.rint(plane[row, col]).astype(int) for plane in maps)
    is_inside = (seen_col >= 0) & (seen_col < cols) & (seen_row >= 0) & (seen_row < rows)
    shown = view.mask[np.clip(seen_row, 0, rows - 1), np.clip(seen_col, 0, cols - 1)]
    visible: BoolArray = is_inside & (shown > 0)
    return visible


def _problem(
    view: LensView, pose: CameraPose, prior: CameraPose, inliers_px: FloatArray, in_view: int
) -> str:
    """Return why a fit must not be used; empty if it may."""
    settings, count = view.settings, len(inliers_px)
    fewest = max(settings.fewest_inliers, round(settings.least_inlier_share * in_view))
    if count < fewest:
        return f"{count} of {in_view} features in view fit one pose, at least {fewest} are needed"
    is_right, is_low = (inliers_px > np.array(view.mask.shape[::-1]) / 2.0).T
    filled = np.bincount(2 * is_low + is_right, minlength=4) >= settings.quadrant_inliers
    if filled.sum() < settings.fewest_quadrants:
        return (
            f"features fit in {filled.sum()} quarters of the frame, at least "
            f"{settings.fewest_quadrants} are needed"
        )
    turn = pose.rotation_enu_camera @ prior.rotation_enu_camera.T
    turn_rad = float(np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0)))
    shift_m = float(np.linalg.norm(pose.position_enu_m - prior.position_enu_m))
    if turn_rad > settings.largest_turn_rad or shift_m > settings.largest_shift_m:
        return (
            f"the fit is {np.rad2deg(turn_rad):.0f} degrees and {shift_m:.0f} m from telemetry, at "
            f"most {np.rad2deg(settings.largest_turn_rad):.0f} degrees and "
            f"{settings.largest_shift_m:g} m are accepted"
        )
    return ""


def _ground_m(pose: CameraPose, rays_enu: FloatArray) -> FloatArray:
    """Return where rays (N, 3, ENU) meet the ground plane, (N, 3)."""
    drop = np.maximum(-rays_enu[:, 2:], LEAST_SLOPE)
    places: FloatArray = pose.position_enu_m + rays_enu * (pose.position_enu_m[2] / drop)
    return places


def _residual_m(
    pose: CameraPose, ground_m: FloatArray, rays: FloatArray, settings: RegistrationSettings
) -> float:
    """Return the median distance on the ground between features and where the pose puts them."""
    apart_m = np.hypot(*(_ground_m(pose, rays @ pose.rotation_enu_camera.T) - ground_m)[:, :2].T)
    is_near = np.hypot(*(ground_m - pose.position_enu_m)[:, :2].T) < settings.residual_within_m
    return float(np.median(apart_m[is_near])) if is_near.any() else float("inf")
