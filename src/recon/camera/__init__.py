"""Camera models, poses, and orthorectification of frames onto the ground plane.

From files to a ground image: `load_camera` (lens), `load_control_points` and `pose_from_points`
(pose of the marked frame), `displaced_pose` (pose now, by telemetry), `GroundProjector` (frame on a
grid). Files and image formats end here; nothing in this room knows of the station or the protocol.
"""

from recon.camera.decode import decode_frame, decode_jpeg, jpeg_size
from recon.camera.errors import (
    CalibrationError,
    CameraError,
    ControlPointsError,
    FrameDecodeError,
    FrameSizeError,
    PoseError,
)
from recon.camera.ground import GroundProjector, ground_maps
from recon.camera.image_circle import ImageCircle, find_image_circle
from recon.camera.motion import displaced_pose, mounted_pose, placing_error_m
from recon.camera.omnidirectional import OmnidirectionalCamera
from recon.camera.pose import PointResidual, PoseSolution, pose_from_points
from recon.camera.text_files import (
    ControlPoint,
    format_camera,
    format_control_points,
    load_camera,
    load_control_points,
    parse_camera,
    parse_control_points,
)
from recon.model.imagery import TelemetryReference
