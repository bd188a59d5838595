"""What a waypoint's altitude means to the app is a setting, never a guess."""

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
            f"{vehicle.display_name}: what its app takes a waypoint's altitude for is not set; "
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
        return Refusal(RULE, f"{name} reports no altitude to relate WGS84 to its takeoff point")
    if age_s > limits.altitude_offset_max_age_s:
        return Refusal(RULE, f"{name}: its altitude is {age_s:.1f} s old, 2 s at most is needed")
    if not abs(offset.value) <= limits.altitude_offset_max_m:
        return Refusal(
            RULE,
            f"{name} reports an altitude {offset.value:g} m from its height above takeoff: "
            "no altitude on earth; wait until it reports a sound one",
        )
    at_takeoff_m = vehicle.altitude_offset_at_takeoff_m
    if at_takeoff_m is None:
        return None
    jump_m = abs(offset.value - at_takeoff_m)
    if not jump_m <= limits.altitude_offset_max_jump_m:
        return Refusal(
            RULE,
            f"{name}: its WGS84 altitude has jumped by {jump_m:.1f} m against its height above "
            "takeoff since takeoff; land and take off again",
        )
    return None
