"""Looks whether heights agree: the reported altitude with the height above takeoff, and the height
flown with the one that was ordered."""

from collections.abc import Iterator

from recon.model.intent import Commanded
from recon.model.severity import Severity
from recon.model.vehicle import AltitudeReference, FlightMode
from recon.safety.settings import WatchdogSettings
from recon.safety.watchdogs.finding import Finding
from recon.safety.watchdogs.picture import Picture, WatchedVehicle

RULE = "altitude_mismatch"
WGS84_DRIFT_M = 2.0
"""For an app that is sent altitudes: the gate refuses missions from here on."""


def heights(picture: Picture) -> Iterator[Finding]:
    """Find vehicles whose heights contradict each other."""
    for watched in picture.flying:
        yield from _drift(watched, picture.settings)
        yield from _off_its_leg(watched, picture.settings)


def _drift(watched: WatchedVehicle, settings: WatchdogSettings) -> Iterator[Finding]:
    state = watched.state
    offset_m, at_takeoff_m = state.altitude_offset_m.value, state.altitude_offset_at_takeoff_m
    if offset_m is None or at_takeoff_m is None:
        return
    profile = state.profile
    is_wgs84 = profile is not None and profile.waypoint_altitude is AltitudeReference.WGS84
    drift_m = abs(offset_m - at_takeoff_m)
    if drift_m > (WGS84_DRIFT_M if is_wgs84 else settings.height_drift_m):
        text = (
            f"its altitude and its height above takeoff have drifted {drift_m:.0f} m apart since "
            "takeoff; one of them is wrong"
        )
        severity = Severity.ERROR if is_wgs84 else Severity.WARNING
        yield watched.finding(RULE, severity, text, about=":drift", after_s=1.0)


def _off_its_leg(watched: WatchedVehicle, settings: WatchdogSettings) -> Iterator[Finding]:
    """On a leg between two waypoints every height between theirs is right, and no other."""
    intent, height_m = watched.intent, watched.state.height_above_takeoff_m.value
    flies_it = watched.state.flight_mode.value is FlightMode.GPS_WAYPOINT
    if intent.commanded is not Commanded.MISSION or intent.mission is None or not flies_it:
        return
    leg = intent.mission.waypoints[max(0, intent.passed - 1) : intent.passed + 1]
    if height_m is None or len(leg) < 2:
        return
    low_m, high_m = sorted(waypoint.height_above_takeoff_m for waypoint in leg)
    off_m = max(low_m - height_m, height_m - high_m)
    if off_m > settings.height_off_m:
        side = "above" if height_m > high_m else "below"
        text = f"it flies {off_m:.0f} m {side} the heights of the leg it was sent"
        yield watched.finding(RULE, Severity.ERROR, text, about=":leg", after_s=3.0)
