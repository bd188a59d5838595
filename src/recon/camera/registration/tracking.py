"""Features of a reference frame, and where a later frame has them (Lucas-Kanade).

Frames are compared by local contrast: grey less its mean around, over its deviation around. That
takes out exposure, vignetting, the hot spot and the level of light under a cloud, and turns the
soft edge of a cloud's shadow into a faint gradient that hardly holds a feature.
"""

import cv2
import numpy as np
import numpy.typing as npt

from recon.camera.registration.lens_view import GreyImage, LensView
from recon.camera.registration.settings import RegistrationSettings
from recon.model.arrays import BoolArray, FloatArray

MIDDLE_LEVEL, LEVELS_PER_DEVIATION = 128, 40.0
"""Grey of the mean, and of one standard deviation: three fit on each side."""
STEPS, LEAST_STEP_PX = 20, 0.02
LEAST_EIGENVALUE = 1e-3
"""Least eigenvalue of a patch's gradients: flat patches hold no position."""

QUARTER = 4
COARSE_TURNS_DEG = (0.0, 2.5, -2.5, 5.0, -5.0, 7.5, -7.5, 10.0, -10.0)


def local_contrast(view: LensView, grey: GreyImage) -> GreyImage:
    """Return the frame's local contrast; `MIDDLE_LEVEL` stands for no contrast."""
    settings, mask = view.settings, view.mask
    side = (settings.contrast_px, settings.contrast_px)
    shown = cv2.bitwise_and(grey, mask)
    mean, square = cv2.boxFilter(shown, cv2.CV_32F, side), cv2.sqrBoxFilter(shown, cv2.CV_32F, side)
    # In place: allocating a megabyte for each step would take longer than the step.
    for average in (mean, square):
        cv2.multiply(average, view.mask_scale, dst=average)
    deviation = cv2.subtract(square, cv2.multiply(mean, mean), dst=square)
    np.maximum(deviation, 0.0, out=deviation)
    np.sqrt(deviation, out=deviation)
    np.add(deviation, settings.contrast_floor, out=deviation)
    contrast = cv2.subtract(shown, mean, dst=mean, dtype=cv2.CV_32F)
    cv2.divide(contrast, deviation, dst=contrast, scale=LEVELS_PER_DEVIATION)
    np.add(contrast, MIDDLE_LEVEL, out=contrast)
    levels = np.clip(contrast, 0.0, 255.0, out=contrast).astype(np.uint8)
    levels[mask == 0] = MIDDLE_LEVEL
    return levels


def choose_features(view: LensView, contrast: GreyImage) -> FloatArray:
    """Return pixels (N, 2) of corners within the rim, strongest first."""
    settings = view.settings
    corners = cv2.goodFeaturesToTrack(
        contrast,
        settings.most_features,
        settings.feature_quality,
        settings.features_apart_px,
        mask=view.inner_mask,
        blockSize=7,
    )
    if corners is None:
        return np.zeros((0, 2))
    return np.asarray(corners, dtype=np.float64).reshape(-1, 2)


def track(
    reference: GreyImage,
    frame: GreyImage,
    pixels: FloatArray,
    levels: int,
    settings: RegistrationSettings,
) -> tuple[FloatArray, BoolArray]:
    """Return where the frame has the reference's features (N, 2), and which of them it has (N,).

    `levels` is the number of halvings of both frames: how far a feature may have moved. The frame
    is warped to the reference's view already: each search begins at the feature's place.
    A feature counts that is found back from where it was found: one whose surroundings are gone
    ends anywhere near its start, and many of those would agree on a pose that is wrong.
    """
    places, is_found = _flow(reference, frame, pixels, levels, settings)
    back, is_back = _flow(frame, reference, places, levels, settings)
    is_same = np.hypot(*(back - pixels).T) < settings.back_px
    return places, is_found & is_back & is_same


def _flow(
    first: GreyImage,
    second: GreyImage,
    pixels: FloatArray,
    levels: int,
    settings: RegistrationSettings,
) -> tuple[FloatArray, BoolArray]:
    begin = np.ascontiguousarray(pixels, dtype=np.float32).reshape(-1, 1, 2)
    found, status, _ = cv2.calcOpticalFlowPyrLK(
        first,
        second,
        begin,
        begin.copy(),
        winSize=(settings.window_px, settings.window_px),
        maxLevel=levels,
        criteria=(cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, STEPS, LEAST_STEP_PX),
        flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
        minEigThreshold=LEAST_EIGENVALUE,
    )
    places = found.reshape(-1, 2).astype(np.float64)
    is_found: BoolArray = (status.ravel() > 0) & np.isfinite(places).all(axis=1)
    return places, is_found


def coarse_places(reference: GreyImage, frame: GreyImage, pixels: FloatArray) -> FloatArray:
    """Return roughly where a frame too far off for Lucas-Kanade has the features (N, 2).

    Phase correlation of the frames at a quarter of their size, the later one turned step by step: a
    tilt shifts a fisheye frame nearly as a whole, an error of yaw turns it.
    """
    small, large = (_quarter(image) for image in (reference, frame))
    size = small.shape[::-1]
    taper = cv2.createHanningWindow(size, cv2.CV_32F)
    middle = ((size[0] - 1) / 2.0, (size[1] - 1) / 2.0)
    best, places = -np.inf, pixels
    for turn_deg in COARSE_TURNS_DEG:
        turn = cv2.getRotationMatrix2D(middle, turn_deg, 1.0)
        turned = cv2.warpAffine(large, turn, size)
        shift, peak = cv2.phaseCorrelate(small, turned, taper)
        if peak > best:
            best, back = peak, cv2.invertAffineTransform(turn)
            shifted = (pixels + 0.5) / QUARTER - 0.5 + np.array(shift)
            places = (shifted @ back[:, :2].T + back[:, 2] + 0.5) * QUARTER - 0.5
    return places


def _quarter(image: GreyImage) -> npt.NDArray[np.float32]:
    size = (image.shape[1] // QUARTER, image.shape[0] // QUARTER)
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA).astype(np.float32)
    return small - np.float32(MIDDLE_LEVEL)
