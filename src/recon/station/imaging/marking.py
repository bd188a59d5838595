"""An imaging drone's marked frame, replaced while the station runs.

Control points were marked on a new frame and saved; from the next frame on, ground images are
placed by them. Registration begins anew: it has aligned frames with those placed by the old pose.
This moves no drone, so it is possible in flight, where the frame comes from.
"""

from recon.camera.registration import RegistrationState
from recon.model.event import ImagerMarked
from recon.model.replacing import replace
from recon.record.audit.audit import AuditEntry
from recon.station.state.station import Station


def mark(station: Station, event: ImagerMarked, _now_ns: int) -> Station:
    """Return the station with a new marked frame of one imaging drone."""
    imaging = station.imaging
    imager = imaging.imagers.get(event.serial)
    if imager is None:
        return station
    marked = replace(
        imager,
        reference=event.telemetry,
        is_reference_assumed=event.telemetry is None,
        is_placed_by_telemetry=event.is_placed_by_telemetry,
        outlook=event.outlook,
        marked_pose=event.pose,
        registration=RegistrationState(),
        waiting=None,
    )
    # What a running job keeps for registration is of the old pose.
    job_id = None if imaging.job_serial == event.serial else imaging.job_id
    imagers = {**imaging.imagers, event.serial: marked}
    return replace(station, imaging=replace(imaging, imagers=imagers, job_id=job_id))


def entry(event: ImagerMarked) -> AuditEntry:
    """Return the entry of a new marked frame."""
    text = f"camera of imaging drone {event.serial} placed anew"
    text += " by telemetry" if event.rms_px is None else f", residual {event.rms_px:.2f} px rms"
    return AuditEntry("site.calibrated", text, event.by, details={"serial": event.serial})
