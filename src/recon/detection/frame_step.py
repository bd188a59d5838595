"""Steps that all methods share: check a frame, sample it on the field grid, build the shade map.

Checks reject what a camera or link defect would make look like shade: black, torn or overexposed,
repeated, out of order, or of another place. A rejected frame changes nothing.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from typing import TypeVar

import cv2
import numpy as np

from recon.camera.sight import sight2_m2
from recon.detection.cells import GREEN, CellSamples, field_grid
from recon.detection.settings import DetectionSettings
from recon.detection.state import DetectionState
from recon.model.geo import GroundGrid
from recon.model.imagery import CameraPose, GroundImage
from recon.model.shade import FloatMap, MaskMap, ShadeMap
from recon.model.units import ns_to_seconds

Sampled = TypeVar("Sampled", bound=CellSamples)


class FrameFault(Enum):
    """Why a frame was rejected."""

    OTHER_PLACE = "other_place"
    """A frame in another local frame than the field's, or outside its grid."""
    NOT_NEWER = "not_newer"
    REPEATED = "repeated"
    BLACK = "black"
    TORN = "torn"


@dataclass(frozen=True, slots=True)
class RejectedFrame:
    """A frame that was not used; the detection state is unchanged."""

    frame_id: int
    fault: FrameFault
    reason: str
    """Message for the operator: what was expected, what was received."""


def picture_fault(
    image: GroundImage, latest_ns: int | None, grid: GroundGrid, settings: DetectionSettings
) -> RejectedFrame | None:
    """Return why to reject a frame by place, time or levels, else None.

    `latest_ns` is the capture time of the last accepted frame.
    """
    if image.grid.frame != grid.frame:
        text = "expected a frame in the field's local frame, got one of another origin"
        return RejectedFrame(image.frame_id, FrameFault.OTHER_PLACE, text)
    if latest_ns is not None and image.captured_at_ns <= latest_ns:
        late_s = ns_to_seconds(latest_ns - image.captured_at_ns)
        text = f"expected a frame newer than the last one, got one taken {late_s:.1f} s before it"
        return RejectedFrame(image.frame_id, FrameFault.NOT_NEWER, text)
    return _level_fault(image, settings)


def cells_fault(
    image: GroundImage, cells: CellSamples, latest: CellSamples | None, settings: DetectionSettings
) -> RejectedFrame | None:
    """Return why to reject a frame by its cells: too few visible, or identical to the last."""
    seen_share = float(cells.seen.mean())
    if seen_share < settings.least_image:
        text = (
            f"expected a frame that shows {settings.least_image:.0%} of the field or more, got "
            f"{seen_share:.1%}"
        )
        return RejectedFrame(image.frame_id, FrameFault.OTHER_PLACE, text)
    # Sensor noise makes two real frames differ: equality means a frozen or repeated frame.
    if latest is not None and np.array_equal(cells.light, latest.light, equal_nan=True):
        text = "expected a new frame, got a copy of the last one; check whether the camera froze"
        return RejectedFrame(image.frame_id, FrameFault.REPEATED, text)
    return None


def _level_fault(image: GroundImage, settings: DetectionSettings) -> RejectedFrame | None:
    """Return why to reject a frame by its levels: black, or one level over much of the image."""
    levels = np.ascontiguousarray(image.rgb[..., GREEN])
    counted = cv2.calcHist([levels], [0], image.valid.astype(np.uint8), [256], [0, 256]).ravel()
    if counted.sum() == 0.0:
        text = "expected a frame that shows part of the field, got one without any valid pixel"
        return RejectedFrame(image.frame_id, FrameFault.OTHER_PLACE, text)
    shares = counted / counted.sum()
    # The 90th percentile: a few lit pixels do not make a black frame valid.
    bright = int(np.searchsorted(np.cumsum(shares), 0.9))
    if bright < settings.black_level:
        text = f"expected an image, got black: 90 % of it is at level {bright} of 255 or less"
        return RejectedFrame(image.frame_id, FrameFault.BLACK, text)
    level = int(np.argmax(shares))
    if shares[level] > settings.flat_share:
        text = (
            f"expected an intact image, got {shares[level]:.0%} of it at level {level} of 255: "
            "torn, or overexposed"
        )
        return RejectedFrame(image.frame_id, FrameFault.TORN, text)
    return None


def metres_per_pixel(grid: GroundGrid, pose: CameraPose, pixels_per_radian: float) -> FloatMap:
    """Return (R, C): the length of a pixel's footprint along its longer side, in metres.

    That is the side along the view (`recon.camera.sight`).
    """
    height_m = float(pose.position_enu_m[2])
    sight2 = sight2_m2(grid, pose.position_enu_m)
    coarser: FloatMap = (sight2 / (height_m * pixels_per_radian)).astype(np.float32)
    return coarser


def take_frame(
    state: DetectionState,
    image: GroundImage,
    settings: DetectionSettings,
    sampled: Callable[[GroundImage, GroundGrid, DetectionSettings], Sampled],
) -> tuple[DetectionState, GroundGrid, Sampled] | RejectedFrame:
    """Return the state with this frame as its latest, the field grid, and the frame sampled on it.

    Another camera, or another grid in the settings, resets the state.
    """
    grid = state.grid
    if grid is None or (settings.grid is not None and grid != settings.grid):
        grid = field_grid(image.grid, settings)
    if grid != state.grid or image.serial != state.serial:
        state = DetectionState(grid, image.serial, references=state.references)
    fault = picture_fault(image, state.latest_ns, grid, settings)
    if fault is not None:
        return fault
    cells = sampled(image, grid, settings)
    fault = cells_fault(image, cells, state.latest, settings)
    if fault is not None:
        return fault
    return replace(state, latest=cells, latest_ns=image.captured_at_ns), grid, cells


def shade_map(
    image: GroundImage,
    grid: GroundGrid,
    found: tuple[FloatMap, MaskMap, FloatMap],
) -> ShadeMap:
    """Return the shade map of (transmittance, validity, confidence), each (R, C).

    Invalid cells get NaN and confidence 0; transmittance and confidence are clipped to [0, 1].
    """
    transmittance, valid, confidence = found
    coarser_m = metres_per_pixel(grid, image.pose, image.pixels_per_radian)
    nowhere = np.float32(np.nan)
    return ShadeMap(
        grid=grid,
        captured_at_ns=image.captured_at_ns,
        source_serials=(image.serial,) if image.serial else (),
        transmittance=np.where(valid, np.clip(transmittance, 0.0, 1.0), nowhere),
        valid=valid,
        confidence=np.where(valid, np.clip(confidence, 0.0, 1.0), np.float32(0.0)),
        metres_per_pixel=np.where(valid, coarser_m, nowhere),
    )
