"""Control of a vehicle: who may command it, and what the station last commanded.

Transfers of authority are explicit. The intent is for predicting the path.
"""

from dataclasses import dataclass
from enum import Enum

from recon.model.geo import LatLon
from recon.model.mission import Mission


class AuthorityHolder(Enum):
    """The party that may set a vehicle in motion. Any party may stop it."""

    PILOT = "pilot"
    """The person with the controller; the station stops commanding."""
    OPERATOR = "operator"
    """A user or a program at the station."""
    GUIDANCE = "guidance"
    """The station's own planning."""


@dataclass(frozen=True, slots=True)
class ControlAuthority:
    """The authority holder of a vehicle, since when, and why."""

    holder: AuthorityHolder = AuthorityHolder.OPERATOR
    holder_name: str = ""
    since_ns: int = 0
    reason: str = "not yet transferred"


@dataclass(frozen=True, slots=True)
class OperatorLease:
    """The person who operates a vehicle, by name; since when, and the last order to move it."""

    person: str
    since_ns: int
    ordered_at_ns: int


@dataclass(frozen=True, slots=True)
class StopLatch:
    """An all stop in force: nothing sets a vehicle in motion until a person releases it.

    It holds vehicles that connect later too. `released` are the serials released since.
    """

    by: str
    at_ns: int
    released: frozenset[str] = frozenset()

    def holds(self, serial: str | None) -> bool:
        """Whether a vehicle is latched; a link without a serial always is."""
        return serial is None or serial not in self.released


class Commanded(Enum):
    """The state a vehicle was commanded into."""

    NOTHING = "nothing"
    """Nothing commanded since takeoff, a restart, or the end of the last order."""
    HOLD = "hold"
    MISSION = "mission"
    STICK = "stick"
    """A setpoint stream towards a target."""
    RETURN = "return"
    LAND = "land"


@dataclass(frozen=True, slots=True)
class Intent:
    """What a vehicle is doing by command of the station.

    `mission` is set for MISSION: the part last sent, with its first `passed` waypoints flown (0:
    on the leg to the first); for STICK, the path that is steered, if any. `target`,
    `target_height_above_takeoff_m` and `speed_mps` are set for STICK (for a single stick only the
    height). `command_id` is the order that commanded it.
    """

    commanded: Commanded = Commanded.NOTHING
    since_ns: int = 0
    command_id: int | None = None
    mission: Mission | None = None
    passed: int = 0
    target: LatLon | None = None
    target_height_above_takeoff_m: float | None = None
    speed_mps: float | None = None
