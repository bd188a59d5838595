"""A flight record read as a `FlightData`, as far as the file goes.

Only what is stated in the file for readers of any version is used: Foxglove's topics, the plain
values of events, and `recon/about.json`. The file is hostile: each value is checked as it is read.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from foxglove_schemas_protobuf.Grid_pb2 import Grid
from google.protobuf.message import DecodeError

from recon.geo import enu_from_geo
from recon.model.errors import RecordError
from recon.model.geo import GeoPoint, GroundGrid, LatLon, LocalFrame
from recon.model.light import LightReading
from recon.model.survey import SurveyCamera
from recon.model.units import NS_PER_S
from recon.product.flight import (
    FULL,
    MOST_CELLS,
    UNKNOWN,
    FlightData,
    FlownSurvey,
    KeptMap,
    RecordedTrack,
)
from recon.product.reported_shots import shots_of_reports
from recon.record.mcap.foxglove import SHADE_TOPIC
from recon.record.mcap.mcap_file import ABOUT_NAME, STEPS_TOPIC
from recon.record.mcap.mcap_read import McapReading, Opener, RecordAttachment, RecordMessage, opened

MOST_MAPS = 20_000
"""Five hours with one map a second."""
LATEST_NS = 2**62
"""A computer's clock in the year 2116; half of what an array of times takes."""
LONGEST_WITHHELD_NS = 3_600 * NS_PER_S
"""Longest delay of a packet behind damaged bytes: otherwise silent links close long before."""
FARTHEST_M = 1e7
"""Largest distance from the site's origin: a quarter of the way round the earth."""
MOST_PHOTOS = 200_000
"""Most reported photos: a day of several vehicles at two a second."""
MOST_READINGS = 2_000_000
"""Most values of light sensors: eight hours of as many as a logger may send."""
MOST_INDEX = 2**32
LONGEST_AGE_S = 3_600.0
MOST_STARTS = 1_000
"""Most starts of surveys."""
BEFORE_ALL_NS = 0
"""Start of surveys that are already running when a record begins."""


def read_flight(path: Path, open_record: Opener = opened) -> FlightData:
    """Return a record's flight, as far as the file goes.

    Raises `RecordError` for a file that is no flight record, without positions, or without the
    place of its site; and OSError.
    """
    reader = _Reader(path)
    with open_record(path) as file:
        reading = McapReading(file)
        for item in reading.items():
            reader.take(item)
    return reader.flight(reading.trouble)


class _Step(msgspec.Struct, frozen=True):
    """The event of a step, of which some kinds are read, and its audit."""

    event: dict[str, Any]
    audit: msgspec.Raw = msgspec.Raw(b"\x90")


class _AuditKind(msgspec.Struct, frozen=True):
    kind: str


TrackRow = tuple[int, float, float, float, float]
"""Time, latitude, longitude, height above takeoff, heading."""


