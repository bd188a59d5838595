"""Keyframes of a record: the station's state every two seconds, from which a seek starts.

A keyframe is a `Station` without what a screen does not need (the memories of registration,
detection and forecast) and without what is in the record already: pixels, shade maps and
forecasts. `restored` puts the last two back from their topics; pixels are read when asked for.
So a keyframe takes some tens of kB, and a state that a replay shows is the recorded one.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import cache
from math import inf
from typing import Any, get_type_hints

import msgspec
import numpy as np
import numpy.typing as npt

from recon.camera.registration import RegistrationState
from recon.detection import DetectionState
from recon.forecast import ForecastState
from recon.model.errors import RecordError
from recon.model.event import Tick
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.shade import ShadeMap, SunForecast
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.record.mcap.codec import Codec
from recon.station.state.imaging import NONE, ImagerFrames, ShadePipeline
from recon.station.state.station import Station
from recon.station.state.steps import StepTaken
from recon.station.state.survey_record import NumberedBuffer, SurveyRecord

KEYFRAME_S = 2.0
"""Longest time of events that a seek steps through; each takes 1 to 2 ms of the station."""

SAMPLES_KEPT = 30
"""Telemetry samples kept of an imaging drone, for the frames of the next seconds."""
NO_PIXELS = np.zeros((0, 0, 3), np.uint8)
_SELDOM = ("settings", "airspace")
"""Fields changed by a drawing, if ever: excluded while they are as at the file's beginning."""
_LARGE = ("fleet", "orders")
"""Fields that are nearly all of a keyframe when there are many vehicles."""
_ALWAYS = tuple(each.name for each in fields(Station) if each.name not in _SELDOM)
MOST_CELLS = 4_000_000


@dataclass(frozen=True, slots=True, eq=False)
class MapFacts:
    """What the topics of the newest shade map and forecast do not hold."""

    at_ns: int
    """Time of recording of both."""
    source_serials: tuple[str, ...]
    lead_s: tuple[float, ...] = ()
    """The forecast's lead times; none without a forecast."""
    prior_sunlit: float = 0.0
    method: str = ""
    velocity_mps: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class MapMessages:
    """The newest shade map and forecast, as their topics have them (`foxglove.Grid`)."""

    shade: bytes
    sun: bytes | None


@dataclass(frozen=True, slots=True, eq=False)
class DueKeyframe:
    """The state after a step, of which a keyframe is to be made at once."""

    number: int
    """The step's number in its file."""
    now_ns: int
    station: Station
    maps_at_ns: int | None = None
    """Time of recording of the newest shade map; None if it is not in this file."""
    changed: frozenset[str] = frozenset()
    """Names among settings and airspace that differ from the file's beginning."""


@dataclass(frozen=True, slots=True)
class RecordDetail:
    """How closely a run is recorded."""

    keyframe_s: float = KEYFRAME_S
    has_all_maps: bool = True
    """Whether each shade map and forecast is recorded, or those of keyframes alone."""
    flight_file_s: float = inf
    """Time in flight after which a new file begins, as soon as no survey runs; after twice the
    time in any case."""
    is_demo: bool = False
    """Whether the record states that it is a demonstration's."""


EVERYTHING = RecordDetail()


@dataclass(frozen=True, slots=True, eq=False)
class DueMaps:
    """A shade map and its forecast, to be recorded after a step."""

    now_ns: int
    shade: ShadeMap
    sun: SunForecast | None


class Keyframes:
    """Decides when keyframes and maps of a file are due and what keyframes omit."""

    def __init__(self, detail: RecordDetail = EVERYTHING) -> None:
        self._detail = detail
        self._first = Station()
        self._maps_at_ns: int | None = None
        self._maps_number = 0
        self._due_ns = 0

    def begin(self, station: Station, now_ns: int) -> None:
        """Begin with a file's first state; the first keyframe is due."""
        self._first = Station(settings=station.settings, airspace=station.airspace)
        self._maps_at_ns, self._due_ns = None, now_ns
        self._maps_number = station.shade.number

    def due(self, step: StepTaken, number: int) -> tuple[DueMaps | DueKeyframe, ...]:
        """Return the maps that are due after a step, if any, and the keyframe: at a tick."""
        after, now_ns = step.after, step.now_ns
        has_keyframe = isinstance(step.event, Tick) and now_ns >= self._due_ns
        maps = self._maps(after.shade, now_ns) if self._detail.has_all_maps or has_keyframe else ()
        if not has_keyframe:
            return maps
        self._due_ns = now_ns + seconds_to_ns(self._detail.keyframe_s)
        changed = frozenset(
            name for name in _SELDOM if getattr(after, name) is not getattr(self._first, name)
        )
        return (*maps, DueKeyframe(number, now_ns, after, self._maps_at_ns, changed))

    def _maps(self, line: ShadePipeline, now_ns: int) -> tuple[DueMaps, ...]:
        """Return the newest maps if they are not in the file."""
        if line.number == self._maps_number:
            return ()
        self._maps_number, self._maps_at_ns = line.number, now_ns
        return () if line.shade is None else (DueMaps(now_ns, line.shade, line.sun),)


