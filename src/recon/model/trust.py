"""What is believed of a vehicle's telemetry, and why some of it is not: values kept in its state.

`fleet.trust` and `fleet.airborne` are their only writers; both have a theory of operation.
"""

from dataclasses import dataclass
from enum import Enum

from recon.model.geo import LatLon
from recon.model.units import Stamped


class DoubtKind(Enum):
    """Why telemetry is not believed."""

    GROUND_REPORT = "ground_report"
    """A report on the ground, while nothing else shows a landing."""
    FLIGHT_SIGNS = "flight_signs"
    """A report on the ground, while it moves, climbs or flies a mission."""
    JUMP = "position_jump"
    FROZEN = "frozen_telemetry"
    STANDSTILL = "position_stands_still"
    """A position that does not follow from the velocity."""
    BATTERY = "battery_doubted"


@dataclass(frozen=True, slots=True)
class Doubt:
    """One contradiction in a vehicle's telemetry, as a sentence without its name.

    `at_ns` is the last packet that shows it, `until_ns` when it ends if no other does.
    """

    kind: DoubtKind
    text: str
    since_ns: int
    at_ns: int
    until_ns: int
    count: int = 1


@dataclass(frozen=True, slots=True)
class KnownPlace:
    """The last believed position and height, each with its time; kept when one becomes unknown."""

    position: LatLon | None = None
    position_at_ns: int = 0
    height_m: float | None = None
    height_at_ns: int = 0


@dataclass(frozen=True, slots=True)
class JumpedPlace:
    """The newest of a run of packets at a place that does not follow from the believed one."""

    place: KnownPlace
    since_ns: int
    count: int = 1


@dataclass(frozen=True, slots=True)
class DeadReckoning:
    """The displacement that reported velocities add up to since the position last moved."""

    position: LatLon
    at_ns: int
    north_m: float = 0.0
    east_m: float = 0.0


@dataclass(frozen=True, slots=True)
class GroundReports:
    """A run of reports of the ground that began in flight.

    `rest_since_ns`, with height and battery of that time, is since when it has not moved.
    """

    since_ns: int
    rest_since_ns: int
    height_m: float | None
    battery_fraction: float | None
    has_moved: bool = False
    moved_at_ns: int | None = None


@dataclass(frozen=True, slots=True)
class GroundStand:
    """Position of a vehicle believed on the ground; the height follows the barometer's drift."""

    since_ns: int
    at_ns: int
    position: LatLon | None
    height_m: float | None
    signs_since_ns: int | None = None
    """Time since which it shows signs of flight."""
    quiet_since_ns: int | None = None


@dataclass(frozen=True)
class FlightEvidence:
    """What the airborne estimate remembers of a vehicle.

    `flown_at_ns` is the last report in flight, None since the last believed landing; `ground` is
    set while it has not flown since the last report on the ground.
    """

    flown_at_ns: int | None = None
    flown_height_m: float | None = None
    battery_fraction: float | None = None
    """Battery charge at the last report in flight."""
    high_m: float | None = None
    """Greatest height of this half minute, and of the one before."""
    older_high_m: float | None = None
    high_since_ns: int = 0
    landing_at_ns: int | None = None
    """The last report in flight in a landing mode, and the height this landing began at."""
    landing_from_m: float | None = None
    slow_since_ns: int | None = None
    reports: GroundReports | None = None
    ground: GroundStand | None = None


@dataclass(frozen=True)
class Trust:
    """A vehicle's doubts, one per kind, and what the next packet is judged by."""

    doubts: tuple[Doubt, ...] = ()
    evidence: FlightEvidence = FlightEvidence()
    place: KnownPlace = KnownPlace()
    jumped: JumpedPlace | None = None
    jump_accepted_at_ns: int | None = None
    """Time at which a place after a jump was last accepted as the new one."""
    changed_at_ns: int | None = None
    """Time at which core telemetry last differed from the packet before it."""
    reckoning: DeadReckoning | None = None
    battery: Stamped[float] = Stamped()
    """A charge of the last seconds, which a sudden fall is compared with."""
    not_before_ns: int | None = None
    """Core telemetry received before this is from before a suspension of the station."""

    def doubt(self, kind: DoubtKind) -> Doubt | None:
        """Return the doubt of a kind, if there is one."""
        return next((doubt for doubt in self.doubts if doubt.kind is kind), None)


NO_TRUST = Trust()
"""Trust of a vehicle that has not reported yet."""
