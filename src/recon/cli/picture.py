"""What the shell's pictures share: their colours and their file."""

import cv2

from recon.model.imagery import RgbImage

COLOURS = (
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (86, 180, 233),
    (230, 159, 0),
)
"""Okabe and Ito's colours (red, green, blue), which colour-blind eyes tell apart; those of them
that stand out on light and dark alike."""


def png_of(picture: RgbImage) -> bytes:
    """Return a picture (H, W, 3), red first, as a PNG."""
    _, data = cv2.imencode(".png", picture[..., ::-1])
    return data.tobytes()
