"""A flight made by construction: rows flown at a steady speed, bands of shade that move, photos."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from PIL import ExifTags, Image
from PIL.TiffImagePlugin import IFDRational

from recon.geo import geo_from_enu
from recon.model.airspace import Region
from recon.model.event import ClockRead, Event, PacketReceived, SurveyRequested, SurveyStarted
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.report import CoreReport, ExtendedReport
from recon.model.shade import ShadeMap, SunForecast
from recon.model.survey import Survey
from recon.model.units import NS_PER_S
from recon.model.vehicle import Attitude
from recon.product.flight import FULL, FlightData, FlownSurvey, KeptMap, RecordedTrack
from recon.record.mcap import foxglove
from recon.record.mcap.flight_messages import MSGPACK
from recon.record.mcap.mcap_file import ABOUT_NAME, KEYFRAMES_TOPIC, STEPS_TOPIC, McapFile
from recon.record.mcap.record_writer import Topics
from recon.record.mcap.tracks import utc_text
from recon.station.recording.recorded_values import values_codec

FloatArray = npt.NDArray[np.float64]

FRAME = LocalFrame(GeoPoint(41.9, -93.6, 290.0))
GRID = GroundGrid(FRAME, -150.0, 150.0, 2.0, 150, 150)
SPEED_MPS = 8.0
HEIGHT_M = 60.0
SIDE_M = 200.0
ROW_M = 25.0
ROWS = 9
START_NS = 1_000 * NS_PER_S
UTC_AHEAD_NS = 1_750_000_000 * NS_PER_S
ACROSS_DEG = 66.0
COLS, ROWS_PX = 640, 480
FORECAST_LEADS_S = (0.0, 16.0, 60.0, 120.0)
DRIFT_MPS = 9.0
"""Of the shade, to the east."""


@dataclass(frozen=True)
class Rows:
    """One vehicle's way: rows to the north and back, one after the other to the east."""

    serial: str = "SIM-1"
    starts_s: float = 10.0
    west_m: float = -100.0

    @property
    def lasts_s(self) -> float:
        return ROWS * (SIDE_M + ROW_M) / SPEED_MPS

    def place(self, at_s: npt.ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """East, north and heading at times since the flight's start."""
        path_m = np.clip((np.asarray(at_s, float) - self.starts_s) * SPEED_MPS, 0.0, None)
        row, along_m = np.divmod(path_m, SIDE_M + ROW_M)
        on_row = np.minimum(along_m, SIDE_M)
        east = self.west_m + ROW_M * row + np.clip(along_m - SIDE_M, 0.0, ROW_M)
        is_north = row % 2 == 0
        north = np.where(is_north, on_row - SIDE_M / 2.0, SIDE_M / 2.0 - on_row)
        yaw = np.where(along_m > SIDE_M, 90.0, np.where(is_north, 0.0, 180.0))
        return east, north, yaw


ONE = Rows()
OTHER = Rows("SIM-2", 25.0, -87.0)


def sun(east_m: npt.ArrayLike, north_m: npt.ArrayLike, at_s: float) -> FloatArray:
    """The true transmittance: slanted bands of shade that move to the east."""
    along = np.asarray(east_m) + 0.4 * np.asarray(north_m) - DRIFT_MPS * at_s
    wide = np.asarray(north_m) * 0.2 + 90.0
    return np.where(np.mod(along + 30.0 * np.sin(along / 97.0), 240.0) < wide, 0.2, 1.0)


def times_s(way: Rows, every_s: float = 2.0, phase_s: float = 0.7) -> FloatArray:
    return np.arange(way.starts_s + phase_s, way.starts_s + way.lasts_s - 1.0, every_s)


def track(way: Rows) -> RecordedTrack:
    at_s = np.arange(0.0, way.starts_s + way.lasts_s, 0.1)
    east, north, yaw = way.place(at_s)
    at_ns = START_NS + np.rint(at_s * NS_PER_S).astype(np.int64)
    return RecordedTrack(way.serial, at_ns, east, north, np.full_like(east, HEIGHT_M), yaw)


def true_map(at_s: float) -> KeptMap:
    middle_e = GRID.west_m + GRID.cell_m * (np.arange(GRID.cols) + 0.5)
    middle_n = GRID.north_m - GRID.cell_m * (np.arange(GRID.rows) + 0.5)
    value = sun(middle_e[np.newaxis, :], middle_n[:, np.newaxis], at_s)
    kept = np.rint(value * FULL).astype(np.uint8)
    return KeptMap(START_NS + round(at_s * NS_PER_S), kept, np.full_like(kept, 230))


def flight(*ways: Rows, maps_every_s: float = 4.0, path: Path = Path("made.mcap")) -> FlightData:
    ways = ways or (ONE,)
    tracks = {way.serial: track(way) for way in ways}
    ends_s = max(way.starts_s + way.lasts_s for way in ways)
    maps = [true_map(float(at_s)) for at_s in np.arange(0.5, ends_s, maps_every_s)]
    outline = ((-90.0, -90.0), (90.0, -90.0), (90.0, 90.0), (-90.0, 90.0))
    starts = ((START_NS, frozenset(tracks)),)
    survey = FlownSurvey(
        outline, (), HEIGHT_M, SPEED_MPS, "field", row_bearing_deg=0.0, starts=starts
    )
    return FlightData(
        path,
        FRAME,
        tracks,
        names={way.serial: f"Drone {way.serial[-1]}" for way in ways},
        grid=GRID,
        maps=maps,
        surveys=[survey],
        utc_ahead_ns=UTC_AHEAD_NS,
    )


Entry = Mapping[str, Any]
Probability = Callable[[float, float], FloatArray]
"""Seconds since the flight's start, and lead in seconds -> (R, C)."""


def write_record(
    made: FlightData,
    path: Path,
    *,
    site: str = "made field",
    entries: Sequence[tuple[float, Entry]] = (),
    forecast: Probability | None = None,
    refused_start_of: int | None = None,
    events: Sequence[tuple[int, Mapping[str, Any]]] = (),
    keyframes: Sequence[tuple[float, Mapping[str, Any]]] = (),
    has_clock: bool = True,
) -> Path:
    """Write a made flight as the station records one, by the station's own codec.

    `entries` are of the audit, each with its time since the flight's start; `events` are written
    as they are, each with its station time; so are keyframes, by seconds since the flight's start.
    """
    file = McapFile(path, "test")
    about = {
        "origin": {
            "latitude_deg": FRAME.origin.latitude_deg,
            "longitude_deg": FRAME.origin.longitude_deg,
            "ellipsoid_height_m": FRAME.origin.ellipsoid_height_m,
        },
        "imagers": ["SIM-IMAGER"],
        "vehicles": dict(made.names),
        "site": site,
        "version": "0.0.1",
        "settings": {"detection": {"method": "made", "lead_s": [1.0, 2.5]}, "is_on": True},
    }
    file.add_attachment(ABOUT_NAME, "application/json", msgspec.json.encode(about), START_NS)
    topics, codec = Topics(file), values_codec()

    def step(event: Event, at_ns: int, *audit: Entry) -> None:
        value = {"event": codec.to_builtins(event, Event), "outputs": [], "audit": audit}
        topics.add(STEPS_TOPIC, MSGPACK, msgspec.msgpack.encode(value), at_ns)

    if has_clock:
        step(ClockRead(UTC_AHEAD_NS + START_NS), START_NS)
    for number, each in enumerate(made.surveys, start=1):
        survey = Survey(
            number,
            each.name,
            Region(np.array(each.outline_m)),
            each.height_above_takeoff_m,
            each.speed_mps,
            each.camera,
            row_bearing_deg=each.row_bearing_deg,
            height_above_ground_m=each.height_above_ground_m,
        )
        step(SurveyRequested(survey, "test"), START_NS)
        for at_ns, serials in each.starts:
            step(SurveyStarted(number, tuple(serials), "test"), at_ns)
    if refused_start_of is not None:
        refused = {"kind": "survey.refused", "text": "refused"}
        step(SurveyStarted(refused_start_of, ("SIM-1",), "test"), START_NS, refused)
    for at_s, entry in entries:
        at_ns = START_NS + round(at_s * NS_PER_S)
        step(ClockRead(UTC_AHEAD_NS + at_ns), at_ns, entry)
    for at_s, keyframe in keyframes:
        data = msgspec.msgpack.encode(keyframe)
        topics.add(KEYFRAMES_TOPIC, MSGPACK, data, START_NS + round(at_s * NS_PER_S))
    for at_ns, event in events:
        topics.add(STEPS_TOPIC, MSGPACK, msgspec.msgpack.encode({"event": event}), at_ns)
    for link, each in enumerate(made.tracks.values(), start=1):
        extended = ExtendedReport(each.serial, 14, 5, False, False, 0.8, None, None, None, None, 0)
        step(PacketReceived(link, extended), START_NS)
        level = np.column_stack([each.east_m, each.north_m, np.zeros_like(each.east_m)])
        latitudes, longitudes, _height = geo_from_enu(FRAME, level)
        for at_ns, latitude, longitude, yaw in zip(
            each.at_ns.tolist(), latitudes.tolist(), longitudes.tolist(), each.yaw_deg.tolist(),
            strict=True,
        ):  # fmt: skip
            place, attitude = LatLon(latitude, longitude), Attitude(yaw, 0.0, 0.0)
            core = CoreReport(True, place, 350.0, HEIGHT_M, None, attitude)
            step(PacketReceived(link, core, at_ns), at_ns + 5_000_000)
            if at_ns % (10 * NS_PER_S) == 0:
                file.flush()
    for kept in made.maps:
        value = (kept.sun / FULL).astype(np.float32)
        sure = np.full_like(value, 0.9)
        shade = ShadeMap(GRID, kept.at_ns, (), value, np.ones(value.shape, bool), sure, sure)
        grid = foxglove.shade_grid(shade)
        topics.add(
            foxglove.SHADE_TOPIC,
            foxglove.ENCODING,
            grid.SerializeToString(),
            kept.at_ns + NS_PER_S,
            schema=lambda: foxglove.schema_of(foxglove.Grid()),
        )
        if forecast is not None:
            at_s = (kept.at_ns - START_NS) / NS_PER_S
            chances = np.stack([forecast(at_s, lead_s) for lead_s in FORECAST_LEADS_S])
            issued = SunForecast(
                GRID,
                kept.at_ns,
                np.array(FORECAST_LEADS_S),
                np.rint(255.0 * chances).astype(np.uint8),
                np.zeros((GRID.rows, GRID.cols), np.float32),
                0.5,
                "made",
            )
            topics.add(
                "/forecast",
                foxglove.ENCODING,
                foxglove.forecast_grid(issued).SerializeToString(),
                kept.at_ns + NS_PER_S,
                schema=lambda: foxglove.schema_of(foxglove.Grid()),
            )
    file.finish()
    return path


def write_photo(
    path: Path,
    *,
    place_m: tuple[float, float],
    clock_ns: int | None,
    camera: str = "CAM-1",
    subsec: str | None = None,
    xmp: bytes | None = None,
    with_lens: bool = True,
    orientation: int = 1,
    satellites_ns: int | None = None,
    size: tuple[int, int] = (COLS, ROWS_PX),
    sides: tuple[str, str] | None = ("N", "W"),
    altitude_m: float | None = None,
) -> Path:
    """Write a small JPEG with the EXIF of a drone's camera."""
    exif = Image.Exif()
    exif[ExifTags.Base.Make], exif[ExifTags.Base.Model] = "Made", "Camera"
    exif[ExifTags.Base.Orientation] = orientation
    details = exif.get_ifd(ExifTags.IFD.Exif)
    details[ExifTags.Base.BodySerialNumber] = camera
    if clock_ns is not None:
        shown = utc_text(clock_ns)
        details[ExifTags.Base.DateTimeOriginal] = f"{shown[:10]} {shown[11:19]}".replace("-", ":")
    if subsec is not None:
        details[ExifTags.Base.SubsecTimeOriginal] = subsec
    if with_lens:
        wide_mm = 2.0 * 8.8 * np.tan(np.deg2rad(ACROSS_DEG / 2.0))
        details[ExifTags.Base.FocalLength] = _rational(8.8)
        details[ExifTags.Base.FocalPlaneXResolution] = _rational(size[0] / wide_mm)
        details[ExifTags.Base.FocalPlaneResolutionUnit] = 4
    gps = exif.get_ifd(ExifTags.IFD.GPSInfo)
    latitude, longitude, _height = geo_from_enu(FRAME, (*place_m, 0.0))
    if sides is not None:
        gps[ExifTags.GPS.GPSLatitudeRef], gps[ExifTags.GPS.GPSLongitudeRef] = sides
    if altitude_m is not None:
        gps[ExifTags.GPS.GPSAltitude] = _rational(altitude_m)
    gps[ExifTags.GPS.GPSLatitude] = _dms(float(latitude[0]))
    gps[ExifTags.GPS.GPSLongitude] = _dms(-float(longitude[0]))
    if satellites_ns is not None:
        shown = utc_text(satellites_ns)
        gps[ExifTags.GPS.GPSDateStamp] = shown[:10].replace("-", ":")
        parts = (int(shown[11:13]), int(shown[14:16]), int(shown[17:19]))
        gps[ExifTags.GPS.GPSTimeStamp] = tuple(_rational(part) for part in parts)
    more = {} if xmp is None else {"xmp": xmp}
    Image.new("RGB", size, (90, 120, 60)).save(path, quality=60, exif=exif, **more)
    return path


def _rational(value: float) -> IFDRational:
    return IFDRational(round(value * 1e6), 1_000_000)


def _dms(degrees: float) -> tuple[IFDRational, ...]:
    whole, minutes = divmod(degrees * 60.0, 60.0)
    return tuple(_rational(p) for p in (int(whole), int(minutes), (minutes - int(minutes)) * 60.0))


def write_card(
    folder: Path,
    ahead_s: float = 0.0,
    ways: Sequence[Rows] = (ONE,),
    every: int = 1,
    camera: Callable[[Rows], str] = lambda way: f"CAM-{way.serial}",
) -> dict[str, tuple[Rows, float]]:
    """Write the photos of ways; return each name's way and true time since the start."""
    folder.mkdir(parents=True, exist_ok=True)
    truth = {}
    for way in ways:
        for number, at_s in enumerate(times_s(way)[::every].tolist()):
            east, north, _yaw = way.place(at_s)
            name = f"{way.serial}_{number:04d}.JPG"
            clock_ns = UTC_AHEAD_NS + START_NS + round((at_s + ahead_s) * NS_PER_S)
            write_photo(
                folder / name,
                place_m=(float(east), float(north)),
                clock_ns=clock_ns,
                camera=camera(way),
            )
            truth[name] = (way, at_s)
    return truth
