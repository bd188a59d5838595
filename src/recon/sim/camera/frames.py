"""Frames: the view they are taken of, where their pixels come from, and their defects."""

from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Protocol

import cv2
import numpy as np

from recon.camera import CameraError, decode_jpeg
from recon.camera.decode_png import decode_png
from recon.camera.omnidirectional import scale_between
from recon.camera.photo_files import MOST_PIXELS
from recon.model.imagery import CameraPose, RgbImage
from recon.sim.errors import FrameSourceError

SUFFIXES = (".jpg", ".jpeg", ".png")
LARGEST_FILE_BYTES = 64 * 1024 * 1024


@dataclass(frozen=True, slots=True, eq=False)
class CameraView:
    """What a frame is taken of: time since the simulation's start, number, camera pose."""

    elapsed_s: float
    number: int
    pose: CameraPose | None


class FrameSource(Protocol):
    """A source of frames."""

    def prepare(self) -> None:
        """Do work that the first frame would wait for; may take seconds, once."""
        ...

    def render(self, view: CameraView) -> RgbImage:
        """Return (rows, cols, 3) uint8 RGB; may be slow, may be called from any thread."""
        ...


class StillFrame:
    """The same frame forever."""

    def __init__(self, rgb: RgbImage) -> None:
        self.rgb = rgb

    def prepare(self) -> None:
        """Do nothing: the frame is loaded."""

    def render(self, view: CameraView) -> RgbImage:
        """Return the frame."""
        return self.rgb


@dataclass(slots=True)
class FolderFrames:
    """The frames of a folder in order of name, in a loop."""

    paths: tuple[Path, ...]
    rows: int
    cols: int
    _last: tuple[int, RgbImage] | None = field(default=None)

    def prepare(self) -> None:
        """Read the first frame."""
        self.render(CameraView(0.0, 0, None))

    def render(self, view: CameraView) -> RgbImage:
        """Return the frame of the view's number, read once in a row."""
        index = view.number % len(self.paths)
        last = self._last
        if last is None or last[0] != index:
            last = (index, read_frame(self.paths[index], self.rows, self.cols))
            self._last = last
        return last[1]


def folder_frames(folder: Path, rows: int = 720, cols: int = 1280) -> FolderFrames:
    """Return the frames of a folder, scaled to a size; raises `FrameSourceError`.

    The first one is read at once, so that a wrong folder is reported before the flight.
    """
    if not folder.is_dir():
        raise FrameSourceError(f"{folder}: expected a folder of images, got no folder")
    paths = tuple(sorted(p for p in folder.iterdir() if p.suffix.lower() in SUFFIXES))
    if not paths:
        raise FrameSourceError(f"{folder}: expected {', '.join(SUFFIXES)} files, got none")
    frames = FolderFrames(paths, rows, cols)
    frames.prepare()
    return frames


def read_frame(path: Path, rows: int, cols: int) -> RgbImage:
    """Return a file's image (rows, cols, 3) RGB, scaled to this size; raises `FrameSourceError`.

    Shrinking averages areas, so that pixel u of the file maps to (u + 0.5) s - 0.5 exactly.
    """
    try:
        if path.stat().st_size > LARGEST_FILE_BYTES:
            raise FrameSourceError(
                f"{path}: expected at most {LARGEST_FILE_BYTES} bytes, got {path.stat().st_size}"
            )
        data = path.read_bytes()
    except OSError as problem:
        raise FrameSourceError(
            f"{path}: expected a readable file, got: {problem.strerror}"
        ) from None
    rgb = _decode(path, data)
    try:
        scale = scale_between((rgb.shape[1], rgb.shape[0]), (cols, rows))
    except CameraError as problem:
        raise FrameSourceError(f"{path}: {problem}") from None
    if scale == 1.0:
        return rgb
    method = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR
    return cv2.resize(rgb, (cols, rows), interpolation=method).astype(np.uint8, copy=False)


def _decode(path: Path, data: bytes) -> RgbImage:
    try:
        if path.suffix.lower() == ".png":
            return decode_png(data, MOST_PIXELS)
        return decode_jpeg(data)
    except CameraError as problem:
        raise FrameSourceError(f"{path}: {problem}") from None


EXPOSURE_GAINS = (0.35, 0.6, 1.7, 2.6)
"""Gains of up to one and a half stops: auto exposure with a bright cloud or a dark wood."""


class FrameFlaw(Protocol):
    """A defect of one frame."""

    def applied(self, rgb: RgbImage) -> RgbImage:
        """Return a copy of the image, (rows, cols, 3) uint8, with the defect."""
        ...


@dataclass(frozen=True, slots=True)
class Black:
    """All black, as when the video stream restarts."""

    def applied(self, rgb: RgbImage) -> RgbImage:
        """Return a black image."""
        return np.zeros_like(rgb)


@dataclass(frozen=True, slots=True)
class Torn:
    """A frame shifted sideways from one row down, as when two frames are mixed."""

    row_share: float
    shift_share: float

    def applied(self, rgb: RgbImage) -> RgbImage:
        """Return the torn image."""
        row = int(self.row_share * rgb.shape[0])
        shift = max(1, int(self.shift_share * rgb.shape[1]))
        return np.concatenate([rgb[:row], np.roll(rgb[row:], shift, axis=1)])


@dataclass(frozen=True, slots=True)
class Exposed:
    """Brighter or darker by a factor, clipped at white."""

    gain: float

    def applied(self, rgb: RgbImage) -> RgbImage:
        """Return the image at another exposure."""
        brighter: RgbImage = np.clip(np.rint(rgb * self.gain), 0.0, 255.0).astype(np.uint8)
        return brighter


def torn(random: Random) -> Torn:
    """Draw the row and the shift of a tear."""
    return Torn(random.uniform(0.1, 0.9), random.uniform(0.1, 0.5))


def exposed(random: Random) -> Exposed:
    """Draw an exposure."""
    return Exposed(random.choice(EXPOSURE_GAINS))
