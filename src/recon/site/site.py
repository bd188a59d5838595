"""A site: origin, imaging drones, vehicle profiles, layers and elevation."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import atan2, degrees, hypot

import numpy as np

from recon.camera import (
    ImageCircle,
    OmnidirectionalCamera,
    PoseSolution,
    TelemetryReference,
)
from recon.model.airspace import Airspace, ElevationModel, FlightLimits, LandingPad, Region, Zone
from recon.model.failsafe_matrix import FailsafeMatrix
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.imagery import CameraPose, Outlook
from recon.model.survey_camera import CameraModel
from recon.model.units import wrap_degrees
from recon.model.vehicle import VehicleProfile
from recon.model.weather import Weather
from recon.safety.failsafe import DEFAULT_MATRIX
from recon.site.terrain_source import TerrainSource

RIM_SHARE = 0.98
"""Share of the image circle's radius: its rim is dark, and out of view when the camera wobbles."""


@dataclass(frozen=True, slots=True, eq=False)
class Imager:
    """An imaging drone: its lens, and a pose of its camera from which telemetry leads on.

    `marked_pose` is the camera's pose when the marked frame was taken, `marked_frame` its telemetry
    then. Without control points both are those of a level camera on the ground at the origin.
    `image_circle` is at the camera's size, None when it must be detected in the frames.
    """

    serial: str
    camera: OmnidirectionalCamera
    marked_pose: CameraPose
    marked_frame: TelemetryReference | None = None
    solution: PoseSolution | None = None
    """How the control points gave the pose; None without control points."""
    image_circle: ImageCircle | None = None
    exposure_locked: bool = False
    """Whether exposure and white balance are locked in flight."""

    @property
    def first_frame_stands_for_marked_frame(self) -> bool:
        """Whether the first frame received in flight is used as the marked one.

        True without the marked frame's telemetry. It is right only if both were taken from the same
        position, so the station warns about it.
        """
        return self.marked_frame is None

    @property
    def outlook(self) -> Outlook:
        """What the camera shows from wherever the aircraft is."""
        east, north, up = self.marked_pose.rotation_enu_camera[:, 2].tolist()
        tilt_rad = atan2(hypot(east, north), -up)
        yaw_deg = 0.0 if self.marked_frame is None else self.marked_frame.yaw_deg
        looks_deg = degrees(atan2(east, north))
        return Outlook(
            self._field_rad(),
            tilt_rad,
            wrap_degrees(looks_deg - yaw_deg),
            self.camera.pixels_per_radian,
        )

    def _field_rad(self) -> float:
        camera, circle = self.camera, self.image_circle
        if circle is None:
            return camera.largest_angle_rad
        rim = [circle.centre_col_px + RIM_SHARE * circle.radius_px, circle.centre_row_px]
        (ray,) = camera.unproject([rim])
        angle_rad = float(np.arccos(np.clip(ray[2], -1.0, 1.0)))
        return angle_rad if np.isfinite(angle_rad) else camera.largest_angle_rad


@dataclass(frozen=True, slots=True, eq=False)
class Layers:
    """The site's GeoJSON layers, in metres of its local frame.

    `files` names the file of each layer that was read. A feature of several polygons becomes
    several zones of one name.
    """

    files: Mapping[str, str] = field(default_factory=dict)
    boundary: Region | None = None
    zones: tuple[Zone, ...] = ()
    landing_pads: tuple[LandingPad, ...] = ()
    survey_regions: Mapping[str, Region] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """A site's folder as read; without a folder only the name is known."""

    name: str
    frame: LocalFrame | None = None
    ground_grid: GroundGrid | None = None
    imagers: Mapping[str, Imager] = field(default_factory=dict)
    """The imaging drones by serial, in the order of the file."""
    profiles: Mapping[str, VehicleProfile] = field(default_factory=dict)
    layers: Layers = field(default_factory=Layers)
    limits: FlightLimits = field(default_factory=FlightLimits)
    failsafe: FailsafeMatrix = DEFAULT_MATRIX
    elevation: ElevationModel | None = None
    elevation_file: str | None = None
    terrain_source: TerrainSource | None = None
    """Where the elevation file was fetched from; None for the user's own."""
    weather: Weather | None = None
    """The forecast that was fetched before leaving base."""
    cameras: Mapping[str, CameraModel] = field(default_factory=dict)
    """The site's own survey cameras, beside those of the table."""

    @property
    def imager(self) -> Imager | None:
        """The first imaging drone, where one is meant; None without any."""
        return next(iter(self.imagers.values()), None)

    def with_imager(self, imager: Imager) -> "Site":
        """Return the site with an imaging drone added, or in place of the one of its serial."""
        return replace(self, imagers={**self.imagers, imager.serial: imager})

    @property
    def airspace(self) -> Airspace:
        """Limits, zones and pads of the site; with pads that only a profile has."""
        layered = self.layers.landing_pads
        owners = {pad.serial for pad in layered}
        own = (
            LandingPad(profile.display_name, serial, profile.pad)
            for serial, profile in self.profiles.items()
            if profile.pad is not None and serial not in owners
        )
        return Airspace(
            limits=self.limits,
            frame=self.frame,
            boundary=self.layers.boundary,
            zones=self.layers.zones,
            landing_pads=(*layered, *own),
            elevation=self.elevation,
        )


def default_site() -> Site:
    """Return the site of a station started without one."""
    return Site(name="no site")
