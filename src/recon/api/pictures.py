"""Frames, ground images, shade, predicted sun and survey cells as files that a browser displays.

Shade, sun and cells come in two forms. As a picture: colours with patterns, never colour alone, to
lie over the ground. As values: grey for the share, opaque where known; one pixel a cell.
"""

from collections.abc import Callable
from typing import Any

import cv2
import cv2.typing
import numpy as np
import numpy.typing as npt

from recon.model.imagery import Frame, GroundImage
from recon.model.shade import SURE, ShadeMap, SunForecast
from recon.model.survey import CellState

ByteImage = npt.NDArray[np.uint8]
MaskMap = npt.NDArray[np.bool_]
FloatMap = npt.NDArray[np.float32]

Pattern = Callable[[npt.NDArray[np.intp], npt.NDArray[np.intp]], MaskMap]

JPEG_QUALITY = 88
PNG_COMPRESSION = 1
"""The console fetches a new picture every second or so: speed before size."""

PIXELS_PER_CELL = 8
"""Picture pixels per cell: enough for a pattern in a cell."""

SHADE_RGB = (38, 58, 140)
SUN_RGB = (255, 196, 30)
UNKNOWN_RGB = (120, 120, 120)
DEEPEST_ALPHA = 190
SUN_ALPHA = 70
UNKNOWN_ALPHA = 150
CELL_ALPHA = 150


def frame_jpeg(frame: Frame) -> bytes:
    """Return a frame as a JPEG file; an app's own JPEG is passed on unchanged."""
    if frame.jpeg is not None:
        return frame.jpeg
    assert frame.rgb is not None
    bgr = cv2.cvtColor(frame.rgb, cv2.COLOR_RGB2BGR)
    return _encoded(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])


def ground_png(image: GroundImage) -> bytes:
    """Return a ground image as a PNG file, transparent where not imaged."""
    bgra = cv2.cvtColor(image.rgb, cv2.COLOR_RGB2BGRA)
    bgra[..., 3] = np.where(image.valid, 255, 0)
    return _encoded(".png", bgra, [cv2.IMWRITE_PNG_COMPRESSION, PNG_COMPRESSION])


def shade_png(shade: ShadeMap, seen: MaskMap) -> bytes:
    """Return a shade map as a picture: sun yellowish, shade blue, unknown hatched grey.

    `seen` (R, C) are the cells in view; where nothing was seen it is transparent.
    """
    unknown = seen & ~shade.valid
    return _shares_png(np.nan_to_num(shade.transmittance, nan=0.0), shade.valid, unknown)


def shade_values_png(shade: ShadeMap) -> bytes:
    """Return a shade map's transmittance as grey values."""
    return _values_png(np.nan_to_num(shade.transmittance, nan=0.0), shade.valid)


def forecast_png(sun: SunForecast, lead_s: float) -> bytes:
    """Return the probability of sun at a lead as a picture; beyond a cell's horizon hatched.

    The hatching is over the estimate; where nothing was seen it is alone.
    """
    share, is_known = _predicted(sun, lead_s)
    return _shares_png(share, np.isfinite(sun.horizon_s), ~is_known)


def forecast_values_png(sun: SunForecast, lead_s: float) -> bytes:
    """Return the probability of sun at a lead as grey values."""
    return _values_png(*_predicted(sun, lead_s))


def cells_png(state: ByteImage, inside: MaskMap, light_known: MaskMap) -> bytes:
    """Return a survey's cells as a picture: in sun filled, in shade striped, not imaged empty.

    Imaged while the light was unknown: hatched grey, the other way than shade.
    """
    wide, is_inside = _wide(state), _wide(inside)
    stripes = _pattern(wide.shape, lambda row, col: (row + col) % PIXELS_PER_CELL < 3)
    rgba = np.zeros((*wide.shape, 4), np.uint8)
    _paint(rgba, is_inside & (wide == CellState.IN_SUN), SUN_RGB, CELL_ALPHA)
    not_in_sun, is_known = is_inside & (wide == CellState.IN_SHADE), _wide(light_known)
    _paint(rgba, not_in_sun & is_known & stripes, SHADE_RGB, CELL_ALPHA + 60)
    _paint(rgba, not_in_sun & ~is_known & _hatch(wide.shape), UNKNOWN_RGB, CELL_ALPHA + 60)
    return _rgba_png(rgba)


def cells_values_png(state: ByteImage, inside: MaskMap, light_known: MaskMap) -> bytes:
    """Return a survey's cells as grey values: 0 not imaged, 64 light unknown, 128 in shade, 255
    in sun."""
    share = state.astype(np.float32) / 2.0
    share[(state == CellState.IN_SHADE) & ~light_known] = 0.25
    return _values_png(share, inside)


def nearest_lead(sun: SunForecast, lead_s: float) -> int:
    """Return the index of the forecast's lead nearest to `lead_s`."""
    return int(np.argmin(np.abs(sun.lead_s - lead_s)))


def _predicted(sun: SunForecast, lead_s: float) -> tuple[FloatMap, MaskMap]:
    index = nearest_lead(sun, lead_s)
    share = sun.sun_probability[index].astype(np.float32) / SURE
    return share, sun.horizon_s >= sun.lead_s[index]


def _shares_png(sunlit: FloatMap, known: MaskMap, unknown: MaskMap) -> bytes:
    share, is_known = _wide(sunlit)[..., np.newaxis], _wide(known)
    colour = share * np.array(SUN_RGB) + (1.0 - share) * np.array(SHADE_RGB)
    alpha = share * SUN_ALPHA + (1.0 - share) * DEEPEST_ALPHA
    rgba = np.concatenate([colour, alpha], axis=-1).astype(np.uint8)
    rgba[~is_known] = 0
    _paint(rgba, _wide(unknown) & _hatch(is_known.shape), UNKNOWN_RGB, UNKNOWN_ALPHA)
    return _rgba_png(rgba)


def _hatch(shape: tuple[int, ...]) -> MaskMap:
    """Return where unknown is drawn: thin lines, falling to the right."""
    return _pattern(shape, lambda row, col: (row - col) % PIXELS_PER_CELL < 2)


def _values_png(share: FloatMap, known: MaskMap) -> bytes:
    grey = np.rint(np.clip(share, 0.0, 1.0) * 255.0).astype(np.uint8)
    return _rgba_png(np.dstack([grey, grey, grey, np.where(known, np.uint8(255), np.uint8(0))]))


def _wide(cells: npt.NDArray[Any]) -> npt.NDArray[Any]:
    return cells.repeat(PIXELS_PER_CELL, axis=0).repeat(PIXELS_PER_CELL, axis=1)


def _pattern(shape: tuple[int, ...], is_set: Pattern) -> MaskMap:
    row, col = np.ogrid[: shape[0], : shape[1]]
    return is_set(row, col)


def _paint(rgba: ByteImage, where: MaskMap, rgb: tuple[int, int, int], alpha: int) -> None:
    rgba[where] = (*rgb, alpha)


def _rgba_png(rgba: ByteImage) -> bytes:
    bgra = cv2.cvtColor(rgba, cv2.COLOR_RGBA2BGRA)
    return _encoded(".png", bgra, [cv2.IMWRITE_PNG_COMPRESSION, PNG_COMPRESSION])


def _encoded(suffix: str, pixels: cv2.typing.MatLike, options: list[int]) -> bytes:
    """Return pixels (BGR, BGRA or grey) as a file of the suffix's format."""
    is_done, data = cv2.imencode(suffix, pixels, options)
    if not is_done:
        raise ValueError(f"expected pixels that can be written as {suffix}, got {pixels.shape}")
    return data.tobytes()
