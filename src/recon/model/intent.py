"""What the station last commanded a vehicle to do, to predict its path."""

from dataclasses import dataclass
from enum import Enum

from recon.model.geo import LatLon
from recon.model.mission import Mission


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
    on the way to the first). `target`, `target_height_above_takeoff_m` and `speed_mps` are set for
    STICK (for a single stick only the height). `command_id` is the order that commanded it.
    """

    commanded: Commanded = Commanded.NOTHING
    since_ns: int = 0
    command_id: int | None = None
    mission: Mission | None = None
    passed: int = 0
    target: LatLon | None = None
    target_height_above_takeoff_m: float | None = None
    speed_mps: float | None = None
