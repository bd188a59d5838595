"""Tagging the photos of a flight: time, place, footprint, sunlit share, and the list to keep.

Pure but for reading the photos' headers: nothing is written here.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import enu_from_geo
from recon.model.errors import RecordError
from recon.model.shade import SUNLIT_TRANSMITTANCE
from recon.model.units import NS_PER_S
from recon.product.choose import choose, views_for
from recon.product.clock import (
    ClockFit,
    Clocks,
    Shots,
    clocks_of,
    offset_text,
    places_at,
    times_of,
)
from recon.product.coverage import (
    ENOUGH_VIEWS,
    Ground,
    PhotoView,
    cells_on,
    ground_of,
    incidence,
    light_of_cells,
    region_of,
    region_of_views,
    to_fly_again,
)
from recon.product.flight import FlightData, RecordedTrack
from recon.product.footprint import LOWEST_PITCH_DEG, Aim, corners_m, sun_on_photo
from recon.product.photo import Photo
from recon.product.sun_at import SunHistory

ByteMap = npt.NDArray[np.uint8]
FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

SUNLIT_SHARE = 0.9
"""Of a photo's known ground, for the photo to be called sunlit."""
MASK_SCALE = 8
"""A mask's pixel is 8 x 8 of the photo's: decimetres on the ground, edges are known to metres."""
LEAST_KNOWN = 0.5
"""Of a photo's ground: with less the photo is called unknown."""
LOWEST_M = 5.0
"""Above takeoff: a photo on the ground shows a pad."""
ZONE_STEP_S, ZONE_WITHIN_S = 900.0, 180.0
"""Time zones differ by quarters of an hour; a clock left alone for a year is minutes off."""

WHITE, BLACK = 255, 0
"""Of a mask: used, and left out."""


@dataclass(frozen=True, slots=True)
class TagOptions:
    """What the user may set."""

    clock_offset_s: float | None = None
    """Added to every camera's clock, in place of an estimate."""
    across_deg: float | None = None
    """The camera's field along the longer side, where EXIF does not state it, or wrongly."""
    overlap: float = 0.6
    """For the list of photos: to each neighbour, along and across."""
    sunlit_share: float = SUNLIT_SHARE


@dataclass(frozen=True, slots=True, eq=False)
class TimedPhoto:
    """A photo with its vehicle, time and pose."""

    photo: Photo
    serial: str
    at_ns: int
    """Station time."""
    sigma_s: float
    aim: Aim
    across_deg: float

    @property
    def view(self) -> PhotoView:
        """Its pose and lens."""
        return PhotoView(self.aim, self.across_deg, self.photo.cols, self.photo.rows)

    @property
    def corners_m(self) -> FloatArray:
        """The footprint's corners (4, 2), east and north."""
        return corners_m(self.aim, self.across_deg, self.photo.cols, self.photo.rows)


@dataclass(frozen=True, slots=True)
class PhotoTag:
    """What was found for one photo."""

    name: str
    sunlit: float
    """Share of its known ground in sun, 0 to 1; NaN where nothing is known."""
    confidence: float
    """0 to 1: the mean over all of its ground."""
    known: float
    """Share of its ground that the shade maps show."""

    def state(self, sunlit_share: float) -> str:
        """Return sunlit, shaded, mixed or unknown."""
        if not self.known >= LEAST_KNOWN:
            return "unknown"
        if self.sunlit >= sunlit_share:
            return "sunlit"
        return "shaded" if self.sunlit <= 1.0 - sunlit_share else "mixed"


@dataclass(frozen=True, slots=True)
class CameraClock:
    """A camera's clock, as found on one vehicle's track."""

    camera: str
    serial: str
    vehicle: str
    offset_s: float
    """To be added to the camera's clock to get UTC."""
    sigma_s: float
    photos: int
    distance_m: float
    is_stated: bool = False

    def __str__(self) -> str:
        name = f"{self.camera}, {self.photos} photos of {self.vehicle}"
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


@dataclass(frozen=True, slots=True, eq=False)
class Selection:
    """The shortest list of photos, and what no photo shows in sun."""

    ground: Ground
    shown: IntArray
    """(N,): photos of each cell inside."""
    sunlit: IntArray
    """(N,): of them, those with the cell in sun."""
    chosen: tuple[str, ...]
    bound: int
    views: int
    again: tuple[shapely.Polygon, ...]


