"""A survey: region, height, overlap, budget; and its progress."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum
from math import nan, radians, tan
from types import MappingProxyType

from recon.model.airspace import Region
from recon.model.flown_before import FlownCells, KeptLattice
from recon.model.geo import LatLon
from recon.model.mission import Mission


@dataclass(frozen=True, slots=True)
class SurveyCamera:
    """A camera that looks straight down from a gimbal, its longer side across the flight.

    There is no shutter command and no capture report: the pilot starts an interval timer, and
    its phase is unknown.
    """

    across_deg: float = 66.0
    """Field of view across the flight direction, of a common 4:3 survey camera."""
    along_deg: float = 52.0
    interval_s: float = 2.0
    """The shortest that common apps keep up with raw images."""
    across_px: int | None = None
    """Pixels across the flight direction; None: the size of a pixel on the ground is unknown."""

    def across_m(self, height_m: float) -> float:
        """Return how wide the footprint is from a height above the ground, across the flight."""
        return 2.0 * height_m * tan(radians(self.across_deg) / 2.0)

    def along_m(self, height_m: float) -> float:
        """Return how long the footprint is from a height above the ground, along the flight."""
        return 2.0 * height_m * tan(radians(self.along_deg) / 2.0)

    def gsd_m(self, height_m: float) -> float | None:
        """Return the size of a pixel on the ground from a height, straight below; None: unknown."""
        return None if self.across_px is None else self.across_m(height_m) / self.across_px


@dataclass(frozen=True, slots=True)
class SurveyBudget:
    """Limits after which a survey ends incomplete; None: no limit."""

    rounds: int = 6
    """Most rounds of flights over missing ground, the first included, for planners with rounds."""
    time_s: float | None = None
    """Time from the start to the beginning of the last flight, pauses included."""
    flown_m: float | None = None
    """Total planned length of all missions: a battery budget as a distance."""


class WhenDone(Enum):
    """What a survey's vehicles do when nothing is left to fly."""

    RETURN_HOME = "return_home"
    """Return home in layers and land, also when the battery lasts for no further row."""
    HOVER = "hover"
    """Hover until commanded otherwise."""


class RowChoice(Enum):
    """Which rows a survey of a region gets that has been surveyed before."""

    AUTO = "auto"
    """Those of the last survey if nothing differs, else new ones."""
    AS_BEFORE = "as_before"
    """Those of the last survey, whatever differs."""
    NEW = "new"


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """A survey request; `region` is in east-north metres of the site's local frame.

    Exactly one height is given. Above each vehicle's own takeoff point, footprints are worked out
    as if the ground lay as low as that point everywhere; above the ground, rows follow the site's
    elevation model.
    """

    id: int
    name: str
    region: Region
    height_above_takeoff_m: float | None
    speed_mps: float
    camera: SurveyCamera = SurveyCamera()
    front_overlap: float = 0.7
    """The share of a footprint that the next photo of the same row shows again."""
    side_overlap: float = 0.6
    """The share of a footprint that the next row shows again."""
    row_bearing_deg: float | None = None
    """Clockwise from north; None: the one with the fewest turns."""
    planner: str = "lawnmower_once"
    budget: SurveyBudget = SurveyBudget()
    counts_neighbours: bool = False
    """Whether a cell also counts as imaged from a neighbouring row. A mosaic needs nearly vertical
    views; for counting or inspection any photo will do."""
    cell_m: float = 4.0
    """Progress is kept in cells of this size: finer than shadows' edges are known."""
    when_done: WhenDone = WhenDone.RETURN_HOME
    side_step_allowed: bool = False
    """Whether the imaging drone may side-step automatically while light is mostly unknown."""
    upwind_allowed: bool = False
    """Whether the imaging drone may fly to where it sees more of the shade to come."""
    relief_allowed: bool = False
    """Whether the imaging drone may be relieved, or recalled, when its battery is low."""
    spare_serial: str | None = None
    """The imaging drone that relieves it then; it takes off if the start allowed takeoff."""
    height_above_ground_m: float | None = None
    region_name: str | None = None
    """The site's name of the region; None for a drawn one, of which nothing is kept."""
    lattice: KeptLattice | None = None
    """The rows of an earlier survey, to be flown again; None: new ones."""
    flown: FlownCells | None = None
    """The cells that an earlier survey has imaged and this one leaves out; None: all are flown."""
    rows_note: str = ""
    """Whose rows these are, or why they are new, for operators."""

    @property
    def height_m(self) -> float:
        """The height that is given, above the ground or above takeoff; NaN without any."""
        above_takeoff_m, above_ground_m = self.height_above_takeoff_m, self.height_above_ground_m
        given_m = above_takeoff_m if above_ground_m is None else above_ground_m
        return nan if given_m is None else given_m

    @property
    def is_above_ground(self) -> bool:
        """Whether its height is above the ground under the aircraft, not above takeoff."""
        return self.height_above_ground_m is not None

    @property
    def height_text(self) -> str:
        """Its height with its reference, for operators."""
        return height_text(self.height_above_takeoff_m, self.height_above_ground_m)


