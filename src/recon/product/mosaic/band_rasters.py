"""Rasters of a multispectral camera's bands beside the mosaic in colour, on its grid.

A band's lens stands beside the one that leads the shot: its pose is taken as the same, its field of
view from its own file. So bands lie as well on each other as the camera is built.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from math import radians, tan
from pathlib import Path

import numpy as np

from recon.product.mosaic.cameras import Camera, PhotoLens
from recon.product.mosaic.pixels import Box, MosaicBand, Pixels, read_unchanged
from recon.product.photos.photo import Photo
from recon.product.photos.photo_error import PhotoError
from recon.product.photos.shots import CameraShot
from recon.product.timing import TimedPhoto


def band_rasters(
    shots: Sequence[CameraShot], photos: Sequence[TimedPhoto], cameras: Sequence[Camera]
) -> list[MosaicBand]:
    """Return the bands of shots, in the order of their names; `photos` are the leading files."""
    of_shot = {shot.lead.name: shot.files for shot in shots}
    files: dict[str, dict[int, Photo]] = defaultdict(dict)
    for index, timed in enumerate(photos):
        for photo in of_shot[timed.photo.name]:
            if photo.kind == "band" and photo.band is not None and photo.across_deg is not None:
                files[photo.band.name][index] = photo
    return [_band(name, of_band, cameras) for name, of_band in sorted(files.items())]


def _band(name: str, files: dict[int, Photo], cameras: Sequence[Camera]) -> MosaicBand:
    found: list[Camera | None] = [None] * len(cameras)
    for index, photo in files.items():
        found[index] = _beside(cameras[index], photo)
    dtype = _dtype(next(iter(files.values())).path)

    def read(index: int, shrink: int, box: Box) -> Pixels:
        photo = files[index]
        pixels = read_unchanged(photo.path, shrink, box)[..., :1]
        if pixels.dtype != dtype:
            raise PhotoError(
                f"{photo.name}: expected {dtype} as the first file, got {pixels.dtype}"
            )
        return pixels

    return MosaicBand(f"mosaic-{name}", (name,), read, dtype, is_picture=False, cameras=found)


def _beside(lead: Camera, photo: Photo) -> Camera:
    """Return the camera of a file beside a shot's leading one."""
    assert photo.across_deg is not None  # or it has no place
    focal_px = max(photo.cols, photo.rows) / 2.0 / tan(radians(photo.across_deg) / 2.0)
    centre_px = (photo.cols - 1) / 2.0, (photo.rows - 1) / 2.0
    lens = PhotoLens((focal_px, focal_px), centre_px)
    return replace(lead, lens=lens, cols=photo.cols, rows=photo.rows)


def _dtype(path: Path) -> str:
    try:
        return read_unchanged(path, 1, (0, 0, 1, 1)).dtype.name
    except PhotoError:
        # It is refused with a sentence when it is read.
        return np.dtype(np.uint16).name
