"""A vehicle's telemetry as messages of MAVLink. Unknown values are the protocol's own, or absent.

A message whose fields have no value for *unknown*, such as a position, is sent only with all of
them known: a zero would look measured.
"""

from math import atan2, degrees, hypot, isfinite, nan, radians

from recon.client.telemetry import Aged, Telemetry
from recon.gateway.mavlink.dialect import ENCODED_DEGREE, UNKNOWN_UINT16, mavlink
from recon.gateway.mavlink.flight_modes import custom_mode
from recon.model.vehicle import ENOUGH_SATELLITES

FRESH_S = 3.0
"""Values of the second group, battery and satellites, come every second; older ones are unknown."""
Place = tuple[float, float]
"""Latitude and longitude, degrees."""
NO_POSE = (1.0, 0.0, 0.0, 0.0)
_INT16 = 2**15 - 1

SENSORS = (
    mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG
)
"""Healthy while the aircraft reports an attitude: an app says no more of them."""
GPS = mavlink.MAV_SYS_STATUS_SENSOR_GPS
NO_BREACH = mavlink.MAV_SYS_STATUS_GEOFENCE
"""Healthy and not present: MAVProxy calls out a breach of a fence that is not healthy."""


def heartbeat(vehicle: Telemetry) -> mavlink.MAVLink_heartbeat_message:
    """Return the heartbeat of a vehicle with live telemetry: in the air unless known otherwise."""
    is_in_air = vehicle.is_flying.value is not False
    mode = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    mode |= mavlink.MAV_MODE_FLAG_SAFETY_ARMED if is_in_air else 0
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR,
        mavlink.MAV_AUTOPILOT_PX4,
        mode,
        custom_mode(vehicle.flight_mode.value or "unknown", vehicle.authority.holder),
        mavlink.MAV_STATE_ACTIVE if is_in_air else mavlink.MAV_STATE_STANDBY,
        3,
    )


def landed_state(vehicle: Telemetry) -> mavlink.MAVLink_extended_sys_state_message:
    """Return whether a vehicle is in the air, as the station believes."""
    states = {
        True: mavlink.MAV_LANDED_STATE_IN_AIR,
        False: mavlink.MAV_LANDED_STATE_ON_GROUND,
        None: mavlink.MAV_LANDED_STATE_UNDEFINED,
    }
    return mavlink.MAVLink_extended_sys_state_message(0, states[vehicle.is_flying.value])


def position(
    vehicle: Telemetry, boot_ms: int, ground_m: float
) -> mavlink.MAVLink_global_position_int_message | None:
    """Return where a vehicle is and how fast it moves; None while any of it is unknown."""
    place, speed = vehicle.position, vehicle.velocity_ned
    height_m = vehicle.height_above_takeoff_m.value
    if place.latitude_deg is None or place.longitude_deg is None or height_m is None:
        return None
    if speed.north_mps is None or speed.east_mps is None or speed.down_mps is None:
        return None
    return mavlink.MAVLink_global_position_int_message(
        boot_ms,
        encoded_degrees(place.latitude_deg),
        encoded_degrees(place.longitude_deg),
        round((ground_m + height_m) * 1e3),
        round(height_m * 1e3),
        _centimetres(speed.north_mps),
        _centimetres(speed.east_mps),
        _centimetres(speed.down_mps),
        _heading(vehicle.attitude.yaw_deg),
    )


def attitude(vehicle: Telemetry, boot_ms: int) -> mavlink.MAVLink_attitude_message | None:
    """Return a vehicle's attitude; its rates are unknown."""
    pose = vehicle.attitude
    if pose.yaw_deg is None or pose.pitch_deg is None or pose.roll_deg is None:
        return None
    yaw_deg = (pose.yaw_deg + 180.0) % 360.0 - 180.0
    return mavlink.MAVLink_attitude_message(
        boot_ms, radians(pose.roll_deg), radians(pose.pitch_deg), radians(yaw_deg), nan, nan, nan
    )


def status(vehicle: Telemetry, *, has_place: bool) -> mavlink.MAVLink_sys_status_message:
    """Return the health of a vehicle and its battery; `has_place`: its position is a live one.

    It never says that the vehicle may be armed: the checklist and the gate decide that.
    """
    sensors = SENSORS | GPS
    healthy = NO_BREACH | (SENSORS if vehicle.attitude.yaw_deg is not None else 0)
    if has_place and _satellites(vehicle) >= ENOUGH_SATELLITES:
        healthy |= GPS
    left = _percent(vehicle)
    return mavlink.MAVLink_sys_status_message(
        sensors, sensors, healthy, 0, UNKNOWN_UINT16, -1, left, 0, 0, 0, 0, 0, 0
    )


