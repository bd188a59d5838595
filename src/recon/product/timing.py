"""Which photos belong to a flight, and when, where from and how each was taken.

Photos that an app has reported are matched by their index (`reported_photos`). Others of one camera
share a clock; `clock` finds its offset. A photo's own statements of height and
attitude count more than the vehicle's telemetry.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from recon.geo import enu_from_geo
from recon.model.arrays import FloatArray, IntArray
from recon.model.units import NS_PER_S
from recon.product.clock import (
    ClockFit,
    Clocks,
    Shots,
    clocks_of,
    offset_text,
    places_at,
    stated_clock,
    times_of,
)
from recon.product.flight import FlightData, RecordedTrack
from recon.product.footprint import DOWN_DEG, LOWEST_PITCH_DEG, Aim, PhotoView
from recon.product.headings import (
    AIRCRAFT,
    COURSE,
    GIMBAL,
    RECORDED,
    best_guess_deg,
    signed_deg,
)
from recon.product.photos.photo import GimbalAttitude, Photo
from recon.product.reported_photos import numbers_of, reported_fits

LOWEST_M = 5.0
"""Least height above takeoff: a photo on the ground shows a pad."""
ZONE_STEP_S, ZONE_WITHIN_S = 900.0, 180.0
"""Time zones differ by quarters of an hour; a clock left alone for a year is minutes off."""
COURSE_OVER_NS, SLOWEST_COURSE_MPS = NS_PER_S, 1.5
"""A course is that between a second earlier and later, of a vehicle that moves."""
SATELLITES_WITHIN_S = 20.0
"""Satellite time and UTC differ by 18 leap seconds, and cameras write the one for the other."""


@dataclass(frozen=True, slots=True)
class StatedCamera:
    """What a person states of the camera; None where it is estimated, or read from EXIF."""

    clock_offset_s: float | None = None
    """Offset to add to every camera's clock to get UTC."""
    across_deg: float | None = None
    """Field along the longer side."""


@dataclass(frozen=True, slots=True, eq=False)
class TimedPhoto:
    """A photo with its vehicle, time and pose."""

    photo: Photo
    serial: str
    at_ns: int
    """Station time."""
    sigma_s: float
    view: PhotoView
    height_above_takeoff_m: float
    headings_deg: Mapping[str, float] = field(default_factory=dict)
    """Headings of the picture's top, by what states them; they may contradict each other."""


@dataclass(frozen=True, slots=True)
class CameraClock:
    """A camera's clock, as found on one vehicle's track."""

    camera: str
    serial: str
    vehicle: str
    offset_s: float
    """Offset to add to the camera's clock to get UTC."""
    sigma_s: float
    photos: int
    distance_m: float
    is_stated: bool = False
    is_reported: bool = False
    """Whether its app has reported each of the photos: no clock was searched for."""

    def __str__(self) -> str:
        name = f"{self.camera}, {self.photos} photos of {self.vehicle}"
        if self.is_reported:
            return (
                f"{name}: each by its app's report, {self.distance_m:.1f} m from it; clock offset "
                f"{offset_text(self.offset_s)}"
            )
        if self.is_stated:
            return f"{name}: clock offset {offset_text(self.offset_s)}, as stated"
        return (
            f"{name}: clock offset {offset_text(self.offset_s)}, 95 % within "
            f"{2.0 * self.sigma_s:.1f} s; photos are {self.distance_m:.1f} m from the track"
        )


@dataclass(slots=True)
class Timed:
    """Photos with times, the cameras' clocks, and sentences for the rest."""

    photos: list[TimedPhoto] = field(default_factory=list)
    clocks: list[CameraClock] = field(default_factory=list)
    refused: dict[str, str] = field(default_factory=dict)
    """Why a photo is not tagged, by its name."""
    warnings: list[str] = field(default_factory=list)


