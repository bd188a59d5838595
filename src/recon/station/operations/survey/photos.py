"""Photos that apps report, for the surveys of their vehicles; and a timer that takes none.

Of a vehicle whose app reports its photos, these count instead of its positions. A photo that is
due on a row and does not come is an alarm: the timer did not start, or has stopped.
"""

from types import MappingProxyType

from recon.fleet.app_facts import TakenPhoto
from recon.guidance.survey import PhotoSample, PositionSample, SurveyPlan
from recon.guidance.survey.progress import is_flown_as_planned, off_height_m
from recon.model.replacing import replace
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.safety.datum import places_m, takeoff_up_m
from recon.safety.reported_facts import reported_facts
from recon.station.operations.settings import SURVEY_TIMES
from recon.station.state.station import Station
from recon.station.state.survey_record import PhotoWatch, SurveyRecord

LOOKED_AT_S = 0.5
"""Positions nearer in time give no speed, as in the survey's progress."""
NO_WATCH = PhotoWatch()


def reports_photos(vehicle: VehicleState, now_ns: int) -> bool:
    """Return whether a vehicle's app reports each photo; of others the timer is assumed to run."""
    return reported_facts(vehicle, now_ns).reports_photos is True


def on_photos(station: Station, vehicle: VehicleState, taken: tuple[TakenPhoto, ...]) -> Station:
    """Keep a vehicle's new photos for the surveys it belongs to."""
    surveys, serial = station.surveys, vehicle.serial
    if serial is None or not taken:
        return station
    samples = tuple(_samples(station, vehicle, taken))
    for record in surveys.records.values():
        if serial not in record.members or not record.is_open:
            continue
        kept = record.positions
        for sample in samples:
            kept = kept.with_one((serial, sample), SURVEY_TIMES.positions_kept)
        watch = record.photo_watches.get(serial, NO_WATCH)
        watch = replace(watch, newest_photo_ns=taken[-1].at_ns, silent_s=None)
        surveys = surveys.put(_with_watch(replace(record, positions=kept), serial, watch))
    return station if surveys is station.surveys else replace(station, surveys=surveys)


def watch_timer(record: SurveyRecord, serial: str, sample: PositionSample) -> SurveyRecord:
    """Return a survey after a position of a vehicle that reports its photos: is one overdue?

    Times are those of the vehicle's own telemetry: while its link is silent nothing is overdue,
    and what arrives together is in its order.
    """
    watch, state = record.photo_watches.get(serial, NO_WATCH), record.state
    before = watch.sample
    assert state is not None  # or it would not be open
    if before is not None and sample.at_ns - before.at_ns < seconds_to_ns(LOOKED_AT_S):
        return record
    watch = replace(watch, sample=sample)
    if before is None or not _is_on_row(before, sample, state.plan):
        return _with_watch(record, serial, replace(watch, on_row_since_ns=None))
    since_ns = before.at_ns if watch.on_row_since_ns is None else watch.on_row_since_ns
    expected_since_ns = max(since_ns, watch.newest_photo_ns or since_ns)
    silent_s = ns_to_seconds(sample.at_ns - expected_since_ns)
    is_overdue = silent_s > overdue_s(record.survey.camera.interval_s)
    watch = replace(
        watch, on_row_since_ns=since_ns, silent_s=silent_s if is_overdue else watch.silent_s
    )
    return _with_watch(record, serial, watch)


def overdue_s(interval_s: float) -> float:
    """Return after how long without a report a photo is overdue.

    Within two intervals, and later than one by what a link delays. Below a second apps report
    several photos together, once a second.
    """
    return SURVEY_TIMES.photo_overdue_intervals * interval_s + (1.0 if interval_s < 1.0 else 0.0)


def _samples(
    station: Station, vehicle: VehicleState, taken: tuple[TakenPhoto, ...]
) -> list[PhotoSample]:
    """Return the photos whose place, height and heading are known."""
    frame, attitude = station.airspace.airspace.frame, vehicle.attitude.value
    if frame is None:
        return []
    takeoff_m = takeoff_up_m(station.airspace, vehicle)
    samples = []
    for each in taken:
        photo, place = each.photo, each.photo.place
        yaw_deg = photo.yaw_deg
        if yaw_deg is None and attitude is not None:
            yaw_deg = attitude.yaw_deg
        if place is None or photo.height_above_takeoff_m is None or yaw_deg is None:
            continue
        east_m, north_m = (float(metres) for metres in places_m(frame, [place])[0])
        samples.append(
            PhotoSample(
                each.at_ns,
                east_m,
                north_m,
                photo.height_above_takeoff_m,
                yaw_deg,
                takeoff_m,
                photo.gimbal_pitch_deg,
            )
        )
    return samples


def _is_on_row(a: PositionSample, b: PositionSample, plan: SurveyPlan) -> bool:
    """Return whether a vehicle flies along a row, over ground of the region."""
    off_m = off_height_m(plan, (a, b))
    if off_m is None:
        return False
    start, end = plan.lattice.along_across_m(
        [(a.east_m, a.north_m), (b.east_m, b.north_m)]
    ).tolist()
    moved_m = end[0] - start[0], end[1] - start[1]
    times_ns = (a.at_ns, b.at_ns)
    if not is_flown_as_planned(plan.survey, plan.settings, times_ns, moved_m, off_m):
        return False
    grid = plan.cells.grid
    row = int((grid.north_m - b.north_m) // grid.cell_m)
    col = int((b.east_m - grid.west_m) // grid.cell_m)
    is_on_grid = 0 <= row < grid.rows and 0 <= col < grid.cols
    return is_on_grid and bool(plan.cells.is_inside[row, col])


def _with_watch(record: SurveyRecord, serial: str, watch: PhotoWatch) -> SurveyRecord:
    watches = MappingProxyType({**record.photo_watches, serial: watch})
    return replace(record, photo_watches=watches)
