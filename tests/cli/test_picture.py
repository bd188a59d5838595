"""What the shell's pictures share."""

import cv2
import numpy as np

from recon.cli.picture import COLOURS, png_of


def test_a_png_has_the_pictures_colours_in_their_order() -> None:
    picture = np.array([COLOURS, COLOURS[::-1]], np.uint8)
    read = cv2.imdecode(np.frombuffer(png_of(picture), np.uint8), cv2.IMREAD_COLOR)
    assert (read[..., ::-1] == picture).all()
