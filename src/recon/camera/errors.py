"""Errors of the camera room, as one tree.

    CameraError (a ReconError)
    |-- CalibrationError       the calibration file or its numbers are invalid
    |-- ControlPointsError     the control points file is malformed
    |-- PoseError              the control points do not determine a pose
    |-- FrameSizeError         a frame's size or aspect ratio does not match the camera
    `-- FrameDecodeError       the bytes are not an image of an acceptable size

Each message gives what was expected, what was found, and what to do.
"""

from recon.model.errors import ReconError


class CameraError(ReconError):
    """Base of the errors of the camera room."""


class CalibrationError(CameraError):
    """The calibration file or its numbers are invalid."""


class ControlPointsError(CameraError):
    """The control points file is malformed."""


class PoseError(CameraError):
    """The control points do not determine a pose, or a pose is not usable."""


class FrameSizeError(CameraError):
    """A frame's size or aspect ratio does not match the camera model."""


class FrameDecodeError(CameraError):
    """The bytes are not an image of an acceptable size."""
