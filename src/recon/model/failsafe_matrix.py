"""The failsafe matrix: what the station does about a condition, by what the vehicle is doing.

Not to be confused with `model.vehicle.Failsafe`, which is what the aircraft does on its own when it
loses its controller. The rows and their defaults are in `safety/failsafe/`, one file each.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum


class FailsafeCondition(Enum):
    """A condition that the matrix has a row for."""

    LINK_LOST = "link_lost"
    TELEMETRY_LOST = "telemetry_lost"
    GNSS_LOST = "gnss_lost"
    BATTERY_LOW = "battery_low"
    BATTERY_CRITICAL = "battery_critical"
    WIND = "wind"
    ATTITUDE = "attitude"
    GEOFENCE = "geofence"
    SEPARATION = "separation"
    IMAGING_DRONE_LOST = "imaging_drone_lost"
    STATION_OVERLOADED = "station_overloaded"
    OPERATOR_GONE = "operator_gone"

    @property
    def words(self) -> str:
        """The condition in words."""
        return self.value.replace("_", " ").replace("gnss", "GNSS")


class Activity(Enum):
    """What a vehicle in the air is doing: a column of the matrix."""

    MISSION = "mission"
    STEERED = "steered"
    """Moved by sticks of the station: goto, nudge, hold position, a single stick."""
    HOLDING = "holding"
    """It hovers, or nothing that the station commanded moves it."""
    RETURNING = "returning"
    """Returning home or landing: by order, in a fleet return, or by its own failsafe."""


class Reaction(Enum):
    """What the station does, the weakest first."""

    NOTHING = "nothing"
    ALARM = "alarm"
    HOLD = "hold"
    RETURN = "return"
    LAND = "land"

    @property
    def rank(self) -> int:
        """0 for the weakest."""
        return tuple(Reaction).index(self)

    @property
    def is_order(self) -> bool:
        """Whether something is sent to the vehicle."""
        return self in (Reaction.HOLD, Reaction.RETURN, Reaction.LAND)


@dataclass(frozen=True, slots=True)
class FailsafeCell:
    """One reaction, and how long its condition must have held before it is ordered."""

    reaction: Reaction
    after_s: float = 0.0

    def is_weaker_than(self, other: "FailsafeCell") -> bool:
        """Return whether this does less, or the same later."""
        if self.reaction is not other.reaction:
            return self.reaction.rank < other.reaction.rank
        return self.reaction.is_order and self.after_s > other.after_s


Row = Mapping[Activity, FailsafeCell]


@dataclass(frozen=True, slots=True)
class FailsafeMatrix:
    """The cells by condition and activity: every cell is defined."""

    rows: Mapping[FailsafeCondition, Row]

    def __post_init__(self) -> None:
        for condition in FailsafeCondition:
            if set(self.rows.get(condition, ())) != set(Activity):
                raise ValueError(f"expected a cell for each activity in {condition.value}")

    def cell(self, condition: FailsafeCondition, activity: Activity) -> FailsafeCell:
        """Return one cell."""
        return self.rows[condition][activity]

    def differences(
        self, other: "FailsafeMatrix"
    ) -> Iterator[tuple[FailsafeCondition, Activity, FailsafeCell, FailsafeCell]]:
        """Yield the cells that differ from another matrix: this one's and the other's."""
        for condition, row in self.rows.items():
            for activity, cell in row.items():
                theirs = other.cell(condition, activity)
                if cell != theirs:
                    yield condition, activity, cell, theirs
