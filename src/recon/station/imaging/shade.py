"""Ground images to shade maps and sun forecasts: read one by one, in order, by the worker.

Each image is read by what is known of its own camera. The maps of several imaging drones become one
map of the newest one's time, the older moved on with the shadows; the forecast is made from it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

from recon.detection import (
    DETECTORS,
    DetectionSettings,
    DetectionState,
    RejectedFrame,
    merged,
)
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState, moved_on
from recon.geo import nearest_cells
from recon.model.geo import GroundGrid
from recon.model.imagery import GroundImage
from recon.model.methods import MethodRegistry
from recon.model.shade import MaskMap, ShadeMap, SunForecast
from recon.model.units import ns_to_seconds
from recon.station.imaging import references
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imaging import (
    NONE,
    TOGETHER_WITHIN_S,
    WAITING_KEPT,
    SeenShade,
    ShadePipeline,
)
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Stepped

Method = TypeVar("Method")

RULE, LOCK_RULE = "shade", "exposure_lock"
TROUBLE_AFTER_S = 5.0
"""One torn frame is no trouble; a camera that is black or frozen for five seconds is."""


@dataclass(frozen=True, slots=True, eq=False)
class ReadShade:
    """The next ground image, and the methods' memories of those before it.

    `others` are the newest maps of the other imaging drones, `velocity_mps` that of the shadows.
    """

    image: GroundImage
    detection: DetectionState
    forecast: ForecastState
    detection_settings: DetectionSettings
    forecast_settings: ForecastSettings
    others: tuple[SeenShade, ...] = ()
    velocity_mps: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ShadeRead:
    """What an image showed, or why it was rejected; and the methods' new memories."""

    serial: str
    """The imaging drone's serial."""
    detection: DetectionState
    forecast: ForecastState
    own: SeenShade | RejectedFrame
    merged: tuple[SeenShade, SunForecast | None] | None = None
    """All imaging drones' map and the forecast from it, if that is shown; None for a rejected
    frame, and for one taken before another drone's that was read already."""


def on_ground_image(station: Station, image: GroundImage) -> Stepped:
    """Queue a ground image; if too many wait, drop the oldest."""
    pipeline = station.shade
    waiting = (*pipeline.waiting, image)
    kept = waiting[-WAITING_KEPT:]
    dropped = pipeline.frames_dropped + len(waiting) - len(kept)
    return _next(station, replace(pipeline, waiting=kept, frames_dropped=dropped))


def read_shade(work: ReadShade, *, shows_sun: bool = True) -> ShadeRead:
    """Read one image by the methods named in the settings.

    Where no console, record or other imaging drone takes each forecast, `shows_sun` is False: then
    only what decides by a forecast makes it (`ShadePipeline.newest_sun`).

    Raises `ValueError` for an unknown method.
    """
    detect = _method(DETECTORS, work.detection_settings.method, "detection")
    detection, shade = detect(work.detection, work.image, work.detection_settings)
    if isinstance(shade, RejectedFrame):
        return ShadeRead(work.image.serial, detection, work.forecast, shade)
    if not (isinstance(detection, DetectionState) and isinstance(shade, ShadeMap)):
        raise ValueError(f"expected a DetectionState and a ShadeMap, got {shade!r:.80}")
    return with_forecast(work, detection, shade, seen_cells(work.image, shade.grid), shows_sun)


def with_forecast(
    work: ReadShade, detection: DetectionState, shade: ShadeMap, seen: MaskMap, shows_sun: bool
) -> ShadeRead:
    """Return what follows from an image's own map: the map of all imaging drones, and a forecast.

    Raises `ValueError` for an unknown method.
    """
    forecaster = _method(FORECASTERS, work.forecast_settings.method, "forecast")
    own, newest, serial = SeenShade(shade, seen), work.forecast.shade, work.image.serial
    if newest is not None and shade.captured_at_ns <= newest.captured_at_ns:
        return ShadeRead(serial, detection, work.forecast, own)
    together = _together(own, work.others, work.velocity_mps)
    observe = forecaster.after if shows_sun else forecaster.without_forecast
    forecast, sun = observe(work.forecast, together.shade, work.forecast_settings, together.seen)
    if not (isinstance(forecast, ForecastState) and isinstance(sun, SunForecast | None)):
        raise ValueError(f"expected a ForecastState and a SunForecast, got {sun!r:.80}")
    return ShadeRead(serial, detection, forecast, own, (together, sun))


def _together(
    own: SeenShade, others: tuple[SeenShade, ...], velocity_mps: tuple[float, float] | None
) -> SeenShade:
    """Return one map of an image's time; `others` are older, or their map would be later."""
    shades, seen, at_ns = [own.shade], own.seen, own.shade.captured_at_ns
    for other in others:
        age_s = ns_to_seconds(at_ns - other.shade.captured_at_ns)
        if age_s <= TOGETHER_WITHIN_S and other.shade.grid == own.shade.grid:
            shades.append(moved_on(other.shade, velocity_mps, age_s))
            seen = seen | other.seen
    return SeenShade(merged(shades), seen)


