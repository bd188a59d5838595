"""The eye's camera on its aircraft: where it looks when telemetry says this or that."""

from dataclasses import dataclass

from recon.camera import OmnidirectionalCamera, TelemetryReference, moved_pose
from recon.model.geo import LocalFrame
from recon.model.imagery import CameraPose
from recon.model.vehicle import Mount


@dataclass(frozen=True, slots=True, eq=False)
class EyeRig:
    """A lens, and the pose it has when the aircraft is at `marked`, in `frame`.

    `frame`'s origin lies on the (flat) ground; everywhere else the pose moves with the aircraft.
    """

    camera: OmnidirectionalCamera
    frame: LocalFrame
    marked_pose: CameraPose
    marked: TelemetryReference
    mount: Mount = Mount.GIMBAL

    def pose_at(self, truth: TelemetryReference) -> CameraPose:
        """Return the camera's pose when the aircraft is truly at `truth`."""
        return moved_pose(self.marked_pose, self.frame, self.marked, truth, self.mount)
