"""TIFF files of single bands with the EXIF of a photo that is there."""

from pathlib import Path

import numpy as np
from PIL import ExifTags, Image

XMP_TAG = 700


def write_band(
    path: Path, like: Path, xmp: bytes | None = None, size: tuple[int, int] = (64, 48)
) -> Path:
    """Write a band's picture of 16 bits, with another photo's EXIF and its own XMP."""
    with Image.open(like) as image:
        exif = image.getexif()
        exif.get_ifd(ExifTags.IFD.Exif)
        exif.get_ifd(ExifTags.IFD.GPSInfo)
    if xmp is not None:
        exif[XMP_TAG] = xmp
    cols, rows = size
    Image.fromarray(np.full((rows, cols), 900, np.uint16)).save(path, exif=exif)
    return path
