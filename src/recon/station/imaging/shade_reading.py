"""Ground images into the worker, shade maps and forecasts out: each a pure step."""

from dataclasses import replace

from recon.detection import RejectedFrame
from recon.model.event import WorkerResult
from recon.model.imagery import GroundImage
from recon.station.imaging.shade_work import READ_SHADE, ReadShade, ShadeRead
from recon.station.state.outputs import StartWork
from recon.station.state.shade import WAITING_KEPT, ShadeLine
from recon.station.state.station import Station
from recon.station.state.stepped import Stepped


def take_image(station: Station, image: GroundImage) -> Stepped:
    """Return the station with one more ground image to be read; the oldest that waits may go."""
    line = station.shade
    waiting = (*line.waiting, image)
    kept = waiting[-WAITING_KEPT:]
    dropped = line.frames_dropped + len(waiting) - len(kept)
    return _next(station, replace(line, waiting=kept, frames_dropped=dropped))


def take_result(station: Station, event: WorkerResult) -> Stepped:
    """Return the station after a frame was read, or was not."""
    line = station.shade
    if event.job_id != line.job_id:
        return station, ()
    line = replace(line, job_id=None)
    if not isinstance(event.result, ShadeRead):
        return _next(station, replace(line, error=event.error, rejected=None))
    return _next(station, _with(line, event.result))


def lost(station: Station, job_id: int) -> Stepped:
    """Return the station after the worker has dropped a frame's work: the next one goes on."""
    line = station.shade
    if job_id != line.job_id:
        return station, ()
    return _next(station, replace(line, job_id=None, frames_dropped=line.frames_dropped + 1))


def _with(line: ShadeLine, read: ShadeRead) -> ShadeLine:
    line = replace(line, detection=read.detection, forecast=read.forecast, error=None)
    if isinstance(read.found, RejectedFrame):
        return replace(line, rejected=read.found, frames_rejected=line.frames_rejected + 1)
    shade, sun = read.found
    return replace(line, shade=shade, sun=sun, rejected=None, number=line.number + 1)


def _next(station: Station, line: ShadeLine) -> Stepped:
    """Begin with the oldest image that waits, unless one is being read."""
    if line.job_id is not None or not line.waiting:
        return replace(station, shade=line), ()
    first, *rest = line.waiting
    settings, number = station.settings, line.next_job_id
    work = ReadShade(first, line.detection, line.forecast, settings.detection, settings.forecast)
    line = replace(line, waiting=tuple(rest), job_id=number, next_job_id=number + 1)
    return replace(station, shade=line), (StartWork(number, READ_SHADE, work),)
