"""Frames: kept for showing; those of the imaging drone are projected on the ground by the worker.

A frame carries no capture time and no telemetry. It is projected with the telemetry nearest to its
estimated capture time, relative to the frame on which the site's control points were marked.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from recon.camera.ground import GroundProjector
from recon.camera.motion import TelemetryReference, displaced_pose
from recon.geo import shift_east_north_m, sun_position
from recon.model.errors import ReconError
from recon.model.geo import LatLon, LocalFrame
from recon.model.imagery import FloatArray, Frame, GroundImage
from recon.model.replacing import replace
from recon.model.report import ImageReport
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.site import Site
from recon.station.imaging import shade
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imaging import ImagerSample, Imaging
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Stepped

SAMPLE_NEAR_S = 3.0
"""Running video causes telemetry dropouts of a second or two; further from the moment of capture, a
frame would be projected from where the imaging drone was, not from where it is."""

_MISSING = "no telemetry of the imaging drone within 3 s of the frame's capture"
_NO_PROFILE = VehicleProfile(serial="")


@dataclass(frozen=True, slots=True, eq=False)
class LayFrame:
    """A frame to project, the telemetry at its capture, and that of the marked frame."""

    frame: Frame
    telemetry: TelemetryReference
    reference: TelemetryReference
    captured_utc_s: float | None = None
    """By the computer's clock, for the sun's position; None before the clock was read."""


def on_telemetry(station: Station, vehicle: VehicleState, now_ns: int) -> Station:
    """Return the station with a vehicle's telemetry kept for its frames, if it takes any."""
    if vehicle.serial is None or vehicle.serial != station.imaging.imager_serial:
        return station
    kept = station.settings.pose_history_samples
    return replace(station, imaging=with_sample(station.imaging, vehicle, now_ns, kept))


def on_frame(station: Station, vehicle: VehicleState, report: ImageReport, now_ns: int) -> Stepped:
    """Keep the newest frame of every vehicle; project those of the imaging drone."""
    if vehicle.serial is None:
        return station, ()
    profile = vehicle.profile or _NO_PROFILE
    frame = Frame(
        id=station.next_frame_id,
        serial=vehicle.serial,
        received_at_ns=now_ns,
        captured_at_ns=now_ns - seconds_to_ns(profile.video_latency_s),
        captured_sigma_s=profile.video_latency_sigma_s,
        rgb=report.rgb,
        jpeg=report.jpeg,
    )
    others = ((key, kept) for key, kept in station.frames.items() if key != frame.serial)
    frames = dict([*others, (frame.serial, frame)][-station.settings.frames_kept :])
    station = replace(station, frames=frames, next_frame_id=frame.id + 1)
    if frame.serial != station.imaging.imager_serial:
        return station, ()
    imaging, job = lay_job(
        station.imaging, frame, vehicle.is_flying.value is True, _utc_s(station, frame)
    )
    return replace(station, imaging=imaging), () if job is None else (job,)


def with_sample(imaging: Imaging, imager: VehicleState, now_ns: int, kept: int) -> Imaging:
    """Return the state with the imaging drone's newest telemetry, if it is complete."""
    telemetry = TelemetryReference.from_report(
        imager.position.value, imager.height_above_takeoff_m.value, imager.attitude.value
    )
    if telemetry is None:
        return imaging
    samples = (*imaging.samples, ImagerSample(now_ns, telemetry))
    return replace(imaging, samples=samples[-kept:])


def _utc_s(station: Station, frame: Frame) -> float | None:
    """Return when a frame was captured, for the sun: seconds after 1970."""
    if station.clock is None:
        return None
    clock_s = ns_to_seconds(frame.captured_at_ns + station.clock.ahead_ns)
    return clock_s + station.settings.sun_time_ahead_s


