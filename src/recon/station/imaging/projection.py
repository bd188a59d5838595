"""The worker's part of a frame: decoded, aligned by its content, projected on the ground."""

from collections.abc import Callable
from dataclasses import dataclass, field

from recon.camera.decode import decode_frame
from recon.camera.ground import GroundProjector
from recon.camera.motion import displaced_pose
from recon.camera.registration import (
    LensView,
    RegisteredPose,
    RegistrationSettings,
    RegistrationState,
    step,
    view_of,
)
from recon.geo import shift_east_north_m, sun_position
from recon.model.arrays import FloatArray
from recon.model.errors import ReconError
from recon.model.geo import LatLon, LocalFrame
from recon.model.imagery import CameraPose, GroundImage, Registration, RgbImage
from recon.model.replacing import replace
from recon.model.units import ns_to_seconds
from recon.model.vehicle import VehicleProfile
from recon.site import Imager, Site
from recon.station.state.imaging import LayMarkedFrame, ProjectFrame

SETTINGS = RegistrationSettings()
_SEARCHING = "the image circle is not found in the frames yet"


@dataclass(frozen=True, slots=True, eq=False)
class ProjectedFrame:
    """A ground image, what registration keeps, and why the frame was not aligned, if so."""

    image: GroundImage
    registration: RegistrationState = field(default_factory=RegistrationState)
    problem: str = ""


@dataclass(slots=True)
class LensViews:
    """The lens as registration needs it, for the size of the newest frame."""

    projector: GroundProjector
    _newest: LensView | None = None
    _size_px: tuple[int, int] | None = None

    def view_for(self, rgb: RgbImage) -> LensView | None:
        """Return the view for frames like this one; None until their image circle is known."""
        size = (rgb.shape[0], rgb.shape[1])
        if self._size_px != size:
            lens = self.projector.lens_of(rgb)
            if lens is None:
                return None
            self._newest, self._size_px = view_of(*lens, SETTINGS), size
        return self._newest


def projection(site: Site) -> Callable[[ProjectFrame], ProjectedFrame]:
    """Return the work on one frame for a site; raises `ReconError` without an imaging drone."""
    if not site.imagers or site.frame is None or site.ground_grid is None:
        raise ReconError("the site has no imaging drone with a ground grid")
    frame, grid = site.frame, site.ground_grid
    lenses = {
        serial: LensViews(GroundProjector(grid, imager.camera, imager.image_circle))
        for serial, imager in site.imagers.items()
    }

    def project(work: ProjectFrame) -> ProjectedFrame:
        imager, views = site.imagers[work.frame.serial], lenses[work.frame.serial]
        rgb = decode_frame(work.frame)
        state, found = _registered(views, work, rgb, _telemetry_pose(site, imager, frame, work))
        image = replace(
            views.projector.project_decoded(work.frame, rgb, found.pose),
            registration=found.registration,
            registration_residual_m=found.residual_m,
            toward_sun_enu=_toward_sun_enu(frame, work.captured_utc_s),
            exposure_locked=imager.exposure_locked,
        )
        return ProjectedFrame(image, state, found.problem)

    return project


def _registered(
    views: LensViews, work: ProjectFrame, rgb: RgbImage, prior: CameraPose
) -> tuple[RegistrationState, RegisteredPose]:
    view = views.view_for(rgb)
    if view is None:
        unaligned = RegisteredPose(prior, Registration.UNREGISTERED, problem=_SEARCHING)
        return work.registration, unaligned
    return step(view, work.registration, rgb, prior, ns_to_seconds(work.frame.captured_at_ns))


def _telemetry_pose(
    site: Site, imager: Imager, frame: LocalFrame, work: ProjectFrame
) -> CameraPose:
    """Return the camera's pose at capture by the marked frame and telemetry."""
    marked, now = work.reference, work.telemetry
    mount = site.profiles.get(imager.serial, VehicleProfile(imager.serial)).mount
    shift_m = shift_east_north_m(frame, marked, now)
    of_run = work.marked_pose if isinstance(work, LayMarkedFrame) else None
    return displaced_pose(of_run or imager.marked_pose, marked, now, shift_m, mount)


def _toward_sun_enu(frame: LocalFrame, utc_s: float | None) -> FloatArray | None:
    """Return the unit vector to the sun; None at night and without a time."""
    if utc_s is None:
        return None
    place = LatLon(frame.origin.latitude_deg, frame.origin.longitude_deg)
    toward_enu = sun_position(place, utc_s).toward_enu
    return toward_enu if toward_enu[2] > 0.0 else None