def height_text(height_above_takeoff_m: float | None, height_above_ground_m: float | None) -> str:
    """Return a survey's height with its reference, for operators; one of them is given."""
    if height_above_ground_m is not None:
        return f"{height_above_ground_m:g} m above ground"
    return (
        "no height"
        if height_above_takeoff_m is None
        else f"{height_above_takeoff_m:g} m above takeoff"
    )


class SurveyPhase(Enum):
    """Life cycle of a survey."""

    CREATED = "created"
    RUNNING = "running"
    PAUSED = "paused"
    ABORTED = "aborted"
    DONE = "done"

    @property
    def is_final(self) -> bool:
        """Whether the survey never flies again."""
        return self in (SurveyPhase.ABORTED, SurveyPhase.DONE)


def unknown_survey(survey_id: int, known: Iterable[tuple[int, str, str]]) -> str:
    """Return the sentence for an unknown survey id; `known` are (id, name, phase)."""
    there = ", ".join(f"{number} {name} ({phase})" for number, name, phase in known)
    return f"Survey {survey_id} not found; " + (
        f"available: {there}" if there else "no survey was created yet"
    )


class CellState(IntEnum):
    """Progress of one cell; it never decreases."""

    NOT_YET = 0
    """No photo certainly shows it."""
    IN_SHADE = 1
    """A photo certainly shows it, but none certainly in sun."""
    IN_SUN = 2
    """A photo certainly shows it in sun."""


PLANNER_GOALS: Mapping[str, CellState] = MappingProxyType(
    {
        "lawnmower_once": CellState.IN_SHADE,
        "lawnmower_again": CellState.IN_SUN,
        "sunlit_first": CellState.IN_SUN,
        "lawnmower_waits": CellState.IN_SUN,
        "nearest_sunlit": CellState.IN_SUN,
    }
)
"""The state up to which each of our own planners, by name, images every cell."""


def planner_goal(planner: str) -> CellState:
    """Return the state up to which a planner images every cell; in sun for a package's own."""
    return PLANNER_GOALS.get(planner, CellState.IN_SUN)


@dataclass(frozen=True, slots=True)
class MissionAssignment:
    """A mission for one vehicle, to be judged by the gate like any order of guidance.

    `number` counts the survey's missions from 1 and identifies the mission when it ends.
    """

    serial: str
    number: int
    mission: Mission
    length_m: float
    """Length from the first waypoint to the last."""
    approach: tuple[LatLon, ...] = ()
    """Corners on the leg to the first waypoint, from where the vehicle was, round keep-out zones;
    none where it is straight or none is known."""
    straight_within_m: float | None = None
    """Largest distance to a first row that it may fly to at the rows' height. It stays there after
    the last row, since the next mission follows at once. None: always by a layer of its own."""
    stands_by: bool = False
    """Whether it only goes to its first waypoint, in its layer, and waits there."""
