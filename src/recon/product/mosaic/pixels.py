"""The pixels of photos: decoded when first needed, only what the mosaic takes is kept.

A photo of 20 megapixels has 60 MB of pixels, of which a mosaic takes a tenth: so when it is
decoded, all that is taken of it is cut out, and kept as long as room allows.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import log2
from pathlib import Path
from threading import Lock
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import rasterio
from rasterio.errors import RasterioError
from rasterio.windows import Window

from recon.product.mosaic.cameras import Camera
from recon.product.photos.photo_error import PhotoError

Pixels = npt.NDArray[Any]
"""(rows, cols, channels), uint8 or uint16."""
MOST_SHRUNK = 8
"""What a JPEG decoder leaves out on its own, each way."""
AROUND_PX = 4
"""Pixels kept around what is taken: interpolation reads neighbours."""
CACHE_BYTES = 48 * 1024 * 1024

Box = tuple[int, int, int, int]
"""Rows and columns: top, left, and those after the last, bottom, right."""
ReadPixels = Callable[[int, int, Box], Pixels]
"""A photo's index, how often smaller each way (1, 2, 4, 8), a box in its smaller pixels that may
reach beyond them -> its pixels there, as stored."""


@dataclass(frozen=True, slots=True)
class MosaicBand:
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

    Lines are decoded one after the other: only the part is in memory, where OpenCV needs twice the
    whole photo. Raises `PhotoError`; rasterio warns that photos have no place.
    """
    try:
        with rasterio.open(path, driver="JPEG") as whole:
            levels = whole.overviews(1)
        if shrink > 1 and shrink not in levels:
            # A picture of a few hundred pixels has no smaller versions.
            return read_unchanged(path, shrink, box)[..., ::-1]
        level = {} if shrink == 1 else {"overview_level": levels.index(shrink)}
        with rasterio.open(path, driver="JPEG", **level) as dataset:
            top, left, bottom, right = box
            bottom, right = min(bottom, dataset.height), min(right, dataset.width)
            bands = [1, 2, 3] if dataset.count == 3 else [1, 1, 1]
            found = dataset.read(bands, window=Window(left, top, right - left, bottom - top))
    except RasterioError as problem:
        raise PhotoError(f"{path.name}: its picture cannot be read") from problem
    return np.moveaxis(found, 0, -1)


def read_unchanged(path: Path, shrink: int, box: Box) -> Pixels:
    """Return a part of a picture as stored, (rows, cols, channels); raises `PhotoError`."""
    try:
        data = np.fromfile(path, dtype=np.uint8)
        found = cv2.imdecode(data, cv2.IMREAD_UNCHANGED | cv2.IMREAD_IGNORE_ORIENTATION)
    except (OSError, cv2.error) as problem:
        raise PhotoError(f"{path.name}: its picture cannot be read") from problem
    if found is None or found.dtype not in (np.uint8, np.uint16):
        raise PhotoError(f"{path.name}: expected a picture of 8 or 16 bits, got another")
    if shrink > 1:
        size = found.shape[1] // shrink, found.shape[0] // shrink
        found = cv2.resize(found, size, interpolation=cv2.INTER_AREA)
    top, left, bottom, right = box
    part = found[top:bottom, left:right]
    return part.reshape(*part.shape[:2], -1)


def shrink_for(pixels_ratio: float) -> int:
    """Return how often smaller a photo is read whose pixels are so often in one of the mosaic."""
    return int(2 ** np.clip(round(log2(max(pixels_ratio, 1.0))), 0, int(log2(MOST_SHRUNK))))


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """A piece of a photo; `first` is the row and column of its first pixel in the shrunk photo."""

    pixels: Pixels
    first: tuple[int, int]


Edges = tuple[float, float, float, float]
"""Top, left, bottom, right in pixels of a whole photo."""


@dataclass(slots=True)
class PhotoCuts:
    """What a mosaic's windows take of its photos; threads share it.

    Windows have numbers in the order in which they are rendered; each takes its piece of a photo
    once. If there is no room for all pieces, those wait that are needed soonest: for the others the
    photo is decoded again.
    """

    read: ReadPixels
    shrink: int
    taken: Mapping[int, Mapping[int, Edges]]
    """By a photo's index and a window's number."""
    most_bytes: int = CACHE_BYTES
    decoded: int = 0
    """Photos decoded so far."""
    _kept: dict[tuple[int, int], Cut] = field(default_factory=dict)
    """By a window's number and a photo's index."""
    _bytes: int = 0
    _left: dict[int, set[int]] = field(init=False)
    """By photo, windows that have not had their piece."""
    _changing: Lock = field(default_factory=Lock)
    _decoding: Lock = field(default_factory=Lock)
    """One whole photo in memory at a time."""

    def __post_init__(self) -> None:
        self._left = {index: set(numbers) for index, numbers in self.taken.items()}

    def has(self, number: int, index: int) -> bool:
        """Return whether a window takes anything of a photo."""
        return number in self.taken.get(index, ())

    def get(self, number: int, index: int) -> Cut:
        """Return what a window takes of a photo, once; raises `PhotoError`."""
        found = self._pop(number, index)
        if found is not None:
            return found
        with self._decoding:
            # Another thread may just have decoded it.
            found = self._pop(number, index)
            if found is None:
                self._decode(number, index)
                found = self._pop(number, index)
        assert found is not None  # of all pieces at most later ones had no room
        return found

    def _pop(self, number: int, index: int) -> Cut | None:
        with self._changing:
            found = self._kept.pop((number, index), None)
            if found is not None:
                self._bytes -= found.pixels.nbytes
                self._left[index].discard(number)
            return found

    def _decode(self, needed: int, index: int) -> None:
        # The one needed first; another thread may still be at an earlier window.
        numbers = sorted(self._left[index], key=lambda number: (number != needed, number))
        boxes = [self._box(self.taken[index][number]) for number in numbers]
        top, left = min(box[0] for box in boxes), min(box[1] for box in boxes)
        bottom, right = max(box[2] for box in boxes), max(box[3] for box in boxes)
        pixels = self.read(index, self.shrink, (top, left, bottom, right))
        self.decoded += 1
        for number, box in zip(numbers, boxes, strict=True):
            rows, cols = slice(box[0] - top, box[2] - top), slice(box[1] - left, box[3] - left)
            # A copy: a view would keep the whole photo in memory.
            cut = Cut(pixels[rows, cols].copy(order="C"), box[:2])
            if not self._keep(number, index, cut, needed):
                break

    def _keep(self, number: int, index: int, cut: Cut, needed: int) -> bool:
        """Keep a piece, and return whether there was room; that of the window `needed` has it."""
        with self._changing:
            while self._bytes + cut.pixels.nbytes > self.most_bytes and self._kept:
                last = max(self._kept)
                if last[0] <= number:
                    break
                self._bytes -= self._kept.pop(last).pixels.nbytes
            fits = self._bytes + cut.pixels.nbytes <= self.most_bytes
            if fits or number == needed:
                self._kept[number, index] = cut
                self._bytes += cut.pixels.nbytes
            return fits

    def _box(self, edges: Edges) -> Box:
        top, left, bottom, right = (edge / self.shrink for edge in edges)
        first = max(0, int(top) - AROUND_PX), max(0, int(left) - AROUND_PX)
        return (*first, int(bottom) + AROUND_PX + 1, int(right) + AROUND_PX + 1)