def timed_photos(flight: FlightData, photos: Sequence[Photo], stated: StatedCamera) -> Timed:
    """Return the photos that belong to a flight, each with its time and pose."""
    found = Timed()
    tracks = flight.survey_tracks or flight.tracks
    by_camera: dict[tuple[str, str, str], list[Photo]] = {}
    for photo in photos:
        by_camera.setdefault(photo.camera, []).append(photo)
    for group in by_camera.values():
        group.sort(key=lambda photo: (photo.clock_ns, photo.name))
        shots = _shots(flight, group)
        clocks = _by_reports(flight, group, shots, tracks, stated)
        clocks = clocks or _clocks(flight, shots, tracks, stated)
        for fit in clocks.fits:
            _add_fit(found, flight, group, shots, fit, stated)
        for index in clocks.left:
            found.refused[group[index].name] = clocks.reason
        if len({fit.serial for fit in clocks.fits}) > 1:
            found.warnings.append(
                f"{group[0].camera_name}: its photos lie on the tracks of {len(clocks.fits)} "
                "vehicles or flights: several cameras without serial numbers?"
            )
    found.photos.sort(key=lambda each: (each.at_ns, each.photo.name))
    _warn_about_clocks(found, flight, stated)
    return found


def _shots(flight: FlightData, photos: Sequence[Photo]) -> Shots:
    enu_m = enu_from_geo(
        flight.frame,
        [photo.latitude_deg for photo in photos],
        [photo.longitude_deg for photo in photos],
        flight.frame.origin.ellipsoid_height_m,
    )
    clock_ns = np.array([photo.clock_ns for photo in photos], dtype=np.int64)
    return Shots(clock_ns, enu_m[:, 0], enu_m[:, 1], max(photo.clock_step_s for photo in photos))


def _clocks(
    flight: FlightData, shots: Shots, tracks: Mapping[str, RecordedTrack], stated: StatedCamera
) -> Clocks:
    if stated.clock_offset_s is None:
        return clocks_of(shots, tracks, flight.utc_ahead_ns)
    return stated_clock(shots, tracks, flight.utc_ahead_ns, stated.clock_offset_s)


def _by_reports(
    flight: FlightData,
    group: Sequence[Photo],
    shots: Shots,
    tracks: Mapping[str, RecordedTrack],
    stated: StatedCamera,
) -> Clocks | None:
    """Return the times that apps reported of a camera's photos; None where none was reported.

    A photo without a report is dated by the offset of the others.
    """
    if stated.clock_offset_s is not None:
        return None
    numbers = numbers_of([photo.path.name for photo in group])
    reports = [each for each in flight.reported if each.serial in tracks]
    fits, left = reported_fits(shots, numbers, reports, flight.utc_ahead_ns)
    if not fits:
        return None
    track = {fits[0].serial: tracks[fits[0].serial]}
    offset_s = fits[0].offset_s
    others = stated_clock(shots.chosen(left), track, flight.utc_ahead_ns, offset_s)
    more = tuple(replace(fit, photos=left[fit.photos]) for fit in others.fits)
    reason = "its app has reported no such photo, and it is not near the vehicle's track"
    return Clocks((*fits, *more), left[others.left], reason)


def _add_fit(
    found: Timed,
    flight: FlightData,
    group: Sequence[Photo],
    shots: Shots,
    fit: ClockFit,
    stated: StatedCamera,
) -> None:
    track = flight.tracks[fit.serial]
    at_ns = times_of(shots, track, fit, flight.utc_ahead_ns)
    heights = np.interp(at_ns, track.at_ns, track.height_m)
    yaws, courses = _headings(track, at_ns), _courses(track, at_ns)
    for index, moment, height_m, *headings in zip(
        *(each.tolist() for each in (fit.photos, at_ns, heights, yaws, courses)), strict=True
    ):
        photo = group[index]
        place = (float(shots.east_m[index]), float(shots.north_m[index]))
        flown = flight.survey_at(track, int(moment))
        above_ground_m = None if flown is None else flown.height_above_ground_m
        pose = height_m, above_ground_m, dict(zip((RECORDED, COURSE), headings, strict=True))
        timed = _timed(photo, fit, int(moment), place, pose, stated)
        if isinstance(timed, str):
            found.refused[photo.name] = timed
        else:
            found.photos.append(timed)
    found.clocks.append(
        CameraClock(
            group[0].camera_name,
            fit.serial,
            flight.names.get(fit.serial, fit.serial),
            fit.offset_s,
            fit.sigma_s,
            len(fit.photos),
            fit.distance_m,
            stated.clock_offset_s is not None,
            fit.at_ns is not None,
        )
    )


def _headings(track: RecordedTrack, at_ns: IntArray) -> FloatArray:
    """Return headings (N,) in degrees at times; NaN where the app reported none."""
    turned = np.deg2rad(track.yaw_deg)
    sine, cosine = (np.interp(at_ns, track.at_ns, part(turned)) for part in (np.sin, np.cos))
    return np.rad2deg(np.arctan2(sine, cosine))


