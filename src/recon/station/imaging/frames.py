"""Frames: kept for showing; those of imaging drones are projected on the ground by the worker.

A frame carries no capture time and no telemetry. It is given the telemetry nearest to its estimated
capture time, relative to the frame on which the site's control points were marked; the worker
aligns it by its content from there. One frame is projected at a time, of whichever imaging drone
has waited longest; of each drone the newest one waits.
"""

from collections.abc import Iterator

from recon.model.imagery import Frame, Registration, TelemetryReference
from recon.model.replacing import replace
from recon.model.report import ImageReport
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.model.vehicle import VehicleProfile, VehicleState
from recon.station.imaging import shade
from recon.station.imaging.projection import ProjectedFrame, projection
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imaging import (
    ImagerFrames,
    ImagerSample,
    Imaging,
    LayMarkedFrame,
    ProjectFrame,
)
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Stepped

SAMPLE_NEAR_S = 3.0
"""Running video causes telemetry dropouts of a second or two; further from the moment of capture, a
frame would be projected from where the imaging drone was, not from where it is."""

LOST_FOR_S = 10.0
"""A climb or a flight to another place loses registration for some seconds: no trouble."""

_MISSING = "no telemetry of the imaging drone within 3 s of the frame's capture"
_NO_PROFILE = VehicleProfile(serial="")


def on_telemetry(station: Station, vehicle: VehicleState, now_ns: int) -> Station:
    """Return the station with a vehicle's telemetry kept for its frames, if it takes any."""
    imager = station.imaging.imagers.get(vehicle.serial or "")
    if imager is None:
        return station
    kept = station.settings.pose_history_samples
    sampled = with_sample(imager, vehicle, now_ns, kept)
    return replace(station, imaging=_with_imager(station.imaging, sampled))


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
    imager = station.imaging.imagers.get(frame.serial)
    if imager is None:
        return station, ()
    is_flying = vehicle.is_flying.value is True
    imager = with_frame(imager, frame, is_flying, _utc_s(station, frame))
    return started(station, _with_imager(station.imaging, imager))


def with_sample(
    imager: ImagerFrames, vehicle: VehicleState, now_ns: int, kept: int
) -> ImagerFrames:
    """Return the state with the imaging drone's newest telemetry, if it is complete."""
    telemetry = TelemetryReference.from_report(
        vehicle.position.value, vehicle.height_above_takeoff_m.value, vehicle.attitude.value
    )
    if telemetry is None:
        return imager
    samples = (*imager.samples, ImagerSample(now_ns, telemetry))
    return replace(imager, samples=samples[-kept:])


def _utc_s(station: Station, frame: Frame) -> float | None:
    """Return when a frame was captured, for the sun: seconds after 1970."""
    if station.clock is None:
        return None
    clock_s = ns_to_seconds(frame.captured_at_ns + station.clock.ahead_ns)
    return clock_s + station.settings.sun_time_ahead_s


def with_frame(
    imager: ImagerFrames, frame: Frame, is_flying: bool, captured_utc_s: float | None = None
) -> ImagerFrames:
    """Return the state in which a frame waits to be projected, in place of one that waited before.

    It does not without telemetry at its capture, or without a marked frame on the ground.
    """
    sample = sample_at(imager.samples, frame.captured_at_ns)
    if sample is None:
        return replace(imager, latest_error=_MISSING)
    reference = imager.reference
    if reference is None:
        if not is_flying:
            return imager
        reference = sample.telemetry
    dropped = imager.frames_dropped + (imager.waiting is not None)
    waiting = ProjectFrame(frame, sample.telemetry, reference, captured_utc_s)
    if imager.marked_pose is not None:
        waiting = LayMarkedFrame(
            frame, sample.telemetry, reference, captured_utc_s, marked_pose=imager.marked_pose
        )
    return replace(imager, reference=reference, waiting=waiting, frames_dropped=dropped)


