"""A photo's small grey picture, decoded no larger than registration needs."""

import cv2
import numpy as np

from recon.product.registration.match import LARGEST_PX, GreyImage
from recon.product.timing import TimedPhoto

REDUCED = (
    (8, cv2.IMREAD_REDUCED_GRAYSCALE_8),
    (4, cv2.IMREAD_REDUCED_GRAYSCALE_4),
    (2, cv2.IMREAD_REDUCED_GRAYSCALE_2),
)


def read_grey(timed: TimedPhoto) -> GreyImage | None:
    """Return a photo's grey picture, not turned by EXIF's orientation; None if it is damaged."""
    longer_px = max(timed.photo.cols, timed.photo.rows)
    flag = next((f for by, f in REDUCED if longer_px / by >= LARGEST_PX), cv2.IMREAD_GRAYSCALE)
    found = cv2.imread(str(timed.photo.path), flag | cv2.IMREAD_IGNORE_ORIENTATION)
    return None if found is None else found.astype(np.uint8, copy=False)
