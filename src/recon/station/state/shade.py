"""What is known of the shade on the ground, and of the frames that still wait to be read."""

from dataclasses import dataclass, field

from recon.detection import DetectionState, RejectedFrame
from recon.forecast import ForecastState
from recon.model.imagery import GroundImage
from recon.model.shade import ShadeMap, SunForecast

WAITING_KEPT = 8
"""Ground images that wait to be read, of 1 MB each: at one a second, the worker has this long to
catch up. More than these drop the oldest, and are counted."""


@dataclass(frozen=True, slots=True, eq=False)
class ShadeLine:
    """The methods' memories, what they told last, and what waits.

    The memories travel with each piece of work and come back with its result, so that a step
    depends on nothing but its arguments. So there is one piece of work at a time, and every frame
    is read in order. `number` counts the shade maps of this run; the newest forecast is of the
    newest map. `rejected` is the newest frame when no shade was read from it.
    """

    detection: DetectionState = field(default_factory=DetectionState)
    forecast: ForecastState = field(default_factory=ForecastState)
    number: int = 0
    shade: ShadeMap | None = None
    sun: SunForecast | None = None
    waiting: tuple[GroundImage, ...] = ()
    job_id: int | None = None
    """Of the work under way."""
    next_job_id: int = 1
    frames_rejected: int = 0
    frames_dropped: int = 0
    rejected: RejectedFrame | None = None
    error: str | None = None
    """Why the newest frame's work failed."""