@dataclass(slots=True)
class _Reader:
    """Collects the items of a file."""

    path: Path
    _frame: LocalFrame | None = None
    _imagers: frozenset[str] = frozenset()
    _names: dict[str, str] = field(default_factory=dict)
    _utc_ahead_ns: int = 0
    _scenario: str = ""
    _grid: GroundGrid | None = None
    _maps: list[KeptMap] = field(default_factory=list)
    _surveys: dict[int, FlownSurvey] = field(default_factory=dict)
    """All requested surveys by id."""
    _starts: int = 0
    _serials: dict[int, str] = field(default_factory=dict)
    _links: dict[int, list[TrackRow]] = field(default_factory=dict)
    _reported: dict[tuple[str, int], dict[int, tuple[int, float, float]]] = field(
        default_factory=dict
    )
    """Reported photos by serial and series, then index: time, east, north."""
    _photos: int = 0
    _light: list[LightReading] = field(default_factory=list)
    _decoder: msgspec.msgpack.Decoder[_Step] = field(
        default_factory=lambda: msgspec.msgpack.Decoder(_Step)
    )

    def take(self, item: RecordMessage | RecordAttachment) -> None:
        """Take the next item; raises `RecordError` for one that is damaged."""
        if isinstance(item, RecordAttachment):
            if item.name == ABOUT_NAME:
                self._about(item.data)
        elif item.topic == STEPS_TOPIC:
            self._step(item)
        elif item.topic == SHADE_TOPIC and self._frame is not None:
            self._map(item, self._frame)

    def flight(self, trouble: str) -> FlightData:
        """Return the flight; raises `RecordError` without the site's place, or positions."""
        frame = self._frame
        if frame is None:
            raise RecordError(
                f"{self.path}: expected a flight record with the place of its site, got none: "
                "it was recorded without --site, by an older version, or is no record of Recon"
            )
        by_serial: dict[str, list[TrackRow]] = {}
        for link, rows in self._links.items():
            if link in self._serials:
                by_serial.setdefault(self._serials[link], []).extend(rows)
        if not by_serial:
            raise RecordError(
                f"{self.path}: expected a record with positions of vehicles, got none"
            )
        return FlightData(
            self.path,
            frame,
            {serial: _track(serial, rows, frame) for serial, rows in sorted(by_serial.items())},
            self._names,
            self._imagers,
            self._grid,
            sorted(self._maps, key=lambda each: each.at_ns),
            [each for each in self._surveys.values() if each.starts],
            self._utc_ahead_ns,
            trouble,
            self._scenario,
            shots_of_reports(self._reported),
            self._light,
        )

    def _about(self, data: bytes) -> None:
        try:
            about = json.loads(data)
            origin = about.get("origin")
            if origin is not None:
                point = GeoPoint(*(float(origin[name]) for name in _ORIGIN))
                if not point.is_valid():
                    raise ValueError(f"no place on earth: {origin!a:.80}")
                self._frame = LocalFrame(point)
            self._imagers = frozenset(str(each) for each in about.get("imagers", ()))
            self._scenario = str(about.get("scenario", ""))
            self._names = {str(k): str(v) for k, v in about.get("vehicles", {}).items()}
            for each in about.get("surveys", ()):
                self._surveys[int(each["id"])] = _survey(each)
                if each["flown_by"]:
                    self._started(int(each["id"]), each["flown_by"], BEFORE_ALL_NS)
        except (*DAMAGES, AttributeError, RecursionError) as problem:
            raise RecordError(f"{self.path}: {ABOUT_NAME} is damaged: {problem}") from problem

    def _step(self, item: RecordMessage) -> None:
        try:
            if item.log_ns > LATEST_NS:
                raise ValueError(f"station time {item.log_ns} ns")
            self._event(self._decoder.decode(item.data), item.log_ns)
        except (msgspec.MsgspecError, *DAMAGES) as problem:
            raise RecordError(
                f"{self.path}: step {item.sequence} is damaged: {problem}"
            ) from problem

    def _event(self, step: _Step, at_ns: int) -> None:
        event = step.event
        match event.get("_"):
            case "PacketReceived":
                self._report(event, at_ns)
            case "ClockRead":
                wall_ns = _whole(event["wall_ns"])
                if not 0 <= wall_ns <= LATEST_NS:
                    raise ValueError(f"expected a clock after 1970, got {wall_ns} ns")
                self._utc_ahead_ns = wall_ns - at_ns
            case "LightRead":
                self._light += map(_reading, event["readings"])
                if len(self._light) > MOST_READINGS:
                    raise ValueError(f"expected at most {MOST_READINGS} values of light, got more")
            case "SurveyRequested":
                self._surveys[int(event["survey"]["id"])] = _survey(event["survey"])
            case "SurveyStarted":
                audit = msgspec.msgpack.decode(step.audit, type=list[_AuditKind])
                if all(entry.kind != "survey.refused" for entry in audit):
                    self._started(int(event["survey_id"]), event["serials"], at_ns)

    def _started(self, survey_id: int, serials: Iterable[Any], at_ns: int) -> None:
        self._starts += 1
        if self._starts > MOST_STARTS:
            raise ValueError(f"expected at most {MOST_STARTS} starts of surveys, got more")
        survey = self._surveys.get(survey_id)
        if survey is not None:
            start = at_ns, frozenset(str(each) for each in serials)
            self._surveys[survey_id] = replace(survey, starts=(*survey.starts, start))

    def _report(self, event: Mapping[str, Any], at_ns: int) -> None:
        report, link = event["report"], int(event["link_id"])
        if event.get("arrived_at_ns") is not None:
            # Bytes in front of a packet may have withheld it.
            withheld_ns = at_ns - _whole(event["arrived_at_ns"])
            if not 0 <= withheld_ns <= LONGEST_WITHHELD_NS:
                raise ValueError(
                    f"expected a packet that arrived within an hour before {at_ns} ns, got one "
                    f"that arrived at {at_ns - withheld_ns} ns"
                )
            at_ns -= withheld_ns
        kind = report.get("_")
        if kind == "ExtendedReport" and report["serial"]:
            self._serials[link] = str(report["serial"])
        elif kind == "PhotosReport":
            self._photos_reported(report, link, at_ns)
        elif kind == "CoreReport" and report["position"] is not None:
            place, attitude = report["position"], report["attitude"]
            numbers = (
                place["latitude_deg"],
                place["longitude_deg"],
                report["height_above_takeoff_m"],
                None if attitude is None else attitude["yaw_deg"],
            )
            latitude, longitude, height_m, yaw = (
                math.nan if number is None else float(number) for number in numbers
            )
            self._links.setdefault(link, []).append((at_ns, latitude, longitude, height_m, yaw))

    def _photos_reported(self, report: Mapping[str, Any], link: int, at_ns: int) -> None:
        serial = report["serial"] or self._serials.get(link)
        if serial is None or self._frame is None:
            return
        known = self._reported.setdefault((str(serial), _whole(report["series"])), {})
        for photo in report["photos"]:
            index, age_s = _whole(photo["index"]), float(photo["age_s"])
            self._photos += 1
            if not (0.0 <= age_s <= LONGEST_AGE_S and 0 <= index <= MOST_INDEX):
                raise ValueError(f"expected a photo's index and age, got {index} and {age_s}")
            if self._photos > MOST_PHOTOS:
                raise ValueError(f"expected at most {MOST_PHOTOS} reported photos, got more")
            known.setdefault(index, (at_ns - round(age_s * NS_PER_S), *self._place_m(photo)))

    def _place_m(self, photo: Mapping[str, Any]) -> tuple[float, float]:
        """Return where a photo was taken, east and north; NaN where that is not known."""
        latitude_deg, longitude_deg = (_number(photo[name]) for name in _ORIGIN[:2])
        assert self._frame is not None  # or it was not asked for
        if latitude_deg is None or longitude_deg is None:
            return math.nan, math.nan
        ground_m = self._frame.origin.ellipsoid_height_m
        enu_m = enu_from_geo(self._frame, latitude_deg, longitude_deg, ground_m)
        east_m, north_m, _up_m = enu_m[0].tolist()
        return east_m, north_m

    def _map(self, item: RecordMessage, frame: LocalFrame) -> None:
        try:
            found = Grid.FromString(item.data)
        except DecodeError as problem:
            raise RecordError(f"{self.path}: a shade map is damaged: {problem}") from problem
        grid, values = _grid_values(found, frame)
        if self._grid is None:
            self._grid = grid
        if grid != self._grid:
            raise RecordError(f"{self.path}: expected shade maps on one grid, got several")
        if len(self._maps) >= MOST_MAPS:
            raise RecordError(f"{self.path}: expected at most {MOST_MAPS} shade maps, got more")
        transmittance, confidence = values[..., 0], values[..., 1]
        is_known = np.isfinite(transmittance)
        sun = np.where(is_known, np.clip(np.nan_to_num(transmittance), 0.0, 1.0) * FULL, UNKNOWN)
        sure = np.where(is_known, np.clip(np.nan_to_num(confidence), 0.0, 1.0) * 255.0, 0.0)
        at_ns = found.timestamp.seconds * NS_PER_S + found.timestamp.nanos
        if abs(at_ns) > LATEST_NS:
            raise RecordError(f"{self.path}: a shade map is damaged: station time {at_ns} ns")
        self._maps.append(
            KeptMap(at_ns, np.rint(sun).astype(np.uint8), np.rint(sure).astype(np.uint8))
        )