def keyframe_pieces(codec: Codec, due: DueKeyframe) -> Iterator[bytes]:
    """Encode a keyframe bit by bit: nothing is yielded but empty bytes until it is whole.

    With 64 vehicles it takes 13 ms, more than an order should wait for; each piece takes 5 ms.
    """
    hints, station = _hints(), due.station
    small = without_recorded(station)
    parts = dict[str, msgspec.Raw]()
    for name in (*_ALWAYS, *sorted(due.changed)):
        value = codec.to_builtins(getattr(small, name), hints[name])
        parts[name] = msgspec.Raw(msgspec.msgpack.encode(value))
        if name in _LARGE:
            yield b""
    maps = None if due.maps_at_ns is None else _map_facts(station.shade, due.maps_at_ns)
    facts = None if maps is None else codec.to_builtins(maps, MapFacts)
    yield msgspec.msgpack.encode({"parts": parts, "maps": facts})


def without_recorded(station: Station) -> Station:
    """Return a station without memories and without what a record holds elsewhere."""
    imagers = {s: _small_imager(each) for s, each in station.imaging.imagers.items()}
    records = {n: _small_survey(each) for n, each in station.surveys.records.items()}
    return replace(
        station,
        frames={s: replace(each, rgb=None, jpeg=None) for s, each in station.frames.items()},
        imaging=replace(station.imaging, imagers=imagers),
        shade=_small_shade(station.shade),
        surveys=replace(station.surveys, records=records),
    )


def _small_imager(imager: ImagerFrames) -> ImagerFrames:
    image = imager.ground_image
    if image is not None:
        image = replace(image, rgb=NO_PIXELS, valid=NO_PIXELS[..., 0].astype(bool))
    return replace(
        imager,
        registration=RegistrationState(),
        waiting=None,
        samples=imager.samples[-SAMPLES_KEPT:],
        ground_image=image,
    )


def _small_shade(line: ShadePipeline) -> ShadePipeline:
    return replace(
        line,
        detections={s: _notes_only(each) for s, each in line.detections.items()},
        own=NONE,
        forecast=ForecastState(compared=line.forecast.compared),
        shade=None,
        sun=None,
        waiting=(),
        references=None,
    )


def _notes_only(memory: DetectionState) -> DetectionState:
    """Keep what the operator reads of the sunlit method's memory."""
    kept = memory.sunlit
    if kept is None:
        return DetectionState()
    note = replace(kept.adopted, earlier=None)
    return DetectionState(sunlit=type(kept)(note, lock_problem=kept.lock_problem))


def _small_survey(record: SurveyRecord) -> SurveyRecord:
    state = record.state
    if state is not None:
        state = replace(state, progress=replace(state.progress, shade=()))
    return replace(record, state=state, shade_maps=NumberedBuffer((), record.shade_maps.end))


def _map_facts(line: ShadePipeline, at_ns: int) -> MapFacts | None:
    if line.shade is None:
        return None
    if line.sun is None:
        return MapFacts(at_ns, line.shade.source_serials)
    sun = line.sun
    return MapFacts(
        at_ns,
        line.shade.source_serials,
        tuple(sun.lead_s.tolist()),
        sun.prior_sunlit,
        sun.method,
        sun.velocity_mps,
    )


@dataclass(frozen=True, slots=True, eq=False)
class StationKeyframe:
    """A keyframe that was read: the fields of its station, and what belongs to its maps."""

    parts: Mapping[str, Any]
    maps: MapFacts | None