def _courses(track: RecordedTrack, at_ns: IntArray) -> FloatArray:
    """Return courses over ground (N,) in degrees; NaN where the vehicle hardly moved."""
    (east, north), (from_east, from_north) = (
        places_at(track, at_ns + side * COURSE_OVER_NS) for side in (1, -1)
    )
    east_m, north_m = east - from_east, north - from_north
    slowest_m = SLOWEST_COURSE_MPS * 2 * COURSE_OVER_NS / NS_PER_S
    is_moving = np.hypot(east_m, north_m) > slowest_m
    return np.where(is_moving, np.rad2deg(np.arctan2(east_m, north_m)), np.nan)


def _looks_deg(attitude: GimbalAttitude) -> tuple[float, float]:
    """Return the heading of the picture's top and the pitch of a camera by its gimbal.

    A gimbal rolled over by 180 degrees turns the picture about its middle: the top looks back, and
    the pitch counts on from straight down.
    """
    if abs(signed_deg(attitude.roll_deg or 0.0)) <= 90.0:
        return attitude.yaw_deg, attitude.pitch_deg
    return signed_deg(attitude.yaw_deg + 180.0), -180.0 - attitude.pitch_deg


def _timed(
    photo: Photo,
    fit: ClockFit,
    at_ns: int,
    place_m: tuple[float, float],
    recorded: tuple[float, float | None, Mapping[str, float]],
    stated: StatedCamera,
) -> TimedPhoto | str:
    """Return a photo's time and pose, or why it has none.

    `recorded` is its height above takeoff, that above the ground of a survey that followed it, and
    its headings.
    """
    height_m, above_ground_m, headings_deg = recorded
    if photo.height_above_takeoff_m is not None:
        height_m = photo.height_above_takeoff_m
    stated_deg, pitch_deg = dict[str, float](), DOWN_DEG
    if photo.attitude is not None:
        stated_deg[GIMBAL], pitch_deg = _looks_deg(photo.attitude)
    if photo.flight_yaw_deg is not None:
        stated_deg[AIRCRAFT] = photo.flight_yaw_deg
    stated_deg |= {name: each for name, each in headings_deg.items() if np.isfinite(each)}
    across_deg = stated.across_deg or photo.across_deg
    if across_deg is None:
        return "EXIF states no focal length: give the camera's field of view with --field"
    if not np.isfinite(height_m):
        return "neither the photo nor the record states its height above takeoff"
    # In a survey above ground a drone may fly below its takeoff point.
    if (height_m if above_ground_m is None else abs(height_m)) < LOWEST_M:
        return f"taken {height_m:.1f} m above takeoff, below {LOWEST_M:g} m: a photo on the ground"
    if not stated_deg:
        return "neither the photo nor the record states its heading"
    if pitch_deg > LOWEST_PITCH_DEG:
        return f"the camera looked {pitch_deg:.0f} degrees up or down: not at the ground below"
    over_m = height_m if above_ground_m is None else above_ground_m
    aim = Aim(*place_m, over_m, best_guess_deg(stated_deg), pitch_deg)
    view = PhotoView(aim, across_deg, photo.cols, photo.rows)
    return TimedPhoto(photo, fit.serial, at_ns, fit.sigma_s, view, height_m, stated_deg)


def _warn_about_clocks(found: Timed, flight: FlightData, stated: StatedCamera) -> None:
    """Warn where the same rows, flown at another time, would fit as well."""
    if stated.clock_offset_s is not None:
        return
    for clock in found.clocks:
        off_zone_s = abs(clock.offset_s - round(clock.offset_s / ZONE_STEP_S) * ZONE_STEP_S)
        if off_zone_s > ZONE_WITHIN_S:
            found.warnings.append(
                f"{clock.camera}: an offset of {offset_text(clock.offset_s)} is no time zone: if "
                "the same survey was flown twice, check that these are the photos of this flight"
            )
    for timed in found.photos:
        if timed.photo.satellite_ns is None:
            continue
        off_s = abs(timed.photo.satellite_ns - timed.at_ns - flight.utc_ahead_ns) / NS_PER_S
        if off_s > SATELLITES_WITHIN_S:
            found.warnings.append(
                f"{timed.photo.camera_name}: the satellites' time in {timed.photo.name} is "
                f"{off_s:.0f} s off: these may be the photos of another flight over the same rows"
            )
            return