def seen_cells(image: GroundImage, grid: GroundGrid) -> MaskMap:
    """Return (R, C) of `grid`: whether a ground image shows the middle of each cell.

    Both grids are of one local frame.
    """
    rows, cols, is_inside = nearest_cells(image.grid, grid)
    return image.valid[rows, cols] & is_inside


def conditions(station: Station) -> Iterator[Condition]:
    """Yield the alarms of shade detection: frames not read, a camera that is not locked."""
    pipeline = station.shade
    for serial, detection in pipeline.detections.items():
        yield from _lock_conditions(serial, detection)
    yield from references.conditions(pipeline)
    for serial in station.imaging.imagers:
        rejected = pipeline.rejected.get(serial)
        why = pipeline.error if rejected is None else rejected.reason
        if why is not None:
            key = f"{RULE}:{serial}"
            text = f"no shade is read from the imaging drone's frames: {why}"
            yield Condition(
                key, Severity.WARNING, RULE, serial, text, serial, after_s=TROUBLE_AFTER_S
            )


def _lock_conditions(serial: str, detection: DetectionState) -> Iterator[Condition]:
    memory = detection.sunlit
    if memory is None or not memory.lock_problem:
        return
    text = (
        f"the imaging drone's camera is not locked: {memory.lock_problem}; lock exposure and white "
        'balance in the app, or state exposure = "auto" in site.toml; shade is found without '
        "the lock meanwhile"
    )
    key = f"{LOCK_RULE}:{serial}"
    yield Condition(key, Severity.WARNING, LOCK_RULE, serial, text, serial)


def _read(station: Station, job_id: int, read: ShadeRead, _now_ns: int) -> Stepped:
    pipeline = station.shade
    if job_id != pipeline.job_id:
        return station, ()
    pipeline = replace(
        pipeline,
        job_id=None,
        detections={**pipeline.detections, read.serial: read.detection},
        forecast=read.forecast,
        error=None,
    )
    if isinstance(read.own, RejectedFrame):
        rejected = {**pipeline.rejected, read.serial: read.own}
        number = pipeline.frames_rejected + 1
        return _next(station, replace(pipeline, rejected=rejected, frames_rejected=number))
    rejected = {s: each for s, each in pipeline.rejected.items() if s != read.serial}
    own = {**pipeline.own, read.serial: read.own}
    pipeline = replace(pipeline, own=own, rejected=rejected)
    if read.merged is None:
        return _next(station, pipeline)
    (newest, sun), number = read.merged, pipeline.number + 1
    pipeline = replace(pipeline, shade=newest.shade, seen=newest.seen, sun=sun, number=number)
    pipeline, kept = references.written(pipeline, station.imaging)
    station, started = _next(station, pipeline)
    return station, (*started, *kept)


def _not_read(station: Station, job_id: int, error: str, _now_ns: int) -> Stepped:
    pipeline = station.shade
    if job_id != pipeline.job_id:
        return station, ()
    return _next(station, replace(pipeline, job_id=None, error=error, rejected=NONE))


def _dropped(station: Station, job_id: int, _now_ns: int) -> Stepped:
    pipeline = station.shade
    if job_id != pipeline.job_id:
        return station, ()
    dropped = pipeline.frames_dropped + 1
    return _next(station, replace(pipeline, job_id=None, frames_dropped=dropped))


def _outside(work: ReadShade) -> str:
    detection, forecast = work.detection_settings.method, work.forecast_settings.method
    if detection in DETECTORS.outside:
        return detection
    return forecast if forecast in FORECASTERS.outside else ""


READ_SHADE: JobKind[ReadShade, ShadeRead] = JobKind(
    "read_shade", lambda _site: read_shade, _read, _not_read, _dropped, outside=_outside
)
"""Reads one ground image for shade and forecasts the sun."""


def _next(station: Station, pipeline: ShadePipeline) -> Stepped:
    """Start a job for the oldest image that waits, unless one is running."""
    if pipeline.job_id is not None or not pipeline.waiting:
        return replace(station, shade=pipeline), ()
    first, *rest = pipeline.waiting
    settings, number = station.settings, pipeline.next_job_id
    keeping = pipeline.references
    fresh = DetectionState(references=() if keeping is None else keeping.found)
    work = ReadShade(
        first,
        pipeline.detections.get(first.serial, fresh),
        pipeline.forecast,
        settings.detection,
        settings.forecast,
        tuple(each for serial, each in pipeline.own.items() if serial != first.serial),
        None if pipeline.sun is None else pipeline.sun.velocity_mps,
    )
    pipeline = replace(pipeline, waiting=tuple(rest), job_id=number, next_job_id=number + 1)
    return replace(station, shade=pipeline), (Job(number, READ_SHADE, work),)


def _method(methods: MethodRegistry[Method], name: str, what: str) -> Method:
    if name not in methods:
        raise ValueError(f"{what}: expected the method {' or '.join(methods.names)}, got {name}")
    return methods[name]
