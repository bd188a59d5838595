"""Applies what an app reports beside telemetry to its vehicle's state: facts and photos."""

from dataclasses import dataclass

from recon.model.app_report import AppFacts, PhotosReport, PhotoTally, ReportedPhoto
from recon.model.replacing import replace
from recon.model.units import Stamped, seconds_to_ns
from recon.model.vehicle import VehicleState


@dataclass(frozen=True, slots=True)
class TakenPhoto:
    """A photo that is new, and when it was taken in the station's time."""

    photo: ReportedPhoto
    at_ns: int


def fold_facts(state: VehicleState, facts: AppFacts, now_ns: int) -> VehicleState:
    """Return the state with an app's facts, whole: what they leave out is unknown from now on."""
    return replace(state, app_facts=Stamped(facts, now_ns))


def new_photos(state: VehicleState, report: PhotosReport, now_ns: int) -> tuple[TakenPhoto, ...]:
    """Return the photos of a report that are of this vehicle and not known yet, oldest first.

    An index that is not above the newest one of its series is a repetition.
    """
    if report.serial is not None and report.serial != state.serial:
        return ()
    tally = state.photo_tally
    last = 0 if tally is None or tally.series != report.series else tally.newest_index
    found = []
    for photo in report.photos:
        if photo.index > last:
            last = photo.index
            found.append(TakenPhoto(photo, now_ns - seconds_to_ns(photo.age_s)))
    return tuple(found)


def fold_photos(state: VehicleState, report: PhotosReport, now_ns: int) -> VehicleState:
    """Return the state with a report's new photos counted; another series begins anew."""
    new = new_photos(state, report, now_ns)
    if not new:
        return state
    tally = state.photo_tally
    if tally is None or tally.series != report.series:
        # Photos before the first report are none that the station has missed.
        tally = PhotoTally(report.series, reported=new[0].photo.index - 1)
    counted = PhotoTally(
        report.series, new[-1].photo.index, tally.reported + len(new), new[-1].at_ns
    )
    return replace(state, photo_tally=counted)
