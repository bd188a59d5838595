"""Heights of MAVLink's frames as heights above takeoff, the only ones that apps report."""

from recon.gateway.mavlink.dialect import mavlink

_ABOVE_SEA = (mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT)
_ABOVE_HOME = (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)


def height_above_takeoff_m(given_m: float, frame: int, ground_m: float) -> float | None:
    """Return a height above takeoff; None of a frame whose heights the gateway cannot tell.

    `ground_m` is the altitude above sea level that the gateway shows for every takeoff point.
    """
    if frame in _ABOVE_HOME:
        return given_m
    return given_m - ground_m if frame in _ABOVE_SEA else None