def battery(vehicle: Telemetry) -> mavlink.MAVLink_battery_status_message:
    """Return the share of a vehicle's battery that is left; -1: unknown."""
    unknown = [UNKNOWN_UINT16] * 10
    warning = _fresh(vehicle.battery_warning)
    state = {"none": 1, "low": 2, "serious": 3}.get(str(warning), 0)
    return mavlink.MAVLink_battery_status_message(
        0, 0, 0, _INT16, unknown, -1, -1, -1, _percent(vehicle), 0, state
    )


def gnss(
    vehicle: Telemetry, boot_ms: int, ground_m: float
) -> mavlink.MAVLink_gps_raw_int_message | None:
    """Return the receiver's state; the place is that of the telemetry, as an app has no raw one."""
    place, height_m = vehicle.position, vehicle.height_above_takeoff_m.value
    if place.latitude_deg is None or place.longitude_deg is None or height_m is None:
        return None
    satellites, unknown = _satellites(vehicle), UNKNOWN_UINT16
    return mavlink.MAVLink_gps_raw_int_message(
        boot_ms * 1000,
        mavlink.GPS_FIX_TYPE_3D_FIX if satellites >= 4 else mavlink.GPS_FIX_TYPE_NO_FIX,
        encoded_degrees(place.latitude_deg),
        encoded_degrees(place.longitude_deg),
        round((ground_m + height_m) * 1e3),
        *(unknown, unknown, unknown, unknown),
        satellites if satellites >= 0 else 255,
    )


def hud(vehicle: Telemetry, ground_m: float) -> mavlink.MAVLink_vfr_hud_message | None:
    """Return speed and climb as displays show them; there is no sensor of air speed or throttle."""
    speed, height_m = vehicle.velocity_ned, vehicle.height_above_takeoff_m.value
    if speed.north_mps is None or speed.east_mps is None or speed.down_mps is None:
        return None
    if height_m is None:
        return None
    yaw_deg = vehicle.attitude.yaw_deg
    if yaw_deg is None:
        yaw_deg = degrees(atan2(speed.east_mps, speed.north_mps))
    ground_mps = hypot(speed.north_mps, speed.east_mps)
    return mavlink.MAVLink_vfr_hud_message(
        nan, ground_mps, round(yaw_deg) % 360, 0, ground_m + height_m, -speed.down_mps
    )


def home(
    vehicle: Telemetry, takeoff: Place | None, ground_m: float
) -> mavlink.MAVLink_home_position_message | None:
    """Return the home that an app reports, else the place on the ground that was seen last."""
    facts = vehicle.app_facts
    if facts is not None and facts.home_latitude_deg is not None:
        takeoff = facts.home_latitude_deg, facts.home_longitude_deg or 0.0
    if takeoff is None:
        return None
    return mavlink.MAVLink_home_position_message(
        encoded_degrees(takeoff[0]),
        encoded_degrees(takeoff[1]),
        round(ground_m * 1e3),
        *(nan, nan, nan),
        NO_POSE,
        *(nan, nan, nan),
    )


def encoded_degrees(angle_deg: float) -> int:
    """Return degrees as the protocol writes them, in units of 1e-7."""
    return round(angle_deg * ENCODED_DEGREE)


def _centimetres(metres: float) -> int:
    return max(-_INT16, min(_INT16, round(metres * 100.0)))


def _heading(yaw_deg: float | None) -> int:
    return UNKNOWN_UINT16 if yaw_deg is None else round(yaw_deg * 100.0) % 36000


def _percent(vehicle: Telemetry) -> int:
    left = _fresh(vehicle.battery_fraction)
    return -1 if left is None or not isfinite(left) else max(0, min(100, int(left * 100.0 + 1e-6)))


def _satellites(vehicle: Telemetry) -> int:
    count = _fresh(vehicle.gnss_satellite_count)
    return -1 if count is None or not isfinite(count) else max(0, min(254, int(count)))


def _fresh(value: Aged[float] | Aged[str]) -> float | None:
    is_fresh = value.age_s is not None and value.age_s < FRESH_S
    return value.value if is_fresh else None  # type: ignore[return-value]
