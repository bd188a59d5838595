"""The state of the imaging pipeline: imaging drones' telemetry, ground images, shade maps."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from recon.camera.registration import RegistrationState
from recon.detection import DetectionState, RejectedFrame
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.imagery import CameraPose, Frame, GroundImage, Outlook, TelemetryReference
from recon.model.shade import MaskMap, ShadeMap, SunForecast, SunlitReference

WAITING_KEPT = 8
"""Ground images that wait to be read, of 1 MB each: at one a second, the worker has this long to
catch up. More drop the oldest, and are counted."""

TOGETHER_WITHIN_S = 10.0
"""Largest age difference to the newest image: older images and maps of other imaging drones are not
shown with it. Shadows have moved since, and an old image would look current."""

NONE: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class ImagerSample:
    """The imaging drone's telemetry at one moment."""

    at_ns: int
    telemetry: TelemetryReference


@dataclass(frozen=True, slots=True, eq=False)
class ProjectFrame:
    """A frame to project, the telemetry at its capture, and that of the marked frame."""

    frame: Frame
    telemetry: TelemetryReference
    reference: TelemetryReference
    captured_utc_s: float | None = None
    """Capture time by the computer's clock, for the sun's position; None before it was read."""
    registration: RegistrationState = field(default_factory=RegistrationState)
    """What registration keeps of the frames before; set when the job starts."""


@dataclass(frozen=True, slots=True, eq=False)
class LayMarkedFrame(ProjectFrame):
    """A frame to project by a pose that was marked in this run.

    A type of its own: without such a pose a job's input is what earlier records have.
    """

    marked_pose: CameraPose | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ImagerFrames:
    """Frames and ground images of one imaging drone.

    What registration keeps travels with each job and comes back with its result, as the memories of
    the shade methods do. Of the frames received while a job runs the newest waits. `reference` is
    the telemetry of the frame the control points were marked on. If the site does not give it, the
    first frame received in flight takes its place.
    """

    serial: str
    reference: TelemetryReference | None = None
    is_reference_assumed: bool = True
    is_placed_by_telemetry: bool = False
    """Whether the site has no control points, so that telemetry alone places the camera."""
    outlook: Outlook | None = None
    """What its camera shows, by the site's files."""
    marked_pose: CameraPose | None = None
    """The camera's pose of a frame that was marked in this run; None: the site's."""
    samples: tuple[ImagerSample, ...] = ()
    ground_image: GroundImage | None = None
    captured_sigma_s: float = 0.0
    registration: RegistrationState = field(default_factory=RegistrationState)
    registration_problem: str = ""
    """Why the newest frame was not aligned; empty if it was."""
    waiting: ProjectFrame | LayMarkedFrame | None = None
    frames_dropped: int = 0
    latest_error: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Imaging:
    """The site's imaging drones, and the one job that projects a frame of one of them."""

    imagers: Mapping[str, ImagerFrames] = field(default_factory=lambda: NONE)
    """Frames by serial, in the order of the site's file."""
    job_id: int | None = None
    """Id of the running job."""
    job_serial: str = ""
    """The imaging drone whose frame it projects."""
    next_job_id: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class SeenShade:
    """A shade map, and the cells (R, C) that its ground images showed.

    Those without a value are unknown.
    """

    shade: ShadeMap
    seen: MaskMap


@dataclass(frozen=True, slots=True, eq=False)
class DueForecast:
    """The forecast from the newest map, before anyone has read it."""

    state: ForecastState
    settings: ForecastSettings


def made(sun: SunForecast | DueForecast | None) -> SunForecast | None:
    """Return a forecast, made now if it is due. Takes too long for a step."""
    if not isinstance(sun, DueForecast):
        return sun
    return FORECASTERS[sun.settings.method].forecast(sun.state, sun.settings)


@dataclass(frozen=True, slots=True, eq=False)
class ShadePipeline:
    """Ground images that wait to be read for shade, and the newest shade map and forecast.

    The memories of the detection and forecast methods travel with each job and come back with its
    result, so that a step depends on its arguments alone: one job at a time, every image in order.
    `number` counts the shade maps of this run; the forecast is always of the newest map.
    """

    detections: Mapping[str, DetectionState] = field(default_factory=lambda: NONE)
    """What detection remembers of each imaging drone's frames, by serial."""
    own: Mapping[str, SeenShade] = field(default_factory=lambda: NONE)
    """The newest shade map of each imaging drone alone."""
    forecast: ForecastState = field(default_factory=ForecastState)
    number: int = 0
    shade: ShadeMap | None = None
    """Shade map of all imaging drones."""
    seen: MaskMap | None = None
    """The cells of `shade` that its ground images showed; those without a value are unknown."""
    sun: SunForecast | None = None
    """None also where no console or record shows forecasts: see `newest_sun`."""
    waiting: tuple[GroundImage, ...] = ()
    job_id: int | None = None
    """Id of the running job."""
    frames_rejected: int = 0
    frames_dropped: int = 0
    rejected: Mapping[str, RejectedFrame] = field(default_factory=lambda: NONE)
    """Each imaging drone's newest frame, if no shade could be read from it."""
    next_job_id: int = 1
    error: str | None = None
    """Why the newest job failed."""
    references: "ReferenceKeeping | None" = None
    """How what is learned is kept for later flights; None without a site's folder."""

    @property
    def followed(self) -> ShadeMap | None:
        """The newest map, with the shade that has left the view where it is by now."""
        return self.forecast.followed or self.shade

    def newest_sun(self, settings: ForecastSettings) -> SunForecast | DueForecast | None:
        """Return the forecast from the newest map, or what it is made of; None without a map."""
        if self.sun is not None or self.shade is None:
            return self.sun
        return DueForecast(self.forecast, settings)


@dataclass(frozen=True, slots=True)
class ReferenceKeeping:
    """Where sunlit references are written, and what came of it."""

    folder: Path
    found: tuple[SunlitReference, ...] = ()
    """References found in earlier flights."""
    due_ns: int = 0
    """The next ones are written with the first shade map taken at this time or later."""
    next_job_id: int = 1
    problem: str = ""
    """Why the newest one could not be written; empty if it was."""
    unreadable: tuple[str, ...] = ()
    """A sentence for each file of an earlier flight that was not read."""
