"""Pixels of an untrusted PNG file (RFC 2083)."""

import cv2
import numpy as np

from recon.camera.errors import FrameDecodeError
from recon.model.imagery import RgbImage

START = b"\x89PNG\r\n\x1a\n"
_FIRST, _LAST = b"IHDR", b"IEND"
_HEAD_BYTES, _TAIL_BYTES = 8, 4
"""Length and name before a chunk's data, checksum behind it."""


def png_size(data: bytes) -> tuple[int, int]:
    """Return (rows, cols) from a PNG's header; raises `FrameDecodeError`."""
    if not data.startswith(START) or data[12:16] != _FIRST or len(data) < 24:
        raise FrameDecodeError("PNG: expected its header first, got a damaged or truncated file")
    return int.from_bytes(data[20:24]), int.from_bytes(data[16:20])


def decode_png(data: bytes, most_pixels: int) -> RgbImage:
    """Return a PNG file's pixels (rows, cols, 3) uint8 RGB; raises `FrameDecodeError`."""
    rows, cols = png_size(data)
    if not 0 < rows * cols <= most_pixels:
        raise FrameDecodeError(f"expected 1 to {most_pixels} pixels, got {cols} x {rows}")
    flags = cv2.IMREAD_COLOR_RGB | cv2.IMREAD_IGNORE_ORIENTATION
    pixels = None
    if _has_whole_chunks(data):
        try:
            pixels = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
        except cv2.error as problem:
            raise FrameDecodeError(
                f"PNG: expected a readable image, got: {problem.err}"
            ) from problem
    # A truncated file decodes to fewer rows, or to nothing.
    if pixels is None or pixels.shape != (rows, cols, 3):
        raise FrameDecodeError(
            f"PNG: expected {cols} x {rows} pixels and an end mark, got a damaged or truncated file"
        )
    return pixels.astype(np.uint8, copy=False)


def _has_whole_chunks(data: bytes) -> bool:
    """Return whether all chunks up to the end mark are there: OpenCV allocates what one claims."""
    at = len(START)
    while at + _HEAD_BYTES + _TAIL_BYTES <= len(data):
        name = data[at + 4 : at + _HEAD_BYTES]
        at += _HEAD_BYTES + int.from_bytes(data[at : at + 4]) + _TAIL_BYTES
        if name == _LAST:
            return at <= len(data)
    return False
