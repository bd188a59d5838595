"""PX4's flight mode numbers, which every client of MAVLink knows, for DJI's modes and for orders.

The gateway calls its vehicles PX4 for these numbers alone: the generic autopilot has no modes, and
clients then offer neither hold nor return.
"""

from recon.gateway.mavlink.dialect import mavlink
from recon.model.command import Body, Hover, LandNow, ReturnHome

AUTO = 4
TAKEOFF, LOITER, MISSION, RETURN, LAND = 2, 3, 4, 5, 6
"""Sub-modes of AUTO."""
MANUAL, POSITION, OFFBOARD = (1, 0), (3, 0), (6, 0)
HOLD = (AUTO, LOITER)

_OF_DJI = {
    "manual": MANUAL,
    "atti": MANUAL,
    "atti_course_lock": MANUAL,
    "gps_atti": HOLD,
    "gps_novice": HOLD,
    "assisted_takeoff": (AUTO, TAKEOFF),
    "auto_takeoff": (AUTO, TAKEOFF),
    "motors_just_started": (AUTO, TAKEOFF),
    "auto_landing": (AUTO, LAND),
    "confirm_landing": (AUTO, LAND),
    "gps_waypoint": (AUTO, MISSION),
    "go_home": (AUTO, RETURN),
    "joystick": OFFBOARD,
}

STOPS: dict[tuple[int, int], Body] = {
    HOLD: Hover(),
    (AUTO, RETURN): ReturnHome(),
    (AUTO, LAND): LandNow(),
}
STANDARD_STOPS: dict[int, Body] = {
    mavlink.MAV_STANDARD_MODE_SAFE_RECOVERY: ReturnHome(),
    mavlink.MAV_STANDARD_MODE_LAND: LandNow(),
}


def custom_mode(dji_mode: str, holder: str) -> int:
    """Return PX4's number for a flight mode of DJI, where `holder` has the control authority.

    DJI reports GPS_ATTI for a hold as well as for a pilot at the sticks.
    """
    main, sub = _OF_DJI.get(dji_mode, POSITION)
    if (main, sub) == HOLD and holder == "pilot":
        main, sub = POSITION
    return main << 16 | sub << 24


def main_and_sub_mode(custom: int) -> tuple[int, int]:
    """Return main mode and sub-mode of PX4's number."""
    return custom >> 16 & 0xFF, custom >> 24 & 0xFF