DAMAGES = (ValueError, TypeError, KeyError, OverflowError)
"""What the values of a damaged record raise."""

_ORIGIN = ("latitude_deg", "longitude_deg", "ellipsoid_height_m")


def _grid_values(grid: Grid, frame: LocalFrame) -> tuple[GroundGrid, npt.NDArray[np.float32]]:
    """Return the place and the values (R, C, layers) of a grid of floats, row 0 north."""
    cell_m, cols, stride = grid.cell_size.x, grid.column_count, grid.cell_stride
    layers = len(grid.fields)
    if not (0.0 < cell_m < 1e4 and cols > 0 and 2 <= layers <= 16 and stride == 4 * layers):
        raise RecordError("a shade map is damaged: expected cells of floats in metres")
    rows, rest = divmod(len(grid.data), cols * stride)
    if rest or not 0 < rows * cols <= MOST_CELLS:
        raise RecordError(f"a shade map is damaged: {len(grid.data)} bytes in {cols} columns")
    values = np.frombuffer(grid.data, "<f4").reshape(rows, cols, layers)[::-1]
    west_m, south_m = grid.pose.position.x, grid.pose.position.y
    if not (math.isfinite(west_m) and math.isfinite(south_m)):
        raise RecordError("a shade map is damaged: its place is no number")
    return GroundGrid(frame, west_m, south_m + rows * cell_m, cell_m, rows, cols), values


