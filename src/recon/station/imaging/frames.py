"""Frames: kept for showing; those of the imaging drone are projected on the ground by the worker.

A frame carries no capture time and no telemetry. It is given the telemetry nearest to its estimated
capture time, relative to the frame on which the site's control points were marked; the worker
aligns it by its content from there. Frames are taken in order, one at a time.
"""

from collections.abc import Iterator

from recon.camera.motion import TelemetryReference
from recon.model.imagery import Frame, Registration
from recon.model.replacing import replace
from recon.model.report import ImageReport
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.station.imaging import shade
from recon.station.imaging.projection import LaidFrame, projection
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imaging import ImagerSample, Imaging, LayFrame
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Stepped

SAMPLE_NEAR_S = 3.0
"""Running video causes telemetry dropouts of a second or two; further from the moment of capture, a
frame would be projected from where the imaging drone was, not from where it is."""

LOST_FOR_S = 10.0
"""A climb or a flight to another place loses registration for some seconds: no trouble."""

LayJob = Job[LayFrame, LaidFrame]

_MISSING = "no telemetry of the imaging drone within 3 s of the frame's capture"
_NO_PROFILE = VehicleProfile(serial="")


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
    is_flying = vehicle.is_flying.value is True
    return _started(station, lay_job(station.imaging, frame, is_flying, _utc_s(station, frame)))


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
) -> tuple[Imaging, LayJob | None]:
    """Return the job for a frame.

    None without telemetry at its capture or a marked frame, and while another frame's job runs: the
    frame waits then, in place of one that waited before.
    """
    sample = _sample_at(imaging.samples, frame.captured_at_ns)
    if sample is None:
        return replace(imaging, latest_error=_MISSING), None
    reference = imaging.reference
    if reference is None:
        if not is_flying:
            return imaging, None
        reference = sample.telemetry
    dropped = imaging.frames_dropped + (imaging.waiting is not None)
    waiting = LayFrame(frame, sample.telemetry, reference, captured_utc_s)
    return _next(replace(imaging, reference=reference, waiting=waiting, frames_dropped=dropped))


def _next(imaging: Imaging) -> tuple[Imaging, LayJob | None]:
    """Start a job for the frame that waits, unless one is running."""
    if imaging.job_id is not None or imaging.waiting is None:
        return imaging, None
    work = replace(imaging.waiting, registration=imaging.registration)
    number = imaging.next_job_id
    imaging = replace(imaging, waiting=None, job_id=number, next_job_id=number + 1)
    return imaging, Job(number, LAY_FRAME, work)


def _started(station: Station, started: tuple[Imaging, LayJob | None]) -> Stepped:
    imaging, job = started
    return replace(station, imaging=imaging), () if job is None else (job,)


def conditions(station: Station) -> Iterator[Condition]:
    """Yield the alarms of the imaging pipeline: frames not projected, not aligned, not read."""
    imaging = station.imaging
    image = imaging.ground_image
    is_lost = image is not None and image.registration is Registration.LOST
    # Frames that are not projected at all have an alarm of their own, as after landing.
    if is_lost and imaging.latest_error is None:
        yield Condition(
            key="registration",
            severity=Severity.WARNING,
            rule="registration",
            vehicle_name=imaging.imager_serial or "",
            text="the ground image is placed by telemetry alone and may be off by metres: "
            f"{imaging.registration_problem}",
            serial=imaging.imager_serial,
            after_s=LOST_FOR_S,
        )
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


def _laid(station: Station, job_id: int, laid: LaidFrame, _now_ns: int) -> Stepped:
    """Keep a ground image unless a newer one is there already, and read it for shade."""
    imaging = station.imaging
    if job_id == imaging.job_id:
        imaging = replace(
            imaging, registration=laid.registration, registration_problem=laid.problem, job_id=None
        )
    station, next_job = _started(station, _next(imaging))
    latest = imaging.ground_image
    if latest is not None and latest.captured_at_ns > laid.image.captured_at_ns:
        return station, next_job
    imaging = replace(station.imaging, ground_image=laid.image, latest_error=None)
    station, outputs = shade.on_ground_image(replace(station, imaging=imaging), laid.image)
    return station, (*next_job, *outputs)


def _not_laid(station: Station, job_id: int, error: str, _now_ns: int) -> Stepped:
    imaging = replace(_ended(station.imaging, job_id), latest_error=error)
    return _started(station, _next(imaging))


def _dropped(station: Station, job_id: int, _now_ns: int) -> Stepped:
    imaging = _ended(station.imaging, job_id)
    imaging = replace(imaging, frames_dropped=imaging.frames_dropped + 1)
    return _started(station, _next(imaging))


def _ended(imaging: Imaging, job_id: int) -> Imaging:
    return replace(imaging, job_id=None) if job_id == imaging.job_id else imaging


LAY_FRAME: JobKind[LayFrame, LaidFrame] = JobKind(
    "lay_frame", projection, _laid, _not_laid, _dropped
)
"""Aligns a frame and projects it on the site's ground grid."""
