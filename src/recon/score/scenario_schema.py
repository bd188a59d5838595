"""The keys of a scenario file, with the ranges and descriptions that error messages quote."""

from datetime import datetime
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

import msgspec
from msgspec import Meta

from recon.detection import DETECTORS
from recon.forecast import FORECASTERS
from recon.guidance.survey import PLANNERS
from recon.score.scenario import IDEAL, NO_FORECAST

METHOD_NAMES = {
    "detection": (IDEAL, *DETECTORS),
    "forecast": (NO_FORECAST, *FORECASTERS),
    "planner": tuple(PLANNERS),
}
"""The values of `[methods]`."""

if TYPE_CHECKING:
    DetectionName: TypeAlias = str
    ForecastName: TypeAlias = str
    PlannerName: TypeAlias = str
else:  # the registries are known at run time only
    DetectionName = Literal[METHOD_NAMES["detection"]]
    ForecastName = Literal[METHOD_NAMES["forecast"]]
    PlannerName = Literal[METHOD_NAMES["planner"]]

Metres = Annotated[float, Meta(ge=-50_000.0, le=50_000.0)]
Share = Annotated[float, Meta(ge=0.0, le=0.95)]
PlacePair = Annotated[
    list[Metres], Meta(min_length=2, max_length=2, description="[east, north] in metres")
]
Ring = Annotated[list[PlacePair], Meta(min_length=3, description="3 places or more")]


class Table(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """A table that refuses unknown keys."""


class ScenarioSiteTable(Table, frozen=True):
    """A site's folder, relative to the scenario file; or the origin of a generated site."""

    folder: Annotated[str, Meta(min_length=1, description="a folder's name")] | None = None
    latitude_deg: Annotated[float, Meta(ge=-89.0, le=89.0)] | None = None
    longitude_deg: Annotated[float, Meta(ge=-180.0, le=180.0)] | None = None
    ground_altitude_m: Annotated[float, Meta(ge=-500.0, le=6000.0)] | None = None
    relief_m: Annotated[float, Meta(ge=0.0, le=60.0)] = 0.0


class TaskTable(Table, frozen=True):
    """The survey's task; the region is in east-north metres of the site."""

    region_m: Ring
    limit_min: Annotated[float, Meta(ge=1.0, le=600.0)]
    holes_m: list[Ring] = []
    height_m: Annotated[float, Meta(ge=1.0, le=500.0)] = 60.0
    speed_mps: Annotated[float, Meta(ge=0.5, le=15.0)] = 8.0
    front_overlap: Share = 0.7
    side_overlap: Share = 0.6
    photo_interval_s: Annotated[float, Meta(ge=0.1, le=60.0)] = 2.0
    rounds: Annotated[int, Meta(ge=1, le=100)] = 20


class FleetTable(Table, frozen=True):
    """The survey drones; without pads they start from a line south of the region.

    With a site's folder they are its SIM-1, SIM-2, ... and start from its pads.
    """

    survey_drones: Annotated[int, Meta(ge=1, le=16)]
    pads_m: list[PlacePair] | None = None
    endurance_min: Annotated[float, Meta(ge=3.0, le=120.0)] = 25.0
    reserve_share: Share = 0.2
    swap_min: Annotated[float, Meta(ge=0.0, le=60.0)] = 3.0


class ScenarioImagerTable(Table, frozen=True):
    """The imaging drone; by default it hovers 120 m above the middle of the region.

    With a site's folder it hovers where the site's marked frame was taken.
    """

    over_m: PlacePair | None = None
    height_m: Annotated[float, Meta(ge=10.0, le=500.0)] | None = None
    radius_m: Annotated[float, Meta(ge=20.0, le=2000.0)] = 300.0
    period_s: Literal[1, 2, 5] = 5
    cell_m: Annotated[float, Meta(ge=1.0, le=50.0)] = 4.0


class MethodsTable(Table, frozen=True):
    """The methods of detection, forecast and planning."""

    detection: DetectionName = "ideal"
    forecast: ForecastName = "global_shift"
    planner: PlannerName = "lawnmower_again"


class ShiftTable(Table, frozen=True):
    """The clouds' velocity changes linearly into another one."""

    start_s: float
    duration_s: float
    speed_mps: float
    heading_deg: float


class CloudsTable(Table, frozen=True):
    """One cloud layer; the sky's settings check the ranges."""

    cover: float
    base_height_m: float = 1_400.0
    speed_mps: float = 7.5
    heading_deg: float = 70.0
    spectral_slope: float = 3.4
    outer_scale_m: float = 12_000.0
    softness: float = 0.28
    largest_optical_depth: float = 20.0
    lifetime_s: float = 900.0
    modulation: float = 0.5
    shifts: list[ShiftTable] = []


class WindTable(Table, frozen=True):
    """Wind near the ground."""

    speed_10m_mps: float = 3.5
    heading_deg: float = 50.0
    gust_intensity: float = 0.2


class ScenarioFile(Table, frozen=True):
    """The whole file."""

    about: Annotated[str, Meta(min_length=1, description="a sentence")]
    start_utc: Annotated[datetime, Meta(tz=True, description="a moment like 2025-06-20T16:00:00Z")]
    site: ScenarioSiteTable
    task: TaskTable
    fleet: FleetTable
    imager: ScenarioImagerTable = ScenarioImagerTable()
    methods: MethodsTable = MethodsTable()
    clouds: list[CloudsTable] = []
    wind: WindTable = WindTable()
    faults: list[str] = []
    fault_file: Annotated[str, Meta(min_length=1, description="a file's name")] | None = None
