"""A recorded flight as the product needs it: tracks, shade maps, surveys, where and when.

Only what is stated in the file for readers of any version is used: Foxglove's topics, the plain
values of events, and `recon/about.json`. The file is hostile: each value is checked as it is read.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
from foxglove_schemas_protobuf.Grid_pb2 import Grid
from google.protobuf.message import DecodeError

from recon.geo import enu_from_geo
from recon.model.errors import RecordError
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.units import NS_PER_S
from recon.record.mcap_read import McapReading, RecordAttachment, RecordMessage
from recon.record.tracks import utc_text

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
ByteMap = npt.NDArray[np.uint8]

ABOUT, STEPS, SHADE = "recon/about.json", "/recon/steps", "/shade"
"""Names in the record, as `recon.station.kernel` writes them."""

UNKNOWN = 255
"""In a `KeptMap`, where nothing is known; 0 to 250 are transmittances of 0 to 1."""
FULL = 250

MOST_CELLS = 16_000_000
MOST_MAPS = 20_000
"""Five hours with one map a second."""


@dataclass(frozen=True, slots=True, eq=False)
class RecordedTrack:
    """Where one vehicle was, by its telemetry; all arrays are (N,), times rise strictly.

    Heights are above takeoff, headings of the aircraft's front clockwise from north; NaN where
    its app reported none.
    """

    serial: str
    at_ns: IntArray
    east_m: FloatArray
    north_m: FloatArray
    height_m: FloatArray
    yaw_deg: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class KeptMap:
    """A shade map in a quarter of the memory; arrays are (R, C), row 0 is north."""

    at_ns: int
    """Of the capture."""
    sun: ByteMap
    """Transmittance in 250ths; `UNKNOWN` where nothing is known."""
    confidence: ByteMap
    """In 255ths."""


@dataclass(frozen=True, slots=True)
class FlownSurvey:
    """A survey as it was requested."""

    name: str
    outline_m: tuple[tuple[float, float], ...]
    holes_m: tuple[tuple[tuple[float, float], ...], ...]
    height_above_takeoff_m: float
    speed_mps: float
    across_deg: float
    along_deg: float
    interval_s: float
    front_overlap: float
    side_overlap: float


@dataclass(frozen=True, slots=True)
class Note:
    """One entry of the audit."""

    at_ns: int
    kind: str
    text: str
    by: str
    vehicle: str
    details: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Charge:
    """A battery at a time, 0 to 1."""

    at_ns: int
    fraction: float


@dataclass(slots=True)
class FlightData:
    """One recorded flight. Times are station time; `utc_ahead_ns` added to it gives UTC."""

    path: Path
    about: Mapping[str, Any] = field(default_factory=dict)
    frame: LocalFrame | None = None
    imagers: frozenset[str] = frozenset()
    names: Mapping[str, str] = field(default_factory=dict)
    tracks: dict[str, RecordedTrack] = field(default_factory=dict)
    grid: GroundGrid | None = None
    maps: list[KeptMap] = field(default_factory=list)
    surveys: list[FlownSurvey] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)
    batteries: dict[str, list[Charge]] = field(default_factory=dict)
    utc_ahead_ns: int = 0
    begins_ns: int = 0
    ends_ns: int = 0
    trouble: str = ""
    """Why reading ended early; empty if it did not."""

    def utc(self, at_ns: int) -> str:
        """Return a station time as ISO 8601 in UTC."""
        return utc_text(at_ns + self.utc_ahead_ns)

    @property
    def survey_tracks(self) -> dict[str, RecordedTrack]:
        """The tracks of all vehicles but the imaging drones."""
        return {s: track for s, track in self.tracks.items() if s not in self.imagers}


def read_flight(path: Path, *, with_maps: bool = True) -> FlightData:
    """Return a record's flight, as far as the file goes.

    Raises `RecordError` for a file that is no flight record, without positions, or without the
    place of its site; and OSError.
    """
    reader = _Reader(FlightData(path), with_maps)
    with path.open("rb") as file:
        reading = McapReading(file)
        for item in reading.items():
            reader.take(item)
    flight = reader.finished()
    flight.trouble = reading.trouble
    if not flight.tracks:
        raise RecordError(f"{path}: expected a record with positions of vehicles, got none")
    return flight


class _Event(msgspec.Struct, frozen=True):
    """The event of a step, of which three kinds are read."""

    event: dict[str, Any]
    audit: list[dict[str, Any]] = []


@dataclass(slots=True)
class _Reader:
    """Collects the items of a file."""

    flight: FlightData
    with_maps: bool
    _serials: dict[int, str] = field(default_factory=dict)
    _links: dict[int, list[tuple[int, float, float, float, float]]] = field(default_factory=dict)
    _decoder: msgspec.msgpack.Decoder[_Event] = field(
        default_factory=lambda: msgspec.msgpack.Decoder(_Event)
    )

    def take(self, item: RecordMessage | RecordAttachment) -> None:
        """Take the next item; raises `RecordError` for one that is damaged."""
        if isinstance(item, RecordAttachment):
            if item.name == ABOUT:
                self._about(item.data)
            return
        flight = self.flight
        flight.begins_ns = flight.begins_ns or item.log_ns
        flight.ends_ns = max(flight.ends_ns, item.log_ns)
        if item.topic == STEPS:
            self._step(item)
        elif item.topic == SHADE and self.with_maps and flight.frame is not None:
            self._map(item, flight.frame)

    def finished(self) -> FlightData:
        """Return the flight; raises `RecordError` without the site's place."""
        flight = self.flight
        if flight.frame is None:
            raise RecordError(
                f"{flight.path}: expected a flight record with the place of its site, got none: "
                "it was recorded without --site, by an older version, or is no record of Recon"
            )
        by_serial: dict[str, list[tuple[int, float, float, float, float]]] = {}
        for link, rows in self._links.items():
            if link in self._serials:
                by_serial.setdefault(self._serials[link], []).extend(rows)
        for serial, rows in sorted(by_serial.items()):
            flight.tracks[serial] = _track(serial, rows, flight.frame)
        flight.maps.sort(key=lambda each: each.at_ns)
        return flight

    def _about(self, data: bytes) -> None:
        flight = self.flight
        try:
            about = json.loads(data)
            origin = about.get("origin")
            if origin is not None:
                point = GeoPoint(*(float(origin[name]) for name in _ORIGIN))
                if not point.is_valid():
                    raise ValueError(f"no place on earth: {origin!a:.80}")
                flight.frame = LocalFrame(point)
            flight.imagers = frozenset(str(each) for each in about.get("imagers", ()))
            flight.names = {str(k): str(v) for k, v in about.get("vehicles", {}).items()}
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as problem:
            raise RecordError(f"{flight.path}: {ABOUT} is damaged: {problem}") from problem
        flight.about = about

    def _step(self, item: RecordMessage) -> None:
        try:
            step = self._decoder.decode(item.data)
            self._event(step.event, item.log_ns)
            for each in step.audit:
                self._note(each, item.log_ns)
        except (msgspec.MsgspecError, ValueError, TypeError, KeyError) as problem:
            raise RecordError(
                f"{self.flight.path}: step {item.sequence} is damaged: {problem}"
            ) from problem

    def _event(self, event: Mapping[str, Any], at_ns: int) -> None:
        match event.get("_"):
            case "PacketReceived":
                self._report(event, at_ns)
            case "ClockRead":
                self.flight.utc_ahead_ns = int(event["wall_ns"]) - at_ns
            case "SurveyRequested":
                self.flight.surveys.append(_survey(event["survey"]))

    def _report(self, event: Mapping[str, Any], at_ns: int) -> None:
        report, link = event["report"], int(event["link_id"])
        # Bytes in front of a packet may have withheld it.
        at_ns = at_ns if event.get("arrived_at_ns") is None else int(event["arrived_at_ns"])
        kind = report.get("_")
        if kind == "ExtendedReport" and report["serial"]:
            serial = self._serials[link] = str(report["serial"])
            if report["battery_fraction"] is not None:
                charges = self.flight.batteries.setdefault(serial, [])
                charge = float(report["battery_fraction"])
                if not charges or charges[-1].fraction != charge:
                    charges.append(Charge(at_ns, charge))
        elif kind == "CoreReport" and report["position"] is not None:
            place, attitude = report["position"], report["attitude"]
            numbers = (
                place["latitude_deg"],
                place["longitude_deg"],
                report["height_above_takeoff_m"],
                None if attitude is None else attitude["yaw_deg"],
            )
            row = tuple(math.nan if n is None else float(n) for n in numbers)
            self._links.setdefault(link, []).append((at_ns, *row))  # type: ignore[arg-type]

    def _note(self, entry: Mapping[str, Any], at_ns: int) -> None:
        kind, text, by, vehicle = (str(entry[name]) for name in ("kind", "text", "by", "vehicle"))
        self.flight.notes.append(Note(at_ns, kind, text, by, vehicle, dict(entry["details"])))

    def _map(self, item: RecordMessage, frame: LocalFrame) -> None:
        flight = self.flight
        try:
            found = Grid.FromString(item.data)
        except DecodeError as problem:
            raise RecordError(f"{flight.path}: a shade map is damaged: {problem}") from problem
        grid, values = _grid_values(found, frame)
        if flight.grid is None:
            flight.grid = grid
        if grid != flight.grid:
            raise RecordError(f"{flight.path}: expected shade maps on one grid, got several")
        if len(flight.maps) >= MOST_MAPS:
            raise RecordError(f"{flight.path}: expected at most {MOST_MAPS} shade maps, got more")
        transmittance, confidence = values[..., 0], values[..., 1]
        is_known = np.isfinite(transmittance)
        sun = np.where(is_known, np.clip(np.nan_to_num(transmittance), 0.0, 1.0) * FULL, UNKNOWN)
        sure = np.where(is_known, np.clip(np.nan_to_num(confidence), 0.0, 1.0) * 255.0, 0.0)
        at_ns = found.timestamp.seconds * NS_PER_S + found.timestamp.nanos
        flight.maps.append(
            KeptMap(at_ns, np.rint(sun).astype(np.uint8), np.rint(sure).astype(np.uint8))
        )


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


