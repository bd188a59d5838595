"""Pixels of a frame: raw, or decoded from an untrusted JPEG file."""

import cv2
import numpy as np

from recon.camera.errors import FrameDecodeError
from recon.model.imagery import Frame, RgbImage

MOST_PIXELS = 3840 * 2160
"""The largest frame decoded; the ICD's raw images have the same limit."""

_START = b"\xff\xd8"
_END = b"\xff\xd9"
_START_OF_FRAME = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_WITHOUT_LENGTH = frozenset({0x01, *range(0xD0, 0xD8)})
_TRAILER_BYTES = 64
"""The end marker must be within this: some encoders pad after it; a truncated file has none."""


def decode_frame(frame: Frame, most_pixels: int = MOST_PIXELS) -> RgbImage:
    """Return the frame's pixels (rows, cols, 3) uint8 RGB; raises `FrameDecodeError`.

    The size of a JPEG is read from its header before decoding, so that a few bytes cannot make it
    allocate gigabytes. Orientation tags are ignored: the calibration is for the sensor's axes.
    """
    if frame.rgb is not None:
        return _checked_raw(frame.rgb, most_pixels)
    if frame.jpeg is None:
        raise FrameDecodeError(f"frame {frame.id}: expected pixels or a JPEG file, got neither")
    return decode_jpeg(frame.jpeg, most_pixels)


def decode_jpeg(data: bytes, most_pixels: int = MOST_PIXELS) -> RgbImage:
    """Return a JPEG file's pixels (rows, cols, 3) uint8 RGB; raises `FrameDecodeError`."""
    # Header first: nothing is allocated for a size that is refused.
    rows, cols = jpeg_size(data)
    _refuse_size(rows, cols, most_pixels)
    if _END not in data[-_TRAILER_BYTES:]:
        raise FrameDecodeError(
            f"JPEG: expected the end-of-image marker, got a file truncated after {len(data)} bytes"
        )
    flags = cv2.IMREAD_COLOR_RGB | cv2.IMREAD_IGNORE_ORIENTATION
    try:
        pixels = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
    except cv2.error as problem:
        raise FrameDecodeError(f"JPEG: expected a readable image, got: {problem.err}") from problem
    if pixels is None or pixels.shape != (rows, cols, 3):
        raise FrameDecodeError(
            f"JPEG: expected {cols} x {rows} pixels as in the header, got "
            f"{'none' if pixels is None else pixels.shape}; the file is damaged"
        )
    return pixels.astype(np.uint8, copy=False)


def jpeg_size(data: bytes) -> tuple[int, int]:
    """Return (rows, cols) from a JPEG's header (ISO 10918-1 B.2); raises `FrameDecodeError`."""
    if data[:2] != _START:
        raise FrameDecodeError(
            f"JPEG: expected a file that starts with ffd8, got {data[:4].hex() or 'nothing'}"
        )
    at = 2
    while at + 4 <= len(data):
        if data[at] != 0xFF:
            break
        marker = data[at + 1]
        if marker == 0xFF:
            at += 1
        elif marker in _WITHOUT_LENGTH:
            at += 2
        elif marker in _START_OF_FRAME and at + 9 <= len(data):
            return int.from_bytes(data[at + 5 : at + 7]), int.from_bytes(data[at + 7 : at + 9])
        else:
            at += 2 + int.from_bytes(data[at + 2 : at + 4])
    raise FrameDecodeError(
        f"JPEG: expected a frame header with the size, got none in {len(data)} bytes; "
        "the file is damaged or truncated"
    )


def _checked_raw(rgb: RgbImage, most_pixels: int) -> RgbImage:
    if rgb.ndim != 3 or rgb.shape[2] != 3 or rgb.dtype != np.uint8:
        raise FrameDecodeError(
            f"raw frame: expected (rows, cols, 3) of uint8, got {rgb.shape} of {rgb.dtype}"
        )
    _refuse_size(rgb.shape[0], rgb.shape[1], most_pixels)
    return rgb


def _refuse_size(rows: int, cols: int, most_pixels: int) -> None:
    if not 0 < rows * cols <= most_pixels:
        raise FrameDecodeError(
            f"frame: expected 1 to {most_pixels} pixels, got {cols} x {rows}; lower the size the "
            "app sends"
        )
