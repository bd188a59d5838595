"""Frames of the eye, sent to be laid on the ground with the telemetry that held at capture."""

from dataclasses import dataclass

from recon.camera.motion import TelemetryReference
from recon.model.imagery import Frame, GroundImage
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState

LAY_FRAME = "lay_frame"
"""The kind of work that turns a frame into a ground image."""

SAMPLE_NEAR_S = 3.0
"""Running video causes telemetry dropouts of a second or two; further from the moment of capture, a
frame would be laid where the eye was, not where it is."""

_MISSING = "no telemetry of the eye within 3 s of the frame's capture"


@dataclass(frozen=True, slots=True)
class ImagerSample:
    """The eye's telemetry at one moment."""

    at_ns: int
    telemetry: TelemetryReference


@dataclass(frozen=True, slots=True, eq=False)
class LayFrame:
    """The work: this frame, where the eye was then, and where it was for the marked frame."""

    frame: Frame
    telemetry: TelemetryReference
    reference: TelemetryReference


@dataclass(frozen=True, slots=True, eq=False)
class Imaging:
    """What the station knows of the eye's view of the ground.

    `reference` is the telemetry of the frame the control points were marked on; when the site does
    not give it, the first frame received in flight stands for it.
    """

    imager_serial: str | None = None
    reference: TelemetryReference | None = None
    is_reference_assumed: bool = True
    samples: tuple[ImagerSample, ...] = ()
    ground_image: GroundImage | None = None
    captured_sigma_s: float = 0.0
    next_job_id: int = 1
    frames_dropped: int = 0
    latest_error: str | None = None


def with_sample(imaging: Imaging, imager: VehicleState, now_ns: int, kept: int) -> Imaging:
    """Return the state with the eye's newest telemetry remembered, if it is complete."""
    telemetry = TelemetryReference.from_report(
        imager.position.value, imager.height_above_takeoff_m.value, imager.attitude.value
    )
    if telemetry is None:
        return imaging
    samples = (*imaging.samples, ImagerSample(now_ns, telemetry))
    return replace(imaging, samples=samples[-kept:])


def take_frame(
    imaging: Imaging, frame: Frame, is_flying: bool
) -> tuple[Imaging, tuple[int, LayFrame] | None]:
    """Return the work for a frame of the eye, or None while its place cannot be told."""
    sample = _sample_at(imaging.samples, frame.captured_at_ns)
    if sample is None:
        return replace(imaging, latest_error=_MISSING), None
    if imaging.reference is None:
        if not is_flying:
            return imaging, None
        imaging = replace(imaging, reference=sample.telemetry)
    assert imaging.reference is not None
    job_id = imaging.next_job_id
    job = LayFrame(frame, sample.telemetry, imaging.reference)
    return replace(imaging, next_job_id=job_id + 1), (job_id, job)


def _sample_at(samples: tuple[ImagerSample, ...], at_ns: int) -> ImagerSample | None:
    """The sample nearest in time, unless even that one is far off."""
    nearest = min(samples, key=lambda sample: abs(sample.at_ns - at_ns), default=None)
    if nearest is None or abs(nearest.at_ns - at_ns) > seconds_to_ns(SAMPLE_NEAR_S):
        return None
    return nearest
