"""A contact sheet of shade maps over their ground images."""

import cv2
import numpy as np

from recon.cli.picture import png_of
from recon.model.imagery import GroundImage, RgbImage
from recon.model.shade import ShadeMap

MOST_TILES = 24
TILES_ACROSS = 6
TILE_PX = 256
SHADE = (40, 90, 220)
UNKNOWN = (150, 150, 150)


def tile(image: GroundImage, shade: ShadeMap | None, label: str) -> RgbImage:
    """Return (256, 256, 3): the ground, shade tinted blue, unknown hatched grey."""
    size = (TILE_PX, TILE_PX)
    ground = cv2.resize(image.rgb, size, interpolation=cv2.INTER_AREA)
    is_known, is_shade = (np.zeros(size, dtype=bool) for _ in range(2))
    if shade is not None:
        known, dark = (
            part.astype(np.uint8) for part in (shade.valid, shade.valid & ~shade.is_sunlit)
        )
        is_known, is_shade = (
            cv2.resize(part, size, interpolation=cv2.INTER_NEAREST) > 0 for part in (known, dark)
        )
    row, col = np.indices(size)
    mixed = ground.astype(np.float32)
    mixed[is_shade] = 0.5 * mixed[is_shade] + 0.5 * np.array(SHADE, dtype=np.float32)
    mixed[~is_known & ((row + col) % 8 < 2)] = UNKNOWN
    drawn = np.clip(mixed, 0, 255).astype(np.uint8)
    cv2.rectangle(drawn, (0, 0), (TILE_PX, 18), (0, 0, 0), -1)
    cv2.putText(drawn, label, (4, 13), cv2.FONT_HERSHEY_SIMPLEX, 0.4, (255, 255, 255), 1)
    return drawn


def sheet_png(tiles: list[RgbImage]) -> bytes:
    """Return a PNG of the tiles in rows of six."""
    across = min(TILES_ACROSS, len(tiles))
    missing = -len(tiles) % across
    full = [*tiles, *([np.zeros((TILE_PX, TILE_PX, 3), dtype=np.uint8)] * missing)]
    rows = [np.hstack(full[first : first + across]) for first in range(0, len(full), across)]
    return png_of(np.vstack(rows))