def timed_photos(flight: FlightData, photos: Sequence[Photo], options: TagOptions) -> Timed:
    """Return the photos that belong to a flight, each with its time and pose."""
    found = Timed()
    tracks = flight.survey_tracks or flight.tracks
    by_camera: dict[tuple[str, str, str], list[Photo]] = {}
    for photo in photos:
        by_camera.setdefault(photo.camera, []).append(photo)
    for group in by_camera.values():
        group.sort(key=lambda photo: (photo.clock_ns, photo.name))
        shots = _shots(flight, group)
        clocks = _clocks(flight, shots, tracks, options)
        for fit in clocks.fits:
            _add_fit(found, flight, group, shots, fit, options)
        for index in clocks.left:
            found.refused[group[index].name] = clocks.reason
        if len(clocks.fits) > 1:
            found.warnings.append(
                f"{group[0].camera_name}: its photos lie on the tracks of {len(clocks.fits)} "
                "vehicles or flights: several cameras without serial numbers?"
            )
    found.photos.sort(key=lambda each: (each.at_ns, each.photo.name))
    _warn_about_clocks(found, options)
    return found


def _shots(flight: FlightData, photos: Sequence[Photo]) -> Shots:
    assert flight.frame is not None  # or it would not have been read
    enu_m = enu_from_geo(
        flight.frame,
        [photo.latitude_deg for photo in photos],
        [photo.longitude_deg for photo in photos],
        flight.frame.origin.ellipsoid_height_m,
    )
    clock_ns = np.array([photo.clock_ns for photo in photos], dtype=np.int64)
    return Shots(clock_ns, enu_m[:, 0], enu_m[:, 1], max(photo.clock_step_s for photo in photos))


def _clocks(
    flight: FlightData, shots: Shots, tracks: Mapping[str, RecordedTrack], options: TagOptions
) -> Clocks:
    if options.clock_offset_s is None:
        return clocks_of(shots, tracks, flight.utc_ahead_ns)
    return stated_clock(shots, tracks, flight.utc_ahead_ns, options.clock_offset_s)


def stated_clock(
    shots: Shots, tracks: Mapping[str, RecordedTrack], utc_ahead_ns: int, offset_s: float
) -> Clocks:
    """Return the fits of a stated offset: each photo to the vehicle that was nearest then."""
    step_ns = round((offset_s + shots.step_s / 2.0) * NS_PER_S)
    at_ns = shots.clock_ns - utc_ahead_ns + step_ns
    far_m = []
    for track in tracks.values():
        east, north = places_at(track, at_ns)
        far_m.append(np.nan_to_num(np.hypot(shots.east_m - east, shots.north_m - north), nan=1e9))
    distances = np.array(far_m)
    nearest = np.argmin(distances, axis=0)
    is_near = distances.min(axis=0) <= STATED_WITHIN_M
    fits = []
    for number, serial in enumerate(tracks):
        mine = np.flatnonzero((nearest == number) & is_near)
        if len(mine):
            far = float(np.median(distances[number, mine]))
            fits.append(ClockFit(serial, offset_s, shots.step_s / np.sqrt(12.0), mine, far))
    reason = f"with the stated clock offset no vehicle was within {STATED_WITHIN_M:g} m"
    return Clocks(tuple(fits), np.flatnonzero(~is_near), reason)


STATED_WITHIN_M = 30.0


def _add_fit(
    found: Timed,
    flight: FlightData,
    group: Sequence[Photo],
    shots: Shots,
    fit: ClockFit,
    options: TagOptions,
) -> None:
    track = flight.tracks[fit.serial]
    at_ns = times_of(shots, track, fit, flight.utc_ahead_ns)
    heights = np.interp(at_ns, track.at_ns, track.height_m)
    yaws = _headings(track, at_ns)
    for index, moment, height_m, yaw_deg in zip(
        fit.photos.tolist(), at_ns.tolist(), heights.tolist(), yaws.tolist(), strict=True
    ):
        photo = group[index]
        place = (float(shots.east_m[index]), float(shots.north_m[index]))
        timed = _timed(photo, fit, int(moment), place, (height_m, yaw_deg), options)
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
            options.clock_offset_s is not None,
        )
    )


def _headings(track: RecordedTrack, at_ns: IntArray) -> FloatArray:
    """Return headings (N,) in degrees at times; NaN where the app reported none."""
    turned = np.deg2rad(track.yaw_deg)
    sine, cosine = (np.interp(at_ns, track.at_ns, part(turned)) for part in (np.sin, np.cos))
    return np.rad2deg(np.arctan2(sine, cosine))


def _timed(
    photo: Photo,
    fit: ClockFit,
    at_ns: int,
    place_m: tuple[float, float],
    recorded: tuple[float, float],
    options: TagOptions,
) -> TimedPhoto | str:
    """Return a photo's time and pose, or why it has none."""
    height_m, yaw_deg = recorded
    if photo.height_above_takeoff_m is not None:
        height_m = photo.height_above_takeoff_m
    pitch_deg = -90.0
    if photo.attitude is not None:
        yaw_deg, pitch_deg = photo.attitude.yaw_deg, photo.attitude.pitch_deg
    across_deg = options.across_deg or photo.across_deg
    if across_deg is None:
        return "EXIF states no focal length: give the camera's field of view with --field"
    if not np.isfinite(height_m):
        return "neither the photo nor the record states its height above takeoff"
    if height_m < LOWEST_M:
        return f"taken {height_m:.1f} m above takeoff, below {LOWEST_M:g} m: a photo on the ground"
    if not np.isfinite(yaw_deg):
        return "neither the photo nor the record states its heading"
    if pitch_deg > LOWEST_PITCH_DEG:
        return f"the camera looked {pitch_deg:.0f} degrees up or down: not at the ground below"
    aim = Aim(*place_m, height_m, yaw_deg, pitch_deg)
    return TimedPhoto(photo, fit.serial, at_ns, fit.sigma_s, aim, across_deg)


