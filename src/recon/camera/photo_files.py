"""Photos and recorded frames from files: JPEG or PNG, untrusted.

The size is read from the header before anything is decoded, so that a few bytes cannot make it
allocate gigabytes. Orientation tags are ignored: a calibration is for the sensor's axes.
"""

from pathlib import Path

import cv2
import numpy as np

from recon.camera.decode import decode_jpeg, jpeg_size
from recon.camera.errors import FrameDecodeError
from recon.model.file_kind import file_kind
from recon.model.imagery import RgbImage

SUFFIXES = frozenset({".jpg", ".jpeg", ".png"})
LARGEST_FILE_BYTES = 64 * 1024 * 1024
MOST_PIXELS = 64_000_000
"""The largest sensors of drones have 48 million."""
HEADER_BYTES = 64 * 1024
"""Holds a JPEG's frame header after the usual metadata; else the whole file is read."""

_PNG = b"\x89PNG\r\n\x1a\n"


def photo_size(path: Path) -> tuple[int, int]:
    """Return (rows, cols) by a file's header; raises `FrameDecodeError` naming the file."""
    data = _file_bytes(path, HEADER_BYTES)
    try:
        return _size(data)
    except FrameDecodeError:
        pass
    data = _file_bytes(path, LARGEST_FILE_BYTES)
    try:
        return _size(data)
    except FrameDecodeError as problem:
        raise FrameDecodeError(f"{path}: {problem}") from problem


def read_photo(path: Path) -> RgbImage:
    """Return a file's pixels (rows, cols, 3) uint8 RGB; raises `FrameDecodeError` naming it."""
    data = _file_bytes(path, LARGEST_FILE_BYTES)
    try:
        _size(data)
        return _decoded_png(data) if data.startswith(_PNG) else decode_jpeg(data, MOST_PIXELS)
    except FrameDecodeError as problem:
        raise FrameDecodeError(f"{path}: {problem}") from problem


def _file_bytes(path: Path, most_bytes: int) -> bytes:
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            data = file.read(most_bytes)
    except OSError as problem:
        raise FrameDecodeError(
            f"{path}: expected a readable photo, got: {problem.strerror or problem}"
        ) from problem
    if size > LARGEST_FILE_BYTES:
        raise FrameDecodeError(
            f"{path}: expected a photo of at most {LARGEST_FILE_BYTES // 2**20} MiB, got "
            f"{size // 2**20} MiB"
        )
    return data


def _size(data: bytes) -> tuple[int, int]:
    if data.startswith(_PNG) and len(data) >= 24:
        # The first chunk is IHDR: width and height after its length and name (RFC 2083, 4.1.1).
        rows, cols = int.from_bytes(data[20:24]), int.from_bytes(data[16:20])
    elif data.startswith(b"\xff\xd8"):
        rows, cols = jpeg_size(data)
    else:
        raise FrameDecodeError(f"expected a JPEG or PNG file, got {file_kind(data[:8])}")
    if not 0 < rows * cols <= MOST_PIXELS:
        raise FrameDecodeError(f"expected 1 to {MOST_PIXELS} pixels, got {cols} x {rows}")
    return rows, cols


def _decoded_png(data: bytes) -> RgbImage:
    rows, cols = _size(data)
    flags = cv2.IMREAD_COLOR_RGB | cv2.IMREAD_IGNORE_ORIENTATION
    try:
        pixels = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
    except cv2.error as problem:
        raise FrameDecodeError(f"PNG: expected a readable image, got: {problem.err}") from problem
    # A truncated file decodes to fewer rows, or to nothing.
    if pixels is None or pixels.shape != (rows, cols, 3) or b"IEND" not in data[-16:]:
        raise FrameDecodeError(
            f"PNG: expected {cols} x {rows} pixels and an end mark, got a damaged or truncated file"
        )
    return pixels.astype(np.uint8, copy=False)
