"""Forecasts of a record, and what its keyframes state of guidance, one by one in their order.

A keyframe is the station's own state: only the velocity of the shadows and the cells of surveys are
read of it, and one of another version that lacks them states nothing.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from foxglove_schemas_protobuf.Grid_pb2 import Grid
from google.protobuf.message import DecodeError

from recon.geo import nearest_cells
from recon.model.arrays import FloatArray
from recon.model.errors import RecordError
from recon.model.geo import GroundGrid
from recon.model.units import NS_PER_S
from recon.product.flight import MOST_CELLS, UNKNOWN, ByteMap
from recon.product.flight_log import forecast_leads, is_on
from recon.record.mcap.codec import decode_array
from recon.record.mcap.foxglove import SUN_TOPIC
from recon.record.mcap.mcap_file import KEYFRAMES_TOPIC
from recon.record.mcap.mcap_read import McapReading, Opener, RecordMessage, opened

STATE_EVERY_NS = 5 * NS_PER_S
"""Least time between two states: a drone images a strip of ten cells in it."""


@dataclass(frozen=True, slots=True, eq=False)
class RecordedForecast:
    """A forecast as it was issued; `probability` (L, R, C) of sun is in 255ths, row 0 north."""

    issued_at_ns: int
    lead_s: FloatArray
    probability: ByteMap


@dataclass(frozen=True, slots=True, eq=False)
class RecordedState:
    """What a keyframe states: the shadows' velocity east and north, if one was known, and each
    survey's `CellState` (R, C) on the shade maps' cells, `UNKNOWN` outside its region."""

    at_ns: int
    velocity_mps: tuple[float, float] | None
    surveys: Mapping[str, ByteMap]


class _Array(msgspec.Struct, frozen=True):
    dtype: str
    shape: list[int]
    data: bytes


class _Place(msgspec.Struct, frozen=True):
    west_m: float
    north_m: float
    cell_m: float
    rows: int
    cols: int


class _Cells(msgspec.Struct, frozen=True):
    grid: _Place
    is_inside: _Array


class _Plan(msgspec.Struct, frozen=True):
    cells: _Cells


class _Progress(msgspec.Struct, frozen=True):
    state: _Array


class _SurveyCells(msgspec.Struct, frozen=True):
    plan: _Plan
    progress: _Progress


class _Record(msgspec.Struct, frozen=True):
    state: _SurveyCells | None = None
    survey: dict[str, Any] = {}


class _Surveys(msgspec.Struct, frozen=True):
    records: list[tuple[int, _Record]] = []


class _Parts(msgspec.Struct, frozen=True):
    surveys: _Surveys = _Surveys()


class _Facts(msgspec.Struct, frozen=True):
    velocity_mps: tuple[float, float] | None = None


class _Keyframe(msgspec.Struct, frozen=True):
    parts: _Parts = _Parts()
    maps: _Facts | None = None


def recorded_states(
    path: Path, grid: GroundGrid, open_record: Opener = opened
) -> Iterator[RecordedForecast | RecordedState]:
    """Yield what a record states on the cells of its shade maps; forecasts on others are skipped.

    Raises `RecordError` for a damaged record, and OSError.
    """
    decoder, due_ns = msgspec.msgpack.Decoder(_Keyframe), 0
    with open_record(path) as file:
        for item in McapReading(file).items():
            if not isinstance(item, RecordMessage):
                continue
            try:
                if item.topic == SUN_TOPIC:
                    message = Grid.FromString(item.data)
                    if is_on(message, grid):
                        yield _forecast(message, grid)
                elif item.topic == KEYFRAMES_TOPIC and item.log_ns >= due_ns:
                    due_ns = item.log_ns + STATE_EVERY_NS
                    yield _state(decoder.decode(item.data), item.log_ns, grid)
            except (msgspec.MsgspecError, DecodeError, ValueError, RecordError) as problem:
                raise RecordError(
                    f"{path}: {item.topic} is damaged at {item.log_ns} ns: {problem}"
                ) from problem


def _forecast(message: Grid, grid: GroundGrid) -> RecordedForecast:
    by_lead = dict(sorted(forecast_leads(message, grid).items()))
    probability = np.stack(list(by_lead.values()))
    return RecordedForecast(message.timestamp.ToNanoseconds(), np.array([*by_lead]), probability)


def _state(keyframe: _Keyframe, at_ns: int, grid: GroundGrid) -> RecordedState:
    surveys = {
        f"{record.survey.get('name') or 'survey'} ({number})": _cells(record.state, grid)
        for number, record in keyframe.parts.surveys.records
        if record.state is not None
    }
    velocity_mps = None if keyframe.maps is None else keyframe.maps.velocity_mps
    return RecordedState(at_ns, velocity_mps, surveys)


def _cells(survey: _SurveyCells, grid: GroundGrid) -> ByteMap:
    """Return the state of each of the grid's cells, by the survey's cell at its centre."""
    place, shape = (
        survey.plan.cells.grid,
        (survey.plan.cells.grid.rows, survey.plan.cells.grid.cols),
    )
    inside, state = (
        decode_array(each.dtype, each.shape, each.data, np.generic)
        for each in (survey.plan.cells.is_inside, survey.progress.state)
    )
    is_placed = isfinite(place.west_m) and isfinite(place.north_m) and 0.0 < place.cell_m < 1e4
    if not is_placed or inside.shape != shape or state.shape != shape or inside.size > MOST_CELLS:
        raise ValueError(f"expected a survey's {shape} cells, got {inside.shape}, {state.shape}")
    source = GroundGrid(grid.frame, place.west_m, place.north_m, place.cell_m, *shape)
    rows, cols, is_there = nearest_cells(source, grid)
    is_known = is_there & inside.astype(np.bool_)[rows, cols]
    return np.where(is_known, state.astype(np.uint8)[rows, cols], np.uint8(UNKNOWN))
