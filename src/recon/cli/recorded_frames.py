"""Frames of a recorded flight: a folder of photos in the order of their names, or a video."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import cv2
import numpy as np

from recon.camera import FrameDecodeError
from recon.camera.photo_files import SUFFIXES, photo_size, read_photo
from recon.model.imagery import RgbImage


@dataclass(frozen=True, slots=True, eq=False)
class RecordedFrame:
    """A frame, its name, and its time since the first frame."""

    name: str
    at_s: float
    rgb: RgbImage


@dataclass(frozen=True, slots=True)
class Recording:
    """A recording whose files were all found readable; `step_s` is the time between frames used."""

    path: Path
    files: tuple[Path, ...]
    """Empty for a video."""
    count: int
    step_s: float

    def frames(self) -> Iterator[RecordedFrame]:
        """Yield the frames; raises `FrameDecodeError` naming the file."""
        if self.files:
            for number, file in enumerate(self.files):
                yield RecordedFrame(file.name, number * self.step_s, read_photo(file))
        else:
            yield from _video_frames(self.path, self.step_s)


def open_recording(path: Path, step_s: float) -> Recording:
    """Return the recording of a folder or video file; raises `FrameDecodeError`."""
    if not path.is_dir():
        return Recording(path, (), _video_count(path, step_s), step_s)
    files = tuple(sorted(file for file in path.iterdir() if file.suffix.lower() in SUFFIXES))
    if not files:
        raise FrameDecodeError(f"{path}: expected JPEG or PNG files in this folder, got none")
    size = photo_size(files[0])
    for file in files:
        other = photo_size(file)
        if other != size:
            raise FrameDecodeError(
                f"{file}: expected {size[1]} x {size[0]} pixels as in {files[0].name}, got "
                f"{other[1]} x {other[0]}"
            )
    return Recording(path, files, len(files), step_s)


def _opened(path: Path) -> tuple[cv2.VideoCapture, float]:
    video = cv2.VideoCapture(str(path)) if path.is_file() else None
    rate_hz = 0.0 if video is None else float(video.get(cv2.CAP_PROP_FPS))
    if video is None or not video.isOpened() or not (isfinite(rate_hz) and rate_hz > 0.0):
        raise FrameDecodeError(f"{path}: expected a folder of JPEG or PNG files, or a video")
    return video, rate_hz


def _video_count(path: Path, step_s: float) -> int:
    video, rate_hz = _opened(path)
    count = max(1, round(video.get(cv2.CAP_PROP_FRAME_COUNT)))
    video.release()
    return max(1, int(np.ceil(count / rate_hz / step_s)))


def _video_frames(path: Path, step_s: float) -> Iterator[RecordedFrame]:
    video, rate_hz = _opened(path)
    try:
        number, due_s = 0, 0.0
        while video.grab():
            at_s = number / rate_hz
            if at_s >= due_s - 0.5 / rate_hz:
                is_read, pixels = video.retrieve()
                if not is_read:
                    break
                rgb = cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB).astype(np.uint8, copy=False)
                yield RecordedFrame(f"{path.name} {at_s:.1f} s", at_s, rgb)
                due_s += step_s
            number += 1
        if number == 0:
            raise FrameDecodeError(f"{path}: expected a video with frames, got none")
    finally:
        video.release()
