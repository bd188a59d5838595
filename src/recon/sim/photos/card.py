"""Photos as the cards of survey drones hold them: rendered, and stated as wrongly as asked.

The camera hangs in a gimbal, straight down but for the gimbal's own errors, its top to the
aircraft's front. The sky, the land and its relief are those of the flight.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from random import Random
from zlib import crc32

import numpy as np

from recon.camera import TelemetryReference, mounted_pose
from recon.geo import point_from_enu
from recon.model.arrays import FloatArray
from recon.model.geo import LocalFrame
from recon.model.imagery import CameraPose
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.model.units import NS_PER_S
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.camera.lens import LATTICE_PX, Lens, ground_rays
from recon.sim.camera.rig import true_pose
from recon.sim.camera.settings import CameraSettings, ExposureSettings, HoverSettings, LensSettings
from recon.sim.flight.estimate import FIELD_DRIFT, GaussMarkov
from recon.sim.photos.cameras import CAMERAS, CameraName, PhotoCamera, pinhole
from recon.sim.photos.photo_file import StatedAttitude, StatedFacts, jpeg_of
from recon.sim.world.keyframes import FloatImage
from recon.sim.world.relief import Relief

USUAL_COLS = 1320
"""A quarter of a camera's: quick to render, and 7 cm on the ground from 60 m."""
GIMBAL = HoverSettings(wobble_deg=0.05, mount_error_deg=0.1, drift_m=0.0, drift_up_m=0.0)
"""A survey drone's gimbal, by the accuracy that makers state."""
RTK_M = 0.015
"""Standard deviation of a position with RTK, as makers state it for one axis."""
FAST_SHARE, FAST_S = 0.2, 5.0
"""Share of the position's error that changes within seconds."""
SUNLIT_COLS = 48
"""Columns of points of a photo on which its sunlit share is counted."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CardSettings:
    """The camera, and what is wrong in what its photos state."""

    camera: PhotoCamera = CAMERAS[CameraName.MAVIC_3E]
    cols: int = USUAL_COLS
    """Columns of the photos; fewer than the camera has reduce them."""
    clock_ahead_s: float = 0.0
    """Of the camera's clock before UTC; it shows whole seconds."""
    gnss_m: float | None = None
    """Standard deviation of the stated position, each axis; None: as usual for the camera."""
    states_gimbal: bool = True
    gimbal_yaw_off_deg: float = 0.0
    """StatedFacts minus true yaw of the gimbal."""
    is_roll_180: bool = False
    """Whether the gimbal's attitude is stated the other way round: rolled by 180 degrees, and so
    turned by as many."""

    @property
    def position_sigma_m(self) -> float:
        """Standard deviation of the stated position."""
        if self.gnss_m is not None:
            return self.gnss_m
        return RTK_M if self.camera.has_rtk else FIELD_DRIFT.position_m


@dataclass(frozen=True, slots=True, eq=False)
class PhotoShot:
    """One press of a shutter: when, and where the aircraft truly was."""

    name: str
    serial: str
    at_s: float
    """The simulated world's time."""
    utc_ns: int
    place_m: FloatArray
    """East, north, up (3,) of the site's frame."""
    height_above_takeoff_m: float
    yaw_deg: float
    """Heading of the aircraft's front."""
    seed: int = 0
    """Of the gimbal's and the position's errors."""

    @property
    def pose(self) -> CameraPose:
        """The camera's true pose."""
        telemetry = TelemetryReference(0.0, 0.0, self.height_above_takeoff_m, self.yaw_deg)
        hung = mounted_pose(telemetry, self.place_m)
        return true_pose(hung, GIMBAL, crc32(f"{self.seed}/{self.serial}".encode()), self.at_s)


@dataclass(frozen=True, slots=True, eq=False)
class PhotoFile:
    """One photo: its file, and the truth of it."""

    shot: PhotoShot
    jpeg: bytes
    sunlit: float
    """Share of its ground in sun."""


