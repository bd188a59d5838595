"""Calibration of a lens from photos of a chessboard (Scaramuzza's omnidirectional model).

`find_corners` in each photo, `calibrate_lens` over all of them, `coverage_of` and `warnings_of` for
judging the result, `residual_picture` for looking at it.
"""

from recon.camera.calibration.calibrate import (
    BoardPhoto,
    LensCalibration,
    PhotoResiduals,
    calibrate_lens,
)
from recon.camera.calibration.chessboard import Chessboard, find_corners
from recon.camera.calibration.coverage import Coverage, coverage_of, warnings_of
from recon.camera.calibration.residual_picture import residual_picture