def started(station: Station, imaging: Imaging) -> Stepped:
    """Start a job for the frame that waits longest, unless one is running."""
    waiting = [each.waiting for each in imaging.imagers.values() if each.waiting is not None]
    if imaging.job_id is not None or not waiting:
        return replace(station, imaging=imaging), ()
    work = min(waiting, key=lambda each: each.frame.received_at_ns)
    serial, number = work.frame.serial, imaging.next_job_id
    imager = imaging.imagers[serial]
    imaging = _with_imager(imaging, replace(imager, waiting=None))
    imaging = replace(imaging, job_id=number, job_serial=serial, next_job_id=number + 1)
    job = Job(number, PROJECT_FRAME, replace(work, registration=imager.registration))
    return replace(station, imaging=imaging), (job,)


def _with_imager(imaging: Imaging, imager: ImagerFrames) -> Imaging:
    return replace(imaging, imagers={**imaging.imagers, imager.serial: imager})


def conditions(station: Station) -> Iterator[Condition]:
    """Yield the alarms of the imaging pipeline: frames not projected, not aligned, not read."""
    for imager in station.imaging.imagers.values():
        yield from _laying_conditions(imager, station.settings.imaging_trouble_after_s)
    yield from shade.conditions(station)


def _laying_conditions(imager: ImagerFrames, trouble_after_s: float) -> Iterator[Condition]:
    image, serial = imager.ground_image, imager.serial
    is_lost = image is not None and image.registration is Registration.LOST
    # Frames that are not projected at all have an alarm of their own, as after landing.
    if is_lost and imager.latest_error is None:
        yield Condition(
            key=f"registration:{serial}",
            severity=Severity.WARNING,
            rule="registration",
            vehicle_name=serial,
            text="the ground image is placed by telemetry alone and may be off by metres: "
            f"{imager.registration_problem}",
            serial=serial,
            after_s=LOST_FOR_S,
        )
    if imager.latest_error is not None:
        yield Condition(
            key=f"imaging:{serial}",
            severity=Severity.WARNING,
            rule="imaging",
            vehicle_name=serial,
            text=f"frames of the imaging drone are not projected: {imager.latest_error}",
            serial=serial,
            after_s=trouble_after_s,
        )


def sample_at(samples: tuple[ImagerSample, ...], at_ns: int) -> ImagerSample | None:
    """Return the sample nearest in time, unless even that one is too far off."""
    nearest = min(samples, key=lambda sample: abs(sample.at_ns - at_ns), default=None)
    if nearest is None or abs(nearest.at_ns - at_ns) > seconds_to_ns(SAMPLE_NEAR_S):
        return None
    return nearest


def _projected(station: Station, job_id: int, projected: ProjectedFrame, _now_ns: int) -> Stepped:
    """Keep a ground image unless a newer one is there already, and read it for shade."""
    imaging, image = station.imaging, projected.image
    imager = imaging.imagers.get(image.serial)
    if imager is None:
        return station, ()
    if job_id == imaging.job_id:
        imager = replace(
            imager, registration=projected.registration, registration_problem=projected.problem
        )
        imaging = replace(imaging, job_id=None)
    latest = imager.ground_image
    is_newer = latest is None or latest.captured_at_ns <= image.captured_at_ns
    if is_newer:
        imager = replace(imager, ground_image=image, latest_error=None)
    station, next_job = started(station, _with_imager(imaging, imager))
    if not is_newer:
        return station, next_job
    station, outputs = shade.on_ground_image(station, image)
    return station, (*next_job, *outputs)


def _not_projected(station: Station, job_id: int, error: str, _now_ns: int) -> Stepped:
    imaging = station.imaging
    if job_id != imaging.job_id:
        return station, ()
    return _ended(station, replace(imaging.imagers[imaging.job_serial], latest_error=error))


def _dropped(station: Station, job_id: int, _now_ns: int) -> Stepped:
    imaging = station.imaging
    if job_id != imaging.job_id:
        return station, ()
    imager = imaging.imagers[imaging.job_serial]
    return _ended(station, replace(imager, frames_dropped=imager.frames_dropped + 1))


def _ended(station: Station, imager: ImagerFrames) -> Stepped:
    """The job of an imaging drone's frame has ended, and left this state: start the next."""
    return started(station, replace(_with_imager(station.imaging, imager), job_id=None))


PROJECT_FRAME: JobKind[ProjectFrame, ProjectedFrame] = JobKind(
    "project_frame", projection, _projected, _not_projected, _dropped
)
"""Aligns a frame and projects it on the site's ground grid."""