def _track(serial: str, rows: Sequence[TrackRow], frame: LocalFrame) -> RecordedTrack:
    """Return the track of a vehicle's reports, each time once."""
    at_ns = np.array([row[0] for row in rows], dtype=np.int64)
    values = np.array([row[1:] for row in rows], dtype=np.float64)
    at_ns, first = np.unique(at_ns, return_index=True)
    values = values[first]
    ground_m = np.full(len(values), frame.origin.ellipsoid_height_m)
    enu_m = enu_from_geo(frame, values[:, 0], values[:, 1], ground_m)
    return RecordedTrack(serial, at_ns, enu_m[:, 0], enu_m[:, 1], values[:, 2], values[:, 3])


def _whole(value: Any) -> int:
    if type(value) is not int:
        raise ValueError(f"expected a whole number, got {value!a:.40}")
    return value


def _reading(value: Mapping[str, Any]) -> LightReading:
    place, at_ns = value["place"], _whole(value["at_ns"])
    if place is not None:
        place = LatLon(float(place["latitude_deg"]), float(place["longitude_deg"]))
    if not 0 <= at_ns < 2 * LATEST_NS or (place is not None and not place.is_valid()):
        raise ValueError(f"expected a value of light on earth after 1970, got {value!a:.80}")
    return LightReading(str(value["sensor"]), at_ns, float(value["value"]), place)


def _survey(value: Mapping[str, Any]) -> FlownSurvey:
    region = value["region"]
    return FlownSurvey(
        _ring(region["outline_m"]),
        tuple(_ring(hole) for hole in region["holes_m"]),
        _number(value["height_above_takeoff_m"]),
        float(value["speed_mps"]),
        str(value.get("name", "")),
        _camera(value.get("camera")),
        float(value.get("side_overlap", 0.6)),
        _number(value.get("row_bearing_deg")),
        height_above_ground_m=_number(value.get("height_above_ground_m")),
    )


def _number(value: Any) -> float | None:
    return None if value is None else float(value)


def _camera(value: Mapping[str, Any] | None) -> SurveyCamera:
    if value is None:
        return SurveyCamera()
    across_deg, along_deg, interval_s = (
        float(value[name]) for name in ("across_deg", "along_deg", "interval_s")
    )
    if not (1.0 <= across_deg <= 170.0 and 1.0 <= along_deg <= 170.0 and interval_s >= 0.1):
        raise ValueError(f"expected a survey camera, got {value!a:.100}")
    return SurveyCamera(across_deg, along_deg, interval_s)


def _ring(value: Mapping[str, Any] | list[Any]) -> tuple[tuple[float, float], ...]:
    flat = value if isinstance(value, list) else np.frombuffer(value["data"], "<f8")
    points = np.asarray(flat, dtype=np.float64).reshape(-1, 2)
    if not 3 <= len(points) <= 100_000 or not (np.abs(points) <= FARTHEST_M).all():
        raise ValueError("expected a ring of at least three corners near the site")
    return tuple((east, north) for east, north in points.tolist())
