"""Ground images to shade maps and sun forecasts: read one by one, in order, by the worker."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from recon.detection import DETECTORS, DetectionSettings, DetectionState, RejectedFrame
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.shade import MaskMap, ShadeMap, SunForecast
from recon.station.imaging import references
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imaging import WAITING_KEPT, ShadePipeline
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Stepped

Method = TypeVar("Method")

RULE, LOCK_RULE = "shade", "exposure_lock"
TROUBLE_AFTER_S = 5.0
"""One torn frame is no trouble; a camera that is black or frozen for five seconds is."""


@dataclass(frozen=True, slots=True, eq=False)
class ReadShade:
    """The next ground image, and the methods' memories of those before it."""

    image: GroundImage
    detection: DetectionState
    forecast: ForecastState
    detection_settings: DetectionSettings
    forecast_settings: ForecastSettings


@dataclass(frozen=True, slots=True, eq=False)
class ShadeRead:
    """A shade map with its forecast, or a rejected frame; and the methods' new memories."""

    detection: DetectionState
    forecast: ForecastState
    found: tuple[ShadeMap, SunForecast] | RejectedFrame
    seen: MaskMap | None = None
    """The cells of the map that the image showed; None for a rejected frame."""


def on_ground_image(station: Station, image: GroundImage) -> Stepped:
    """Queue a ground image; if too many wait, drop the oldest."""
    pipeline = station.shade
    waiting = (*pipeline.waiting, image)
    kept = waiting[-WAITING_KEPT:]
    dropped = pipeline.frames_dropped + len(waiting) - len(kept)
    return _next(station, replace(pipeline, waiting=kept, frames_dropped=dropped))


def read_shade(work: ReadShade) -> ShadeRead:
    """Read one image by the methods named in the settings.

    Raises `ValueError` for an unknown method.
    """
    detect = _method(DETECTORS, work.detection_settings.method, "detection")
    predict = _method(FORECASTERS, work.forecast_settings.method, "forecast")
    detection, shade = detect(work.detection, work.image, work.detection_settings)
    if isinstance(shade, RejectedFrame):
        return ShadeRead(detection, work.forecast, shade)
    forecast, sun = predict(work.forecast, shade, work.forecast_settings)
    return ShadeRead(detection, forecast, (shade, sun), seen_cells(work.image, shade.grid))


def seen_cells(image: GroundImage, grid: GroundGrid) -> MaskMap:
    """Return (R, C) of `grid`: whether a ground image shows the middle of each cell.

    Both grids are of one local frame.
    """
    laid = image.grid
    north_m = grid.north_m - (np.arange(grid.rows) + 0.5) * grid.cell_m
    east_m = grid.west_m + (np.arange(grid.cols) + 0.5) * grid.cell_m
    row = np.floor((laid.north_m - north_m) / laid.cell_m).astype(np.intp)
    col = np.floor((east_m - laid.west_m) / laid.cell_m).astype(np.intp)
    is_inside = np.logical_and.outer((row >= 0) & (row < laid.rows), (col >= 0) & (col < laid.cols))
    row, col = row.clip(0, laid.rows - 1), col.clip(0, laid.cols - 1)
    seen: MaskMap = image.valid[np.ix_(row, col)] & is_inside
    return seen


def conditions(station: Station) -> Iterator[Condition]:
    """Yield the alarms of shade detection: frames not read, a camera that is not locked."""
    pipeline = station.shade
    yield from _lock_conditions(station)
    yield from references.conditions(pipeline, station.imaging.imager_serial)
    why = pipeline.error if pipeline.rejected is None else pipeline.rejected.reason
    if why is not None:
        serial = station.imaging.imager_serial
        text = f"no shade is read from the imaging drone's frames: {why}"
        yield Condition(
            RULE, Severity.WARNING, RULE, serial or "", text, serial, after_s=TROUBLE_AFTER_S
        )


def _lock_conditions(station: Station) -> Iterator[Condition]:
    memory, serial = station.shade.detection.sunlit, station.imaging.imager_serial
    if memory is None or not memory.lock_problem:
        return
    text = (
        f"the imaging drone's camera is not locked: {memory.lock_problem}; lock exposure and white "
        'balance in the app, or state exposure = "auto" in site.toml; shade is found without '
        "the lock meanwhile"
    )
    yield Condition(LOCK_RULE, Severity.WARNING, LOCK_RULE, serial or "", text, serial)


def _read(station: Station, job_id: int, read: ShadeRead, _now_ns: int) -> Stepped:
    pipeline = station.shade
    if job_id != pipeline.job_id:
        return station, ()
    pipeline = replace(
        pipeline, job_id=None, detection=read.detection, forecast=read.forecast, error=None
    )
    if isinstance(read.found, RejectedFrame):
        rejected = pipeline.frames_rejected + 1
        return _next(station, replace(pipeline, rejected=read.found, frames_rejected=rejected))
    shade, sun = read.found
    number = pipeline.number + 1
    pipeline = replace(pipeline, shade=shade, sun=sun, seen=read.seen, rejected=None, number=number)
    pipeline, kept = references.written(pipeline, station.imaging.ground_image)
    station, started = _next(station, pipeline)
    return station, (*started, *kept)


def _not_read(station: Station, job_id: int, error: str, _now_ns: int) -> Stepped:
    pipeline = station.shade
    if job_id != pipeline.job_id:
        return station, ()
    return _next(station, replace(pipeline, job_id=None, error=error, rejected=None))


def _dropped(station: Station, job_id: int, _now_ns: int) -> Stepped:
    pipeline = station.shade
    if job_id != pipeline.job_id:
        return station, ()
    dropped = pipeline.frames_dropped + 1
    return _next(station, replace(pipeline, job_id=None, frames_dropped=dropped))


READ_SHADE: JobKind[ReadShade, ShadeRead] = JobKind(
    "read_shade", lambda _site: read_shade, _read, _not_read, _dropped
)
"""Reads one ground image for shade and forecasts the sun."""


def _next(station: Station, pipeline: ShadePipeline) -> Stepped:
    """Start a job for the oldest image that waits, unless one is running."""
    if pipeline.job_id is not None or not pipeline.waiting:
        return replace(station, shade=pipeline), ()
    first, *rest = pipeline.waiting
    settings, number = station.settings, pipeline.next_job_id
    work = ReadShade(
        first, pipeline.detection, pipeline.forecast, settings.detection, settings.forecast
    )
    pipeline = replace(pipeline, waiting=tuple(rest), job_id=number, next_job_id=number + 1)
    return replace(station, shade=pipeline), (Job(number, READ_SHADE, work),)


def _method(methods: Mapping[str, Method], name: str, what: str) -> Method:
    if name not in methods:
        raise ValueError(f"{what}: expected the method {' or '.join(methods)}, got {name}")
    return methods[name]
