"""Frames and ground images as files a browser shows."""

import cv2
import cv2.typing
import numpy as np

from recon.model.imagery import Frame, GroundImage

JPEG_QUALITY = 88
PNG_COMPRESSION = 1
"""The console fetches a new picture every second or so: speed before size."""


def frame_jpeg(frame: Frame) -> bytes:
    """Return a frame as a JPEG file; an app's own JPEG is passed on as it came."""
    if frame.jpeg is not None:
        return frame.jpeg
    assert frame.rgb is not None
    bgr = cv2.cvtColor(frame.rgb, cv2.COLOR_RGB2BGR)
    return encoded(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])


def ground_png(image: GroundImage) -> bytes:
    """Return a ground image as a PNG file, transparent where nothing was seen."""
    bgra = cv2.cvtColor(image.rgb, cv2.COLOR_RGB2BGRA)
    bgra[..., 3] = np.where(image.valid, 255, 0)
    return encoded(".png", bgra, [cv2.IMWRITE_PNG_COMPRESSION, PNG_COMPRESSION])


def encoded(suffix: str, pixels: cv2.typing.MatLike, options: list[int]) -> bytes:
    """Return pixels (BGR, BGRA or grey) as a file of a kind."""
    is_done, data = cv2.imencode(suffix, pixels, options)
    if not is_done:
        raise ValueError(f"expected pixels that can be written as {suffix}, got {pixels.shape}")
    return data.tobytes()
