"""True times and poses at which the imaging drone's frames were taken."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from recon.model.arrays import FloatArray
from recon.model.imagery import CameraPose, GroundImage
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import VehicleProfile
from recon.score.scenario import Scenario
from recon.sim.app.camera_feed import CaptureTimes
from recon.sim.camera.field import FieldRenderer

NEAR_PER_HEIGHT = 195.0 / 120.0
"""Registration is measured this far around the point below the camera, in heights."""
POINTS = 100
TURN_RAD = np.pi * (3.0 - np.sqrt(5.0))
"""The golden angle: points of equal area on a disk (Vogel 1979)."""


@dataclass(frozen=True, slots=True, eq=False)
class TrueFrame:
    """The truth of one frame."""

    taken_at_s: float
    """Time since the run's start."""
    pose: CameraPose


@dataclass(slots=True)
class TrueFrames:
    """The frames that one imaging drone's feed has sent."""

    captures: deque[CaptureTimes]
    """Captures in the order in which they were taken."""
    renderer: FieldRenderer
    latency_s: float
    """The latency that the station assumes; added to its capture time it gives the arrival."""

    def of_image(self, image: GroundImage) -> TrueFrame | None:
        """Return the truth of a ground image's frame; None if the feed has sent none by then."""
        arrived_at_ns = image.captured_at_ns + seconds_to_ns(self.latency_s)
        sent = (each for each in reversed(self.captures) if each.send_at_ns <= arrived_at_ns)
        newest = next(sent, None)
        if newest is None:
            return None
        pose = self.renderer.true_pose(newest.view)
        return TrueFrame(newest.taken_at_ns / NS_PER_S, pose)


@dataclass(slots=True)
class FleetFrames:
    """The frames of all imaging drones of a run, by serial."""

    imagers: Mapping[str, TrueFrames]

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        captures: Mapping[str, deque[CaptureTimes]],
        renderers: Mapping[str, FieldRenderer],
    ) -> "FleetFrames":
        """Return the frames that a scenario's feeds send."""
        usual, profiles = VehicleProfile(""), scenario.site.profiles
        return cls(
            {
                serial: TrueFrames(
                    sent, renderers[serial], profiles.get(serial, usual).video_latency_s
                )
                for serial, sent in captures.items()
            }
        )

    def of_image(self, image: GroundImage) -> TrueFrame | None:
        """Return the truth of a ground image's frame; None if its feed has sent none by then."""
        return self.imagers[image.serial].of_image(image)


Frames = TrueFrames | FleetFrames
"""Frames of one imaging drone, or of all."""


def ground_seen(true: CameraPose, believed: CameraPose, points_m: FloatArray) -> FloatArray:
    """Return the points of the ground plane (N, 2) that a camera truly sees where it is believed to
    see `points_m` (N, 2); NaN for a ray that does not meet the ground."""
    level = np.column_stack([points_m, np.zeros(len(points_m))])
    rays = (level - believed.position_enu_m) @ believed.rotation_enu_camera
    directions = rays @ true.rotation_enu_camera.T
    down = -directions[:, 2]
    far = np.where(down > 0.0, true.position_enu_m[2] / np.where(down > 0.0, down, 1.0), np.nan)
    seen: FloatArray = true.position_enu_m[:2] + directions[:, :2] * far[:, np.newaxis]
    return seen


def registration_errors_m(true: CameraPose, believed: CameraPose) -> FloatArray:
    """Return how far a ground image's points are from their true places, (N,) metres.

    The points are spread evenly within 1.6 heights (195 m at 120 m) of the point below the camera.
    """
    count = np.arange(POINTS)
    radius_m = NEAR_PER_HEIGHT * true.position_enu_m[2] * np.sqrt((count + 0.5) / POINTS)
    around_m = radius_m[:, np.newaxis] * np.column_stack(
        [np.cos(TURN_RAD * count), np.sin(TURN_RAD * count)]
    )
    points_m = true.position_enu_m[:2] + around_m
    off_m: FloatArray = np.linalg.norm(ground_seen(true, believed, points_m) - points_m, axis=1)
    return off_m