@dataclass(slots=True)
class PhotoCard:
    """The photos of a flight's shots, in order."""

    frame: LocalFrame
    world: FieldRenderer
    """Any camera in the flight's world: the land, sky, light and relief are taken."""
    settings: CardSettings

    def photos(self, shots: Sequence[PhotoShot]) -> Iterator[PhotoFile]:
        """Yield a photo of each shot; one is in memory at a time.

        The order of the shots is part of what the cameras' noise and errors follow from.
        """
        renderer, errors = self._renderer(), dict[str, _PositionError]()
        for number, shot in enumerate(shots):
            error = errors.setdefault(
                shot.serial, _PositionError(self.settings.position_sigma_m, shot)
            )
            pixels = renderer.render(CameraView(shot.at_s, number, shot.pose))
            stated = self._stated(shot, error.at(shot.at_s))
            yield PhotoFile(shot, jpeg_of(pixels, stated), self._sunlit(shot))

    def _renderer(self) -> FieldRenderer:
        camera, cols = self.settings.camera, self.settings.cols
        imager = CameraSettings(
            self.world.seed,
            HoverSettings(wobble_deg=0.0, mount_error_deg=0.0, drift_m=0.0, drift_up_m=0.0),
            LensSettings(rim_falloff=0.1),
            ExposureSettings(drift_stops=0.03),
        )
        lens = pinhole(camera.across_deg, cols, camera.rows_of(cols))
        return replace(self.world, camera=lens, image_circle=None, imager=imager, shows_plants=True)

    def _sunlit(self, shot: PhotoShot) -> float:
        """Return the share of a photo's ground that truly lies in sun."""
        camera = self.settings.camera
        rows = camera.rows_of(SUNLIT_COLS)
        ground_m = true_ground_m(shot, camera, SUNLIT_COLS, rows, self.world.relief)
        sun = self.world.sky.transmittance(ground_m[..., 0], ground_m[..., 1], shot.at_s)
        return float((sun >= SUNLIT_TRANSMITTANCE).mean())

    def _stated(self, shot: PhotoShot, error_m: FloatArray) -> StatedFacts:
        """Return what a photo's file states, with an error (3,) of its position."""
        settings = self.settings
        return StatedFacts(
            settings.camera,
            f"CAM-{shot.serial}",
            _clock(shot.utc_ns + round(settings.clock_ahead_s * NS_PER_S)),
            point_from_enu(self.frame, shot.place_m + error_m),
            shot.height_above_takeoff_m + float(error_m[2]),
            self._attitude(shot) if settings.states_gimbal else None,
            _half_turns(shot.yaw_deg),
            settings.position_sigma_m,
        )

    def _attitude(self, shot: PhotoShot) -> StatedAttitude:
        yaw_deg = shot.yaw_deg + self.settings.gimbal_yaw_off_deg
        if self.settings.is_roll_180:
            return StatedAttitude(_half_turns(yaw_deg + 180.0), roll_deg=180.0)
        return StatedAttitude(_half_turns(yaw_deg))


def true_ground_m(
    shot: PhotoShot, camera: PhotoCamera, cols: int, rows: int, relief: Relief | None
) -> FloatImage:
    """Return where each pixel of a photo of that size truly lies, (rows, cols, 2) east, north."""
    # The middles of the lattice's blocks are those of a smaller photo's pixels.
    larger = pinhole(camera.across_deg, LATTICE_PX * cols, LATTICE_PX * rows)
    rays = ground_rays(Lens(larger, None, LensSettings()), shot.pose, relief)
    return np.stack([rays.east_m, rays.north_m], axis=-1)


def _clock(utc_ns: int) -> str:
    return datetime.fromtimestamp(utc_ns // NS_PER_S, UTC).strftime("%Y:%m:%d %H:%M:%S")


def _half_turns(degrees: float) -> float:
    """Return an angle as one from -180 to 180."""
    return (degrees + 180.0) % 360.0 - 180.0


class _PositionError:
    """The error of the positions on one card, (3,): slow and fast parts, east, north and up."""

    def __init__(self, sigma_m: float, first: PhotoShot) -> None:
        self._random, self._at_s = Random(f"{first.seed}/{first.serial}/gnss"), first.at_s
        self._slow = [
            GaussMarkov(sigma_m, FIELD_DRIFT.position_time_s, self._random.gauss(0.0, sigma_m))
            for _axis in range(3)
        ]
        self._fast = [GaussMarkov(FAST_SHARE * sigma_m, FAST_S) for _axis in range(3)]

    def at(self, at_s: float) -> FloatArray:
        """Return the error at a time, later than the last one."""
        step_s, self._at_s = at_s - self._at_s, at_s
        parts = zip(self._slow, self._fast, strict=True)
        steps = [
            slow.step(step_s, self._random) + fast.step(step_s, self._random)
            for slow, fast in parts
        ]
        return np.array(steps)
