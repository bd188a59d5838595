"""What a row of the failsafe matrix consists of, and the facts that it is judged by."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from recon.model.failsafe_matrix import Activity, FailsafeCell, FailsafeCondition, Reaction
from recon.model.severity import Severity
from recon.model.units import NS_PER_S
from recon.model.vehicle import LATE_UNDER_S, VehicleState


class RelatedFinding(NamedTuple):
    """A watchdog's finding about the vehicle: severity, and since when it is made."""

    severity: Severity
    since_ns: int


NO_FINDINGS: Mapping[str, RelatedFinding] = {}


class FailsafeLimits(NamedTuple):
    """The thresholds of the rows, from the settings of the alarms that they share."""

    low_battery_fraction: float
    serious_battery_fraction: float
    strong_wind_level: int
    max_tilt_deg: float


class SharedFacts(NamedTuple):
    """What the rows of the station itself are judged by; None while the condition is absent."""

    late_since_ns: int | None = None
    """Start of the present run of late steps."""
    operator_gone_since_ns: int | None = None
    """When the last client disconnected, after one was connected for a while."""
    imager_serials: frozenset[str] = frozenset()
    """The imaging drones."""
    imager_lost_since_ns: int | None = None
    """The last telemetry of the imaging drone lost first, while one is lost in flight."""


class FlightFacts(NamedTuple):
    """One vehicle in the air, and what the station knows besides its state.

    `link_opened_at_ns` is None while it has no open link. `findings` are the watchdogs' about it,
    by rule.
    """

    vehicle: VehicleState
    now_ns: int
    link_opened_at_ns: int | None
    limits: FailsafeLimits
    station: SharedFacts = SharedFacts()
    findings: Mapping[str, RelatedFinding] = NO_FINDINGS

    @property
    def is_live(self) -> bool:
        """Whether telemetry is recent enough to tell how it flies."""
        at_ns = self.vehicle.core_received_at_ns
        return at_ns is not None and self.now_ns - at_ns < LATE_UNDER_S * NS_PER_S


Find = Callable[[FlightFacts], int | None]
"""Returns since when the condition holds for a vehicle (station time, ns); None while absent."""

OFFERED: Mapping[Activity, frozenset[Reaction]] = {
    Activity.MISSION: frozenset(Reaction),
    Activity.STEERED: frozenset(Reaction),
    Activity.HOLDING: frozenset(Reaction) - {Reaction.HOLD},
    Activity.RETURNING: frozenset(Reaction) - {Reaction.HOLD, Reaction.RETURN},
}
"""Reactions stronger than the activity: no hold while holding, only a landing while returning."""


@dataclass(frozen=True, slots=True, eq=False)
class FailsafeRow:
    """One condition: when it holds, in which words, what may be done about it, and by default.

    `reactions` are what a site may choose, with why not another; `after_s` is the delay of a
    reaction that is given without one. `find` is None where a watchdog finds the condition and
    gives the hold in its own time.
    """

    condition: FailsafeCondition
    begins: str
    """When the condition begins, in words."""
    ends: str
    """What ends it, to follow "unless"."""
    reactions: frozenset[Reaction]
    why_no_other: str
    default: Mapping[Activity, FailsafeCell]
    after_s: float
    alarm_rules: frozenset[str]
    """The alarms of the condition: their texts state the reaction."""
    find: Find | None
    fixed: Mapping[Activity, str]
    """Cells that a site cannot change, each with the reason."""
    is_ordered_on_return: bool = False
    """Nothing can be sent while it holds: the reaction is ordered when it has ended."""
    lasts_to_landing: bool = False
    """Whether it counts as the same occurrence until the landing, once something was done."""

    def offered(self, activity: Activity) -> frozenset[Reaction]:
        """Return what a site may choose in a cell."""
        if activity in self.fixed:
            return frozenset({self.default[activity].reaction})
        if self.find is None:
            return self.reactions
        return self.reactions & OFFERED[activity]

    @property
    def is_timed(self) -> bool:
        """Whether the delay is the matrix's: a watchdog that predicts has its own."""
        return self.find is not None


ORDERS = frozenset({Reaction.HOLD, Reaction.RETURN, Reaction.LAND})
NO_FIXED: Mapping[Activity, str] = {}


def cells(
    mission: FailsafeCell, steered: FailsafeCell, holding: FailsafeCell, returning: FailsafeCell
) -> Mapping[Activity, FailsafeCell]:
    """Return the cells of a row."""
    return {
        Activity.MISSION: mission,
        Activity.STEERED: steered,
        Activity.HOLDING: holding,
        Activity.RETURNING: returning,
    }


NOTHING = FailsafeCell(Reaction.NOTHING)
ALARM = FailsafeCell(Reaction.ALARM)


def hold(after_s: float = 0.0) -> FailsafeCell:
    """Return a cell that holds."""
    return FailsafeCell(Reaction.HOLD, after_s)


def recall(after_s: float = 0.0) -> FailsafeCell:
    """Return a cell that recalls."""
    return FailsafeCell(Reaction.RETURN, after_s)


def cell_words(row: FailsafeRow, cell: FailsafeCell) -> str:
    """Return a cell in words: "hold after 3 s"."""
    what = cell.reaction.value
    if not cell.reaction.is_order or not row.is_timed:
        return what
    if row.is_ordered_on_return:
        return f"{what} when back" + (f" after {cell.after_s:g} s or more" if cell.after_s else "")
    return f"{what} after {cell.after_s:g} s" if cell.after_s else f"{what} at once"
