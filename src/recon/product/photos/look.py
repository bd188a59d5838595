"""How a photo looks in small: detail, and how much of it is white or black.

Taken from the preview that cameras put into the file, for a survey's photos are too large to decode
them all; small pictures are taken as they are. Others have no look.
"""

from dataclasses import dataclass
from io import BytesIO
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
from PIL import Image
from PIL.ExifTags import IFD

GreyMap = npt.NDArray[np.uint8]

MOST_PIXELS = 2_000_000
"""Largest picture that is decoded, preview or not: a few milliseconds."""
LEAST_PIXELS = 64 * 48
WHITE_FROM, BLACK_TO = 253, 4
BAR_TO, BRIGHT_PERCENT = 24, 90.0
"""A line of a bar is no brighter than this, but for a tenth of it."""
START_OF_IMAGE = b"\xff\xd8"
THUMBNAIL_AT, THUMBNAIL_SIZE = 0x0201, 0x0202
"""EXIF's JPEGInterchangeFormat and its length, in bytes from the start of the TIFF header."""
MPF_ENTRIES, MPF_MARK = 0xB002, b"MPF\0"
HEAD_BYTES = 1024 * 1024
UNREADABLE = (OSError, SyntaxError, ValueError, TypeError, KeyError, cv2.error)
"""What readers of pictures raise on damaged pixels: a photo whose statements are whole is used."""
EXIF_HEADER = b"Exif\0\0"


@dataclass(frozen=True, slots=True)
class Look:
    """Of a picture in small, in shares of its brightness or of its pixels."""

    detail: float
    """Mean difference between neighbouring pixels and their surroundings, by mean brightness."""
    white: float
    black: float


def look_of(image: Any, data: bytes, black_level: float = 0.0) -> Look | None:
    """Return the look of an open picture and the bytes of its file; None where it has no preview.

    `black_level` is what a band's pixels without light have.
    """
    try:
        grey = _grey(image, data, black_level)
    except UNREADABLE:
        return None
    if grey is None or grey.size < LEAST_PIXELS:
        return None
    grey = _without_bars(grey)
    detail = np.abs(cv2.Laplacian(cv2.GaussianBlur(grey, (3, 3), 0), cv2.CV_32F)).mean()
    white, black = (grey >= WHITE_FROM).mean(), (grey <= BLACK_TO).mean()
    return Look(float(detail / max(float(grey.mean()), 1.0)), float(white), float(black))


def _without_bars(grey: GreyMap) -> GreyMap:
    """Return a picture without the black bars that fill a preview of another shape."""
    # Compression leaves traces of the picture in the bars beside it.
    bright = (np.percentile(grey, BRIGHT_PERCENT, axis=axis) for axis in (1, 0))
    rows, cols = (np.flatnonzero(each > BAR_TO) for each in bright)
    if len(rows) == 0 or len(cols) == 0:
        return grey
    return grey[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1]


def _grey(image: Any, data: bytes, black_level: float) -> GreyMap | None:
    if image.size[0] * image.size[1] <= MOST_PIXELS:
        if image.format == "TIFF":
            return _eight_bit(np.asarray(image), black_level)
        return _decoded(data)
    for preview in (_mpf_preview(image, data), _thumbnail(image)):
        found = _decoded(preview) if preview else None
        if found is not None:
            return found
    return None


def _eight_bit(pixels: npt.NDArray[Any], black_level: float) -> GreyMap | None:
    """Return a band's picture in 8 bits; None for pictures of several bands, or of other
    numbers."""
    if pixels.ndim != 2 or pixels.dtype not in (np.uint8, np.uint16):
        return None
    most = float(np.iinfo(pixels.dtype).max)
    scale = 255.0 / max(most - black_level, 1.0)
    found: GreyMap = np.clip((pixels - black_level) * scale, 0.0, 255.0).astype(np.uint8)
    return found


def _decoded(data: bytes) -> GreyMap | None:
    """Return a JPEG's grey picture; None for one that is damaged or too large."""
    with Image.open(BytesIO(data), formats=("JPEG",)) as image:
        if image.size[0] * image.size[1] > MOST_PIXELS:
            return None
    found = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_GRAYSCALE)
    return None if found is None else found.astype(np.uint8, copy=False)


def _mpf_preview(image: Any, data: bytes) -> bytes | None:
    """Return the largest of the further pictures of a multi-picture file that is not too large."""
    entries = (getattr(image, "mpinfo", None) or {}).get(MPF_ENTRIES, ())
    # Places are counted from behind the mark of the segment that lists them.
    begin, found = data.find(MPF_MARK, 0, HEAD_BYTES) + len(MPF_MARK), None
    for entry in entries[1:]:
        at = begin + entry["DataOffset"]
        part = data[at : at + entry["Size"]]
        if part.startswith(START_OF_IMAGE) and len(part) == entry["Size"]:
            found = part
    return found


def _thumbnail(image: Any) -> bytes | None:
    header: bytes = image.info.get("exif", b"").removeprefix(EXIF_HEADER)
    ifd = image.getexif().get_ifd(IFD.IFD1)
    at, size = ifd.get(THUMBNAIL_AT), ifd.get(THUMBNAIL_SIZE)
    if not isinstance(at, int) or not isinstance(size, int):
        return None
    part = header[at : at + size]
    return part if part.startswith(START_OF_IMAGE) else None
