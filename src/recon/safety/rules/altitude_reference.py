"""The altitude reference of an app's waypoints must be set in the vehicle's profile."""

from recon.model.command import Command, FlyMission, Refusal
from recon.model.vehicle import AltitudeReference, VehicleState
from recon.safety.situation import Situation

RULE = "altitude_reference"


def altitude_reference(command: Command, situation: Situation) -> Refusal | None:
    """Refuse a mission whose altitudes could be misunderstood by metres or hundreds of metres."""
    vehicle = situation.vehicle
    if not isinstance(command.body, FlyMission) or vehicle is None:
        return None
    profile = vehicle.profile
    if profile is None or profile.waypoint_altitude is AltitudeReference.UNSET:
        return Refusal(
            RULE,
            f"{vehicle.display_name}: the altitude reference of its app is not set; "
            'write waypoint_altitude = "takeoff" (the public iOS app) or "wgs84" (an app built to '
            f'the first ICD) under [[vehicles]] serial = "{vehicle.serial}" in site.toml',
        )
    if profile.waypoint_altitude is AltitudeReference.WGS84:
        return _offset_refusal(vehicle, situation)
    return None


def _offset_refusal(vehicle: VehicleState, situation: Situation) -> Refusal | None:
    offset, limits = vehicle.altitude_offset_m, situation.settings
    age_s = offset.age_s(situation.now_ns)
    name = vehicle.display_name
    if offset.value is None or age_s is None:
        return Refusal(
            RULE, f"{name} reports no altitude: WGS84 cannot be related to its takeoff point"
        )
    if age_s > limits.altitude_offset_max_age_s:
        most_s = limits.altitude_offset_max_age_s
        return Refusal(
            RULE,
            f"{name}: altitude must be at most {most_s:g} s old; got {age_s:.1f} s",
            parameters={"age_s": age_s, "max_s": most_s},
        )
    if not abs(offset.value) <= limits.altitude_offset_max_m:
        return Refusal(
            RULE,
            f"{name}: altitude must be within {limits.altitude_offset_max_m:g} m of the height "
            f"above takeoff; got {offset.value:g} m; wait until it reports a valid altitude",
            parameters={"altitude_offset_m": offset.value, "max_m": limits.altitude_offset_max_m},
        )
    at_takeoff_m = vehicle.altitude_offset_at_takeoff_m
    if at_takeoff_m is None:
        return None
    jump_m = abs(offset.value - at_takeoff_m)
    if not jump_m <= limits.altitude_offset_max_jump_m:
        return Refusal(
            RULE,
            f"{name}: WGS84 altitude must stay within {limits.altitude_offset_max_jump_m:g} m of "
            f"the height above takeoff; got a jump of {jump_m:.1f} m since takeoff; land and take "
            "off again",
            parameters={"jump_m": jump_m, "max_m": limits.altitude_offset_max_jump_m},
        )
    return None
