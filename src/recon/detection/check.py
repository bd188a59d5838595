"""Whether a frame may be read: faults of cameras and links that would look like shade."""

import cv2
import numpy as np

from recon.detection.cells import GREEN, CellLight
from recon.detection.rejected import FrameFault, RejectedFrame
from recon.detection.settings import DetectionSettings
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.units import ns_to_seconds


def picture_fault(
    image: GroundImage, latest_ns: int | None, grid: GroundGrid, settings: DetectionSettings
) -> RejectedFrame | None:
    """Return what is wrong with a frame by its place, its time or its levels.

    `latest_ns` is when the last frame that was used was taken.
    """
    if image.grid.frame != grid.frame:
        text = "expected a frame laid in the field's local frame, got one of another origin"
        return RejectedFrame(image.frame_id, FrameFault.OTHER_PLACE, text)
    if latest_ns is not None and image.captured_at_ns <= latest_ns:
        late_s = ns_to_seconds(latest_ns - image.captured_at_ns)
        text = f"expected a frame newer than the last one, got one taken {late_s:.1f} s before it"
        return RejectedFrame(image.frame_id, FrameFault.NOT_NEWER, text)
    return _level_fault(image, settings)


def cells_fault(
    image: GroundImage, cells: CellLight, latest: CellLight | None, settings: DetectionSettings
) -> RejectedFrame | None:
    """Return what is wrong with the cells' light: too little seen, or the very same as before."""
    seen_share = float(cells.seen.mean())
    if seen_share < settings.least_image:
        text = (
            f"expected a frame that shows {settings.least_image:.0%} of the field or more, got "
            f"{seen_share:.1%}"
        )
        return RejectedFrame(image.frame_id, FrameFault.OTHER_PLACE, text)
    if latest is not None and np.array_equal(cells.light, latest.light, equal_nan=True):
        text = "expected a new picture, got the last one again to the bit: is the camera frozen?"
        return RejectedFrame(image.frame_id, FrameFault.REPEATED, text)
    return None


def _level_fault(image: GroundImage, settings: DetectionSettings) -> RejectedFrame | None:
    """Black, or one single level over much of the picture."""
    levels = np.ascontiguousarray(image.rgb[..., GREEN])
    counted = cv2.calcHist([levels], [0], image.valid.astype(np.uint8), [256], [0, 256]).ravel()
    if counted.sum() == 0.0:
        text = "expected a frame that shows some of the field, got one that shows nothing of it"
        return RejectedFrame(image.frame_id, FrameFault.OTHER_PLACE, text)
    shares = counted / counted.sum()
    bright = int(np.searchsorted(np.cumsum(shares), 0.9))
    if bright < settings.black_level:
        text = (
            f"expected a picture, got black: nine tenths of it are at level {bright} of 255 or less"
        )
        return RejectedFrame(image.frame_id, FrameFault.BLACK, text)
    level = int(np.argmax(shares))
    if shares[level] > settings.flat_share:
        text = (
            f"expected a whole picture, got {shares[level]:.0%} of it at the one level {level} of "
            "255: torn, or overexposed"
        )
        return RejectedFrame(image.frame_id, FrameFault.TORN, text)
    return None
