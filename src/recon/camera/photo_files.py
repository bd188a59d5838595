"""Photos and recorded frames from files: JPEG or PNG, untrusted.

The size is read from the header before anything is decoded, so that a few bytes cannot make it
allocate gigabytes. Orientation tags are ignored: a calibration is for the sensor's axes.
"""

from pathlib import Path

from recon.camera.decode import decode_jpeg, jpeg_size
from recon.camera.decode_png import START as PNG_START
from recon.camera.decode_png import decode_png, png_size
from recon.camera.errors import FrameDecodeError
from recon.model.file_kind import file_kind
from recon.model.imagery import RgbImage

SUFFIXES = frozenset({".jpg", ".jpeg", ".png"})
LARGEST_FILE_BYTES = 64 * 1024 * 1024
MOST_PIXELS = 64_000_000
"""The largest sensors of drones have 48 million."""
HEADER_BYTES = 64 * 1024
"""Holds a JPEG's frame header after the usual metadata; else the whole file is read."""


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
        if data.startswith(PNG_START):
            return decode_png(data, MOST_PIXELS)
        _size(data)
        return decode_jpeg(data, MOST_PIXELS)
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
    if data.startswith(PNG_START):
        rows, cols = png_size(data)
    elif data.startswith(b"\xff\xd8"):
        rows, cols = jpeg_size(data)
    else:
        raise FrameDecodeError(f"expected a JPEG or PNG file, got {file_kind(data[:8])}")
    if not 0 < rows * cols <= MOST_PIXELS:
        raise FrameDecodeError(f"expected 1 to {MOST_PIXELS} pixels, got {cols} x {rows}")
    return rows, cols
