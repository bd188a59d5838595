"""The keys of a scenario file, and its errors, with file and line.

Messages quote the ranges and descriptions of the keys. The standard library's TOML parser reports
no lines for values: `key_lines` finds those of keys.
"""

import re
from collections import Counter
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias, TypeVar

import msgspec
from msgspec import Meta

from recon.camera.sight import COARSEST_M
from recon.detection import DETECTORS
from recon.forecast import FORECASTERS
from recon.guidance.survey import PLANNERS
from recon.guidance.survey.settings import DEFAULT as SURVEY_DEFAULT
from recon.model.errors import ReconError
from recon.score.scenario import IDEAL, NO_FORECAST, PERFECT
from recon.sim.errors import SimulationError

METHOD_NAMES = {
    "detection": (IDEAL, *DETECTORS),
    "forecast": (NO_FORECAST, PERFECT, *FORECASTERS),
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


RANGE = "a number or [lowest, highest]"
RangeValue = Annotated[float | list[float], Meta(description=RANGE)]


class Table(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """A table that refuses unknown keys."""


class ScenarioSiteTable(Table, frozen=True):
    """A site's folder, relative to the scenario file, or `recon:demo`, the demonstration's; or the
    origin of a generated site."""

    folder: Annotated[str, Meta(min_length=1, description="a folder's name")] | None = None
    latitude_deg: Annotated[float, Meta(ge=-89.0, le=89.0)] | None = None
    longitude_deg: Annotated[float, Meta(ge=-180.0, le=180.0)] | None = None
    ground_altitude_m: Annotated[float, Meta(ge=-500.0, le=6000.0)] | None = None


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
    side_step: bool = True
    """The operator allows the imaging drone to side-step automatically."""
    upwind: bool = False
    """The operator allows the imaging drone to move upwind automatically."""


class FleetTable(Table, frozen=True):
    """The survey drones; without pads they start from a line south of the region.

    With a site's folder they are its SIM-1, SIM-2, ... and start from its pads.
    """

    survey_drones: Annotated[int, Meta(ge=1, le=16)]
    pads_m: list[PlacePair] | None = None
    endurance_min: Annotated[float, Meta(ge=3.0, le=120.0)] = 25.0
    reserve_share: Share = 0.2
    swap_min: Annotated[float, Meta(ge=0.0, le=60.0)] = 3.0
    kept_share: Share = SURVEY_DEFAULT.battery_kept_fraction
    """A battery that is this full at landing is not changed."""
    takes_missions: bool = True
    """False: the station steers them along their rows, and they take off with a hover."""


class ScenarioImagerTable(Table, frozen=True):
    """The imaging drone; by default it hovers 120 m above the middle of the region.

    With a site's folder it hovers where the site's marked frame was taken.
    """

    over_m: PlacePair | None = None
    also_over_m: Annotated[list[PlacePair], Meta(max_length=3)] = []
    """Places of further imaging drones, on a generated site."""
    height_m: Annotated[float, Meta(ge=10.0, le=120.0)] | None = None
    """Height of at most what drones may fly in most countries."""
    field_deg: Annotated[float, Meta(ge=30.0, le=85.0)] | None = None
    """Field of a generated site's lens, from its axis: 66, as that of real ones."""
    tilt_deg: Annotated[float, Meta(ge=0.0, le=60.0)] | None = None
    """Tilt of a generated site's camera, from straight down to the front."""
    coarsest_m: Annotated[float, Meta(ge=0.1, le=100.0)] = COARSEST_M
    """Ground that a pixel may show, for ideal detection to see it."""
    upwind: bool = False
    """The operator has it hover where it sees most of the shade to come."""
    radius_m: Annotated[float, Meta(ge=20.0, le=2000.0)] = 300.0
    """Radius of the scored ground, if the lens shows as much."""
    reach_m: Annotated[float, Meta(ge=20.0, le=2000.0)] | None = None
    """Reach of a generated site's shade maps, from its first hover place; by default `radius_m`."""
    cell_m: Annotated[float, Meta(ge=1.0, le=50.0)] = 4.0
    """Cell size of shade maps and their score; larger for more ground."""


class MethodsTable(Table, frozen=True):
    """The methods of detection, forecast and planning."""

    detection: DetectionName = "ideal"
    forecast: ForecastName = "advection"
    planner: PlannerName = "lawnmower_again"


class ShiftTable(Table, frozen=True):
    """The clouds' velocity changes linearly into another one."""

    start_s: float
    duration_s: float
    speed_mps: float
    turn_deg: Annotated[float, Meta(ge=-180.0, le=180.0)]
    """Clockwise from the heading before."""


class CloudsTable(Table, frozen=True):
    """One cloud layer; the sky's settings check the ranges.

    Speed, heading and veer are a number or [lowest, highest], drawn by the seed. The other usual
    values are those of measured broken clouds, to which they were fitted (docs/world.md).
    """

    cover: float
    base_height_m: float = 1_400.0
    speed_mps: RangeValue | None = None
    """5 to 11 m/s."""
    heading_deg: RangeValue | None = None
    """Heading of the lowest layer; any."""
    veer_deg: RangeValue | None = None
    """Veer of a layer above, clockwise from the heading of the one below; 25 to 70 degrees."""
    spectral_slope: float = 2.91
    outer_scale_m: float = 12_000.0
    finest_scale_m: float = 125.0
    softness: float = 0.5
    largest_optical_depth: float = 20.0
    lifetime_s: float = 1_100.0
    modulation: float = 1.0
    modulation_s: float = 1_800.0
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
    conditions: dict[str, object] = {}
    """Checked by `scenario_conditions.py`: the keys are the fields of `ConditionRanges`."""
    faults: list[str] = []
    fault_file: Annotated[str, Meta(min_length=1, description="a file's name")] | None = None


Made = TypeVar("Made")

PLACE = re.compile(r"((?:\w+(?:\[\d+\])*\.?)+): expected")
UNKNOWN = re.compile(r"expected only the keys .*, got '(\w+)'")
HEADER = re.compile(r"\s*(\[\[?)\s*([\w.\"'\- ]+?)\s*\]\]?\s*(?:#.*)?$")
KEY = re.compile(r"\s*([\w.\"'\-]+)\s*=(.*)$")
QUOTED = re.compile(r'"(?:\\.|[^"\\])*"|\'[^\']*\'')


class ScenarioError(ReconError):
    """A scenario cannot be read or flown; the message has file, line, expected and actual value."""


class ScenarioErrors:
    """Makes errors that name the file and the line of a key."""

    def __init__(self, path: Path, lines: Mapping[str, int]) -> None:
        self._path, self._lines = path, lines

    def error(self, text: str, within: str = "") -> ScenarioError:
        """Return the error for a text that starts with a key, relative to the table `within`."""
        place = PLACE.match(text)
        key = place[1] if place else ""
        unknown = UNKNOWN.search(text)
        path = ".".join(part for part in (within, key, unknown[1] if unknown else "") if part)
        line = line_of(self._lines, path)
        where = f"{self._path}:{line}" if line is not None else f"{self._path}"
        lead = within + ("." if place else ": ") if within else ""
        return ScenarioError(f"{where}: {lead}{text}")

    def made(self, within: str, make: Callable[[], Made]) -> Made:
        """Return `make()`; a `SimulationError` of it becomes an error of the table `within`."""
        try:
            return make()
        except SimulationError as problem:
            text = str(problem).removeprefix("wind: ").removeprefix("wind shift: ")
            raise self.error(text, within) from problem


def key_lines(text: str) -> Mapping[str, int]:
    """Return the line, from 1, of each table and key: `clouds[1].cover`, `task.region_m`.

    For text that `tomllib` accepts. A value over several lines counts as its first line.
    """
    lines: dict[str, int] = {}
    counts: Counter[str] = Counter()
    table, depth = "", 0
    for number, line in enumerate(text.splitlines(), start=1):
        if depth == 0 and (header := HEADER.match(line)):
            table = _bare(header[2])
            if header[1] == "[[":
                counts[table] += 1
                lines.setdefault(table, number)
                table = f"{table}[{counts[table] - 1}]"
            lines[table] = number
        elif depth == 0 and (key := KEY.match(line)):
            path = _bare(key[1])
            lines[f"{table}.{path}" if table else path] = number
            depth = max(0, depth + _opened(key[2]))
        else:
            depth = max(0, depth + _opened(line))
    return MappingProxyType(lines)


def line_of(lines: Mapping[str, int], path: str) -> int | None:
    """Return the line of a key or of the nearest key around it; None without one."""
    while path:
        if path in lines:
            return lines[path]
        path = path[: max(path.rfind("."), path.rfind("["), 0)]
    return None


def _bare(key: str) -> str:
    return re.sub(r"[\"'\s]", "", key)


def _opened(value: str) -> int:
    """How many more brackets a line opens than it closes, outside strings and comments."""
    bare = QUOTED.sub("", value).split("#")[0]
    return sum(bare.count(each) for each in "[{") - sum(bare.count(each) for each in "]}")
