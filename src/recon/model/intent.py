"""What the station last told a vehicle to do, so that its path can be foreseen."""

from dataclasses import dataclass
from enum import Enum

from recon.model.geo import LatLon
from recon.model.mission import Mission


class Commanded(Enum):
    """The state a vehicle was commanded into."""

    NOTHING = "nothing"
    """The station has told it nothing since it took off, was restarted, or let go of it."""
    HOLD = "hold"
    MISSION = "mission"
    STICK = "stick"
    """A stream of sticks towards a place."""
    RETURN = "return"
    LAND = "land"


@dataclass(frozen=True, slots=True)
class Intent:
    """What a vehicle is doing on the station's word.

    `mission` is set for MISSION: the part it was last sent, of which it has passed the first
    `passed` waypoints (0: on its way to the first). `target`, `target_height_above_takeoff_m` and
    `speed_mps` are set for STICK (of a single stick the height alone). `command_id` is the order
    behind it.
    """

    commanded: Commanded = Commanded.NOTHING
    since_ns: int = 0
    command_id: int | None = None
    mission: Mission | None = None
    passed: int = 0
    target: LatLon | None = None
    target_height_above_takeoff_m: float | None = None
    speed_mps: float | None = None
