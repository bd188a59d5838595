"""Pictures from files: a folder of frames, or one frame for ever."""

from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from recon.camera import CameraError, decode_jpeg
from recon.camera.omnidirectional import scale_between
from recon.model.imagery import RgbImage
from recon.sim.app.camera_feed import View
from recon.sim.errors import FrameSourceError

SUFFIXES = (".jpg", ".jpeg", ".png")
LARGEST_FILE_BYTES = 64 * 1024 * 1024


@dataclass(slots=True)
class FolderFrames:
    """The pictures of a folder by name, again from the start after the last."""

    paths: tuple[Path, ...]
    rows: int
    cols: int
    _last: tuple[int, RgbImage] | None = field(default=None)

    def prepare(self) -> None:
        """Read the first picture."""
        self.render(View(0.0, 0, None))

    def render(self, view: View) -> RgbImage:
        """Return the picture that is next."""
        index = view.number % len(self.paths)
        last = self._last
        if last is None or last[0] != index:
            last = (index, read_frame(self.paths[index], self.rows, self.cols))
            self._last = last
        return last[1]


def folder_frames(folder: Path, rows: int = 720, cols: int = 1280) -> FolderFrames:
    """Return the frames of a folder, scaled to a size; raises `FrameSourceError`.

    The first one is read at once, so that a wrong folder shows before the flight.
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
    """Return a file's picture (rows, cols, 3) RGB at this size; raises `FrameSourceError`.

    Shrinking averages areas, so pixel u of the file lies at (u + 0.5) s - 0.5 exactly.
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
    if path.suffix.lower() != ".png":
        try:
            return decode_jpeg(data)
        except CameraError as problem:
            raise FrameSourceError(f"{path}: {problem}") from None
    flags = cv2.IMREAD_COLOR_RGB | cv2.IMREAD_IGNORE_ORIENTATION
    pixels = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
    if pixels is None:
        raise FrameSourceError(f"{path}: expected a PNG image, got something unreadable")
    return pixels.astype(np.uint8, copy=False)
