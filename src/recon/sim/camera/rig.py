"""The eye's camera on its aircraft: where it looks when telemetry says this or that."""

from dataclasses import dataclass

from recon.camera import OmnidirectionalCamera, TelemetryReference, displaced_pose
from recon.geo import shift_east_north_m
from recon.model.geo import LocalFrame
from recon.model.imagery import CameraPose
from recon.model.vehicle import Mount


@dataclass(frozen=True, slots=True, eq=False)
class ImagerRig:
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
        shift_m = shift_east_north_m(self.frame, self.marked, truth)
        return displaced_pose(self.marked_pose, self.marked, truth, shift_m, self.mount)