def _track(
    serial: str, rows: list[tuple[int, float, float, float, float]], frame: LocalFrame
) -> RecordedTrack:
    """Return the track of a vehicle's reports, each time once."""
    at_ns = np.array([row[0] for row in rows], dtype=np.int64)
    values = np.array([row[1:] for row in rows], dtype=np.float64)
    at_ns, first = np.unique(at_ns, return_index=True)
    values = values[first]
    ground_m = np.full(len(values), frame.origin.ellipsoid_height_m)
    enu_m = enu_from_geo(frame, values[:, 0], values[:, 1], ground_m)
    return RecordedTrack(serial, at_ns, enu_m[:, 0], enu_m[:, 1], values[:, 2], values[:, 3])


def _survey(value: Mapping[str, Any]) -> FlownSurvey:
    region, camera = value["region"], value["camera"]
    return FlownSurvey(
        str(value["name"]),
        _ring(region["outline_m"]),
        tuple(_ring(hole) for hole in region["holes_m"]),
        float(value["height_above_takeoff_m"]),
        float(value["speed_mps"]),
        float(camera["across_deg"]),
        float(camera["along_deg"]),
        float(camera["interval_s"]),
        float(value["front_overlap"]),
        float(value["side_overlap"]),
    )


def _ring(value: Mapping[str, Any]) -> tuple[tuple[float, float], ...]:
    points = np.frombuffer(value["data"], "<f8").reshape(-1, 2)
    if not 3 <= len(points) <= 100_000 or not np.isfinite(points).all():
        raise ValueError("expected a ring of at least three corners")
    return tuple((east, north) for east, north in points.tolist())
