"""One flight as any program may fly it: waypoints, photos, and what happens at its end."""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property

from recon.model.errors import ReconError
from recon.model.geo import LatLon
from recon.model.mission import Waypoint


class PlanExportError(ReconError):
    """A plan that a format or an aircraft cannot hold; one sentence with what to do."""


class AtEnd(Enum):
    """What the aircraft does after its last waypoint."""

    RETURN_HOME = "return home"
    LAND = "land where it is"
    HOVER = "hover"


@dataclass(frozen=True, slots=True)
class PhotoTrigger:
    """Photos from the first waypoint to the last, at equal times or at equal distances.

    Raises `ValueError` unless exactly one of the two is given, above 0.
    """

    every_s: float | None = None
    every_m: float | None = None

    def __post_init__(self) -> None:
        given = [each for each in (self.every_s, self.every_m) if each is not None]
        if len(given) != 1 or not given[0] > 0.0:
            raise ValueError(f"expected seconds or metres above 0 between photos, got {given}")

    def distance_m(self, speed_mps: float) -> float:
        """Return the distance between two photos at a speed."""
        return self.every_m if self.every_m is not None else (self.every_s or 0.0) * speed_mps


@dataclass(frozen=True, slots=True)
class RowGround:
    """The rows of a flight as an area: `rings` are polygons without holes, not closed.

    `photo_m` is the distance between photos along a row, `row_m` that between rows.
    """

    rings: tuple[tuple[LatLon, ...], ...]
    bearing_deg: float
    photo_m: float
    row_m: float


@dataclass(frozen=True)
class ExportedPlan:
    """One flight of one aircraft. Heights are above its takeoff point; speeds hold from a waypoint
    to the next. On a lost signal the aircraft returns home, wherever the format can say so.

    `rows` are the first and the last waypoint of each row: a flight may be cut between them only.
    """

    title: str
    """Of the whole survey."""
    name: str
    """Of this flight, such as "drone 1, flight 2"."""
    waypoints: tuple[Waypoint, ...]
    photos: PhotoTrigger | None = None
    at_end: AtEnd = AtEnd.RETURN_HOME
    curved: bool = False
    rows: tuple[tuple[int, int], ...] = ()
    takeoff: LatLon | None = None
    takeoff_ellipsoid_height_m: float | None = None
    """None: unknown; then nothing is written that needs it."""
    ground: RowGround | None = None

    @cached_property
    def heights_m(self) -> tuple[float, float]:
        """The lowest and the highest height above takeoff of the waypoints."""
        heights_m = [each.height_above_takeoff_m for each in self.waypoints]
        return min(heights_m), max(heights_m)

    @property
    def is_level(self) -> bool:
        """Whether all waypoints have the same height above takeoff, to a centimetre."""
        lowest_m, highest_m = self.heights_m
        return highest_m - lowest_m < 0.01


def shown(name: str) -> str:
    """Return a name without control characters, which no XML can have."""
    return "".join(each for each in name if each.isprintable())


def plan_fault(plan: ExportedPlan) -> str | None:
    """Return why no program could fly a plan, as a sentence; None when one can."""
    if len(plan.waypoints) < 2:
        return f"{plan.name}: expected at least 2 waypoints, got {len(plan.waypoints)}"
    for number, each in enumerate(plan.waypoints, start=1):
        numbers = (
            ("latitude", each.latitude_deg, -90.0, 90.0, "degrees"),
            ("longitude", each.longitude_deg, -180.0, 180.0, "degrees"),
            ("height above takeoff", each.height_above_takeoff_m, -200.0, 1_500.0, "m"),
            ("speed", each.speed_mps, 0.1, 15.0, "m/s"),
            ("loiter", each.loiter_s or 0.0, 0.0, 3_600.0, "s"),
            ("gimbal pitch", each.gimbal_pitch_deg or 0.0, -90.0, 0.0, "degrees"),
        )
        for what, value, least, most, unit in numbers:
            # Written so that NaN is refused too.
            if not least <= value <= most:
                return (
                    f"{plan.name}, waypoint {number}: expected a {what} of {least:g} to {most:g} "
                    f"{unit}, got {value:g}"
                )
    return None
