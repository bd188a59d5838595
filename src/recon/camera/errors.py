"""Everything that can be wrong in this room, as one tree.

    CameraError (a ReconError)
    |-- CalibrationError       the lens's file or its numbers make no camera
    |-- ControlPointsError     the control points' file is malformed
    |-- PoseError              these control points give no pose
    |-- FrameSizeError         a frame has another size or aspect ratio than the model
    `-- FrameDecodeError       the bytes are no image of an acceptable size

Each message says what was expected, what came and what to do about it.
"""

from recon.model.errors import ReconError


class CameraError(ReconError):
    """Base of what this room raises."""


class CalibrationError(CameraError):
    """The lens's file or its numbers make no usable camera."""


class ControlPointsError(CameraError):
    """The control points' file is malformed."""


class PoseError(CameraError):
    """These control points give no pose."""


class FrameSizeError(CameraError):
    """A frame has another size or aspect ratio than the camera model."""


class FrameDecodeError(CameraError):
    """The bytes are no image of an acceptable size."""