def read_keyframe(codec: Codec, data: bytes) -> StationKeyframe:
    """Return a recorded keyframe; raises `RecordError` for other bytes.

    A field that it lacks came with a later version: it is as at the file's beginning. One that a
    station does not have is noted and skipped.
    """
    try:
        found = msgspec.msgpack.decode(data, type=dict[str, Any])
    except (msgspec.MsgspecError, ValueError, RecursionError) as problem:
        raise RecordError(f"a keyframe is damaged: {problem}") from problem
    parts, maps, hints = found.get("parts"), found.get("maps"), _hints()
    if not isinstance(parts, dict) or not hints.keys() & parts.keys():
        raise RecordError("a keyframe is damaged: expected fields of a station")
    codec.note_skipped(Station, parts.keys() - hints.keys())
    read = {name: codec.from_builtins(parts[name], hints[name]) for name in parts if name in hints}
    return StationKeyframe(read, None if maps is None else codec.from_builtins(maps, MapFacts))


def restored(
    keyframe: StationKeyframe, start: Station, maps: tuple[ShadeMap, SunForecast | None] | None
) -> Station:
    """Return the station of a keyframe, with the file's first state and the newest maps.

    Without maps it keeps those of the first state, if the keyframe names none of this file.
    """
    station = replace(start, **keyframe.parts)
    line = station.shade
    if maps is None and keyframe.maps is None:
        maps = None if start.shade.shade is None else (start.shade.shade, start.shade.sun)
    if maps is not None:
        line = replace(line, shade=maps[0], sun=maps[1])
    return replace(station, shade=replace(line, references=start.shade.references))


def maps_of(
    recorded: MapMessages, facts: MapFacts, frame: LocalFrame
) -> tuple[ShadeMap, SunForecast | None]:
    """Return the shade map and the forecast of their messages; raises `RecordError`."""
    grid, at_ns, cells = _cells(recorded.shade, frame)
    if cells.shape[2] != 12:
        raise RecordError("a shade map is damaged: expected three floats a cell")
    layers = np.ascontiguousarray(cells).view("<f4")
    transmittance, confidence, metres = (layers[..., n].astype(np.float32) for n in range(3))
    shade = ShadeMap(
        grid=grid,
        captured_at_ns=at_ns,
        source_serials=facts.source_serials,
        transmittance=transmittance,
        valid=np.isfinite(transmittance),
        confidence=confidence,
        metres_per_pixel=metres,
    )
    if recorded.sun is None or not facts.lead_s:
        return shade, None
    grid, at_ns, cells = _cells(recorded.sun, frame)
    leads = len(facts.lead_s)
    if cells.shape[2] != leads + 4:
        raise RecordError(f"a forecast is damaged: expected {leads} leads and a horizon a cell")
    try:
        return shade, SunForecast(
            grid=grid,
            issued_at_ns=at_ns,
            lead_s=np.array(facts.lead_s),
            sun_probability=np.ascontiguousarray(np.moveaxis(cells[..., :leads], -1, 0)),
            horizon_s=np.ascontiguousarray(cells[..., leads:]).view("<f4")[..., 0],
            prior_sunlit=facts.prior_sunlit,
            method=facts.method,
            velocity_mps=facts.velocity_mps,
        )
    except ValueError as problem:
        raise RecordError(f"a forecast is damaged: {problem}") from problem


def _cells(data: bytes, frame: LocalFrame) -> tuple[GroundGrid, int, npt.NDArray[np.uint8]]:
    """Return grid, time and bytes (R, C, stride) of a `foxglove.Grid`, row 0 north."""
    from foxglove_schemas_protobuf.Grid_pb2 import Grid
    from google.protobuf.message import DecodeError

    try:
        found = Grid.FromString(data)
    except DecodeError as problem:
        raise RecordError(f"a map is damaged: {problem}") from problem
    cols, stride, cell_m = found.column_count, found.cell_stride, found.cell_size.x
    size = cols * stride
    rows, rest = divmod(len(found.data), size) if size > 0 else (0, 1)
    if rest or not 0 < rows * cols <= MOST_CELLS or not 0.0 < cell_m < 1e4:
        raise RecordError(f"a map is damaged: {len(found.data)} bytes in {cols} columns")
    south_m = found.pose.position.y
    grid = GroundGrid(frame, found.pose.position.x, south_m + rows * cell_m, cell_m, rows, cols)
    at_ns = found.timestamp.seconds * NS_PER_S + found.timestamp.nanos
    cells = np.frombuffer(found.data, np.uint8).reshape(rows, cols, stride)[::-1]
    return grid, at_ns, cells


@cache
def _hints() -> dict[str, Any]:
    return get_type_hints(Station)
