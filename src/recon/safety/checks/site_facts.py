"""What people have told of the vehicle in the site's file, since the ICD carries none of it."""

from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile, VehicleState
from recon.safety.check import Check, Point
from recon.safety.situation import Situation

ALTITUDE = Point("altitude_reference", "Altitude reference")
ENDURANCE = Point("endurance", "Endurance")
FAILSAFE = Point("failsafe", "Failsafe")
CAMERA = Point("camera_interval", "Camera interval")

_DOES = {
    Failsafe.GO_HOME: "goes home",
    Failsafe.HOVER: "hovers until its battery makes it land",
    Failsafe.LAND: "lands where it is",
}


def altitude_reference(vehicle: VehicleState, _situation: Situation) -> Check:
    """What its app takes a waypoint's altitude for is told."""
    reference = _profile(vehicle).waypoint_altitude
    if reference is AltitudeReference.UNSET:
        return ALTITUDE.unknown(
            "what its app takes a waypoint's altitude for is not told",
            _write(vehicle, 'waypoint_altitude = "takeoff" or "wgs84"'),
        )
    return ALTITUDE.ok(f"{reference.value}")


def endurance(vehicle: VehicleState, _situation: Situation) -> Check:
    """How long a full battery lasts is told."""
    seconds = _profile(vehicle).endurance_s
    if seconds is None:
        return ENDURANCE.unknown(
            "how long a full battery lasts is not told", _write(vehicle, "endurance_min = MINUTES")
        )
    return ENDURANCE.ok(f"{seconds / 60.0:.0f} min")


def failsafe(vehicle: VehicleState, _situation: Situation) -> Check:
    """What it does when it loses its controller is told."""
    does = _profile(vehicle).failsafe
    if does is None:
        return FAILSAFE.unknown(
            "what it does when it loses its controller is not told",
            _write(
                vehicle, 'failsafe = "go_home", "hover" or "land", as it is set in the aircraft'
            ),
        )
    return FAILSAFE.ok(f"{_DOES[does]} when it loses its controller")


def camera_interval(vehicle: VehicleState, _situation: Situation) -> Check:
    """The interval of the camera's timer is told; only the photos depend on it."""
    seconds = _profile(vehicle).camera_interval_s
    if seconds is None:
        return CAMERA.attention(
            "the interval of the camera's timer is not told",
            f"{_write(vehicle, 'camera_interval_s = SECONDS')}, if it takes survey photos",
        )
    return CAMERA.ok(f"a photo every {seconds:g} s, once the pilot has started the timer")


def _profile(vehicle: VehicleState) -> VehicleProfile:
    return vehicle.profile or VehicleProfile(vehicle.serial or "")


def _write(vehicle: VehicleState, line: str) -> str:
    return f'write {line} under [[vehicles]] serial = "{vehicle.serial}" in site.toml'
