"""The pixels of photos: decoded when first needed, only what the mosaic takes is kept.

A photo of 20 megapixels has 60 MB of pixels, of which a mosaic takes a tenth: so when it is
decoded, all that is taken of it is cut out, and kept as long as room allows.
"""

from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import log2
from pathlib import Path
from threading import Condition, Lock
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from recon.product.mosaic.cameras import Camera
from recon.product.photos.photo_error import PhotoError

Pixels = npt.NDArray[Any]
"""(rows, cols, channels), uint8 or uint16."""
MOST_SHRUNK = 8
"""What a JPEG decoder leaves out on its own, each way."""
REDUCED = {
    1: cv2.IMREAD_COLOR,
    2: cv2.IMREAD_REDUCED_COLOR_2,
    4: cv2.IMREAD_REDUCED_COLOR_4,
    8: cv2.IMREAD_REDUCED_COLOR_8,
}
AROUND_PX = 4
"""Pixels kept around what is taken: interpolation reads neighbours."""
CACHE_BYTES = 64 * 1024 * 1024
LONGEST_SIDE_PX = 32_000
"""Longest side that OpenCV's warps take."""

Box = tuple[int, int, int, int]
"""Rows and columns: top, left, and those after the last, bottom, right."""
ReadPixels = Callable[[int, int, Box], Pixels]
"""A photo's index, how often smaller each way (1, 2, 4, 8), a box in its smaller pixels that may
reach beyond them -> its pixels there, as stored."""


@dataclass(frozen=True, slots=True)
class Band:
    """One raster of the mosaic: its name, its channels, and where its pixels come from."""

    name: str
    channels: tuple[str, ...]
    read: ReadPixels
    dtype: str = "uint8"
    is_picture: bool = True
    """Whether values are a camera's picture, with its gamma; else they are linear in light."""
    cameras: Sequence[Camera | None] | None = None
    """Of each photo, where the band is of another lens; None of a photo that lacks the band."""


def read_jpeg(path: Path, shrink: int, box: Box) -> Pixels:
    """Return a part of a JPEG as stored, not turned upright: (rows, cols, 3) uint8, red first.

    Raises `PhotoError`.
    """
    part = _cut_out(_decoded(path, REDUCED[shrink]), box)
    return cv2.cvtColor(part, cv2.COLOR_BGR2RGB)


def read_unchanged(path: Path, shrink: int, box: Box) -> Pixels:
    """Return a part of a picture as stored, (rows, cols, channels); raises `PhotoError`."""
    found = _decoded(path, cv2.IMREAD_UNCHANGED)
    if found.dtype not in (np.uint8, np.uint16):
        raise PhotoError(f"{path.name}: expected a picture of 8 or 16 bits, got another")
    if shrink > 1:
        size = found.shape[1] // shrink, found.shape[0] // shrink
        found = cv2.resize(found, size, interpolation=cv2.INTER_AREA)
    part = _cut_out(found, box)
    return part.reshape(*part.shape[:2], -1).copy()


def _decoded(path: Path, how: int) -> Pixels:
    try:
        data = np.fromfile(path, dtype=np.uint8)
    except OSError as problem:
        raise PhotoError(f"{path.name}: cannot be read: {problem.strerror}") from problem
    try:
        found = cv2.imdecode(data, how | cv2.IMREAD_IGNORE_ORIENTATION)
    except cv2.error as problem:
        raise PhotoError(f"{path.name}: its picture is damaged") from problem
    if found is None:
        raise PhotoError(f"{path.name}: its picture is damaged")
    return found


def _cut_out(whole: Pixels, box: Box) -> Pixels:
    top, left, bottom, right = box
    return whole[top:bottom, left:right]


def shrink_for(pixels_ratio: float) -> int:
    """Return how often smaller a photo is read whose pixels are so often in one of the mosaic."""
    return int(2 ** np.clip(round(log2(max(pixels_ratio, 1.0))), 0, int(log2(MOST_SHRUNK))))


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """A piece of a photo; `first` is the row and column of its first pixel in the shrunk photo."""

    pixels: Pixels
    first: tuple[int, int]


@dataclass(slots=True)
class PhotoCuts:
    """What a mosaic takes of its photos; threads share it.

    `taken` are rows and columns (top, left, bottom, right) in pixels of the whole photo.
    """

    read: ReadPixels
    shrink: int
    taken: Mapping[int, tuple[float, float, float, float]]
    most_bytes: int = CACHE_BYTES
    decoded: int = 0
    """Photos decoded so far."""
    _kept: OrderedDict[int, Cut] = field(default_factory=OrderedDict)
    _bytes: int = 0
    _busy: set[int] = field(default_factory=set)
    _changed: Condition = field(default_factory=Condition)
    _decoding: Lock = field(default_factory=Lock)
    """One whole photo in memory at a time."""

    def get(self, index: int) -> Cut:
        """Return what is taken of a photo; raises `PhotoError`."""
        with self._changed:
            # Two threads never decode the same photo.
            self._changed.wait_for(lambda: index not in self._busy)
            if index in self._kept:
                self._kept.move_to_end(index)
                return self._kept[index]
            self._busy.add(index)
        cut = None
        try:
            cut = self._cut(index)
            return cut
        finally:
            with self._changed:
                self._busy.discard(index)
                if cut is not None:
                    self._keep(index, cut)
                self._changed.notify_all()

    def _keep(self, index: int, cut: Cut) -> None:
        self.decoded += 1
        self._kept[index] = cut
        self._bytes += cut.pixels.nbytes
        while self._bytes > self.most_bytes and len(self._kept) > 1:
            _index, oldest = self._kept.popitem(last=False)
            self._bytes -= oldest.pixels.nbytes

    def _cut(self, index: int) -> Cut:
        top, left, bottom, right = (edge / self.shrink for edge in self.taken[index])
        first = max(0, int(top) - AROUND_PX), max(0, int(left) - AROUND_PX)
        box = (*first, int(bottom) + AROUND_PX + 1, int(right) + AROUND_PX + 1)
        with self._decoding:
            pixels = self.read(index, self.shrink, box)
        if max(pixels.shape[:2]) > LONGEST_SIDE_PX:
            raise PhotoError(f"expected photos of at most {LONGEST_SIDE_PX} pixels a side")
        return Cut(pixels, first)
