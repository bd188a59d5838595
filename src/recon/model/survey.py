"""A survey: which region is to be imaged, from where, how dense; and how far it has come."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum, IntEnum
from math import radians, tan

from recon.model.mission import Mission
from recon.model.zone import Region


@dataclass(frozen=True, slots=True)
class SurveyCamera:
    """A camera that looks straight down from a gimbal, its longer side across the flight.

    There is no shutter command and no capture report: the pilot starts an interval timer, and
    when within the interval it fires is not known.
    """

    across_deg: float = 66.0
    """Field of view across the flight direction, of a common 4:3 survey camera."""
    along_deg: float = 52.0
    interval_s: float = 2.0
    """The shortest that common apps keep up with raw images."""

    def across_m(self, height_m: float) -> float:
        """Return how wide the footprint is from a height above the ground, across the flight."""
        return 2.0 * height_m * tan(radians(self.across_deg) / 2.0)

    def along_m(self, height_m: float) -> float:
        """Return how long the footprint is from a height above the ground, along the flight."""
        return 2.0 * height_m * tan(radians(self.along_deg) / 2.0)


@dataclass(frozen=True, slots=True)
class SurveyBudget:
    """When a survey ends although it is not done; None: never for that reason."""

    rounds: int = 6
    """Of flights over what is missing; the first round counts."""
    time_s: float | None = None
    """From the start to the beginning of the last flight, pauses included."""
    flown_m: float | None = None
    """Planned metres of all missions together: batteries, said as a way."""


class WhenDone(Enum):
    """What a survey's vehicles do when there is nothing more for them to fly."""

    RETURN_HOME = "return_home"
    """They fly home in layers and land: when it is done, or no battery lasts for a row."""
    HOVER = "hover"
    """They stay where they are until somebody orders something."""


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """What is asked for; `region` is in east-north metres of the site's local frame.

    The height is above each vehicle's own takeoff point; footprints are worked out as if the
    ground lay as low as that point everywhere.
    """

    id: int
    name: str
    region: Region
    height_above_takeoff_m: float
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
    """Whether a place counts as imaged from a neighbouring row too. A mosaic is made of what was
    seen from nearly above; for counting or looking any photo does."""
    cell_m: float = 4.0
    """Progress is kept in cells of this size: finer than shadows' edges are known."""
    when_done: WhenDone = WhenDone.RETURN_HOME


class SurveyPhase(Enum):
    """Where a survey is in its life."""

    CREATED = "created"
    RUNNING = "running"
    PAUSED = "paused"
    ABORTED = "aborted"
    DONE = "done"

    @property
    def is_final(self) -> bool:
        """Whether it never flies again."""
        return self in (SurveyPhase.ABORTED, SurveyPhase.DONE)


def none_such(survey_id: int, known: Iterable[tuple[int, str, str]]) -> str:
    """Return the sentence for a survey that is not there; `known` are (id, name, phase)."""
    there = ", ".join(f"{number} {name} ({phase})" for number, name, phase in known)
    return f"there is no survey {survey_id}; " + (
        f"there are: {there}" if there else "none was created"
    )


class CellState(IntEnum):
    """How far one cell has come; it only ever rises."""

    NOT_YET = 0
    """No photo shows it for sure."""
    IN_SHADE = 1
    """A photo shows it for sure, but none for sure in sun."""
    IN_SUN = 2
    """A photo shows it for sure, and it was in sun then."""


@dataclass(frozen=True, slots=True)
class MissionFor:
    """A mission for one vehicle, to go through the gate like any order of guidance.

    `number` counts the survey's missions from 1: whoever flies it tells it back when it has ended.
    """

    serial: str
    number: int
    mission: Mission
    length_m: float
    """From the first waypoint to the last."""