def lay_job(
    imaging: Imaging, frame: Frame, is_flying: bool, captured_utc_s: float | None = None
) -> tuple[Imaging, Job[LayFrame, GroundImage] | None]:
    """Return the job for a frame; None without telemetry at its capture or a marked frame."""
    sample = _sample_at(imaging.samples, frame.captured_at_ns)
    if sample is None:
        return replace(imaging, latest_error=_MISSING), None
    reference = imaging.reference
    if reference is None:
        if not is_flying:
            return imaging, None
        reference = sample.telemetry
    work = LayFrame(frame, sample.telemetry, reference, captured_utc_s)
    job = Job(imaging.next_job_id, LAY_FRAME, work)
    return replace(imaging, reference=reference, next_job_id=job.id + 1), job


def conditions(station: Station) -> Iterator[Condition]:
    """Yield the alarms of the imaging pipeline: frames not projected, no shade read."""
    imaging = station.imaging
    if imaging.latest_error is not None:
        yield Condition(
            key="imaging",
            severity=Severity.WARNING,
            rule="imaging",
            vehicle_name=imaging.imager_serial or "",
            text=f"frames of the imaging drone are not projected: {imaging.latest_error}",
            serial=imaging.imager_serial,
            after_s=station.settings.imaging_trouble_after_s,
        )
    yield from shade.conditions(station)


def _sample_at(samples: tuple[ImagerSample, ...], at_ns: int) -> ImagerSample | None:
    """The sample nearest in time, unless even that one is too far off."""
    nearest = min(samples, key=lambda sample: abs(sample.at_ns - at_ns), default=None)
    if nearest is None or abs(nearest.at_ns - at_ns) > seconds_to_ns(SAMPLE_NEAR_S):
        return None
    return nearest


def _projection(site: Site) -> Callable[[LayFrame], GroundImage]:
    if site.imager is None or site.frame is None or site.ground_grid is None:
        raise ReconError("the site has no imaging drone with a ground grid")
    imager, frame = site.imager, site.frame
    projector = GroundProjector(site.ground_grid, imager.camera, imager.image_circle)
    mount = site.profiles.get(imager.serial, VehicleProfile(imager.serial)).mount

    def lay(work: LayFrame) -> GroundImage:
        marked, now = work.reference, work.telemetry
        shift_m = shift_east_north_m(frame, marked, now)
        image = projector.lay(
            work.frame, displaced_pose(imager.solution.pose, marked, now, shift_m, mount)
        )
        return replace(
            image,
            toward_sun_enu=_toward_sun_enu(frame, work.captured_utc_s),
            exposure_locked=imager.exposure_locked,
        )

    return lay


def _toward_sun_enu(frame: LocalFrame, utc_s: float | None) -> FloatArray | None:
    """Return the unit vector to the sun; None at night and without a time."""
    if utc_s is None:
        return None
    place = LatLon(frame.origin.latitude_deg, frame.origin.longitude_deg)
    toward_enu = sun_position(place, utc_s).toward_enu
    return toward_enu if toward_enu[2] > 0.0 else None


def _laid(station: Station, _job_id: int, image: GroundImage, _now_ns: int) -> Stepped:
    """Keep a ground image unless a newer one is there already, and read it for shade."""
    latest = station.imaging.ground_image
    if latest is not None and latest.captured_at_ns > image.captured_at_ns:
        return station, ()
    imaging = replace(station.imaging, ground_image=image, latest_error=None)
    return shade.on_ground_image(replace(station, imaging=imaging), image)


def _not_laid(station: Station, _job_id: int, error: str, _now_ns: int) -> Stepped:
    return replace(station, imaging=replace(station.imaging, latest_error=error)), ()


def _dropped(station: Station, _job_id: int, _now_ns: int) -> Stepped:
    dropped = station.imaging.frames_dropped + 1
    return replace(station, imaging=replace(station.imaging, frames_dropped=dropped)), ()


LAY_FRAME: JobKind[LayFrame, GroundImage] = JobKind(
    "lay_frame", _projection, _laid, _not_laid, _dropped
)
"""Projects a frame on the site's ground grid."""