def _warn_about_clocks(found: Timed, options: TagOptions) -> None:
    for clock in found.clocks:
        off_zone_s = abs(clock.offset_s - round(clock.offset_s / ZONE_STEP_S) * ZONE_STEP_S)
        if off_zone_s > ZONE_WITHIN_S and not clock.is_stated:
            found.warnings.append(
                f"{clock.camera}: an offset of {offset_text(clock.offset_s)} is no time zone: if "
                "the same survey was flown twice, check that these are the photos of this flight"
            )
    for photo in found.photos:
        seen_ns = photo.photo.satellite_ns
        if seen_ns is None or options.clock_offset_s is not None:
            continue
        clock = next(c for c in found.clocks if c.serial == photo.serial)
        by_clock_ns = photo.photo.clock_ns + round(clock.offset_s * NS_PER_S)
        if abs(seen_ns - by_clock_ns) > SATELLITES_WITHIN_S * NS_PER_S:
            found.warnings.append(
                f"{clock.camera}: the satellites' time in {photo.photo.name} is "
                f"{abs(seen_ns - by_clock_ns) / NS_PER_S:.0f} s off: these may be the photos of "
                "another flight over the same rows"
            )
            return


SATELLITES_WITHIN_S = 20.0
"""Satellite time and UTC differ by 18 leap seconds, and cameras write the one for the other."""


def tag_photo(timed: TimedPhoto, history: SunHistory) -> tuple[PhotoTag, ByteMap]:
    """Return a photo's tag, and its mask (rows, cols) at 1 / `MASK_SCALE`: white in sun.

    Ground that is not known stays white: a mask removes what is known to be in shade.
    """
    cols, rows = (max(1, round(n / MASK_SCALE)) for n in (timed.photo.cols, timed.photo.rows))
    sun = sun_on_photo(
        history.at(timed.at_ns), history.grid, timed.aim, timed.across_deg, cols, rows
    )
    is_known = sun.confidence > 0.0
    is_lit = sun.transmittance >= SUNLIT_TRANSMITTANCE
    known = float(is_known.mean())
    sunlit = float(is_lit[is_known].mean()) if is_known.any() else float("nan")
    mask = np.where(is_known & ~is_lit, np.uint8(BLACK), np.uint8(WHITE))
    name = timed.photo.name
    return PhotoTag(name, sunlit, float(sun.confidence.mean()), known), mask


def sun_history(flight: FlightData) -> SunHistory:
    """Return the sun of a flight by time; raises `RecordError` without shade maps."""
    if flight.grid is None or not flight.maps:
        raise RecordError(
            f"{flight.path}: expected a flight with shade maps, got none: no imaging drone, or no "
            "frame of it could be used"
        )
    return SunHistory(flight.grid, flight.maps)


def select(
    flight: FlightData,
    photos: Sequence[TimedPhoto],
    history: SunHistory,
    options: TagOptions,
    over: Callable[[Iterable[TimedPhoto]], Iterator[TimedPhoto]] = iter,
) -> Selection:
    """Return the photos to keep and the ground to fly again; `over` shows progress."""
    assert flight.frame is not None  # or it would not have been read
    area = region_of(flight.surveys)
    if area is None:
        area = region_of_views([each.view for each in photos])
    ground = ground_of(area, flight.frame)
    cells = len(ground.centres_m)
    shown = np.zeros(cells, dtype=np.int64)
    in_sun, unclear = list[IntArray](), list[IntArray]()
    for each in over(photos):
        on = cells_on(each.view, ground)
        shown[on] += 1
        is_lit, is_unknown = light_of_cells(on, ground, history.at(each.at_ns), history.grid)
        in_sun.append(on[is_lit])
        unclear.append(on[is_unknown])
    shows = incidence(in_sun, cells)
    sunlit = np.asarray(shows.sum(axis=0)).ravel().astype(np.int64)
    # Where too few photos are surely in sun, those in unknown light count too: some may be.
    is_poor = sunlit < ENOUGH_VIEWS
    shows = shows + incidence([each[is_poor[each]] for each in unclear], cells)
    views = views_for(options.overlap)
    choice = choose(shows, views)
    names = tuple(photos[number].photo.name for number in choice.photos.tolist())
    again = tuple(to_fly_again(ground, shown, sunlit))
    return Selection(ground, shown, sunlit, names, choice.bound, views, again)
