"""Watchdogs of telemetry: late links, contradicting heights, quiet stick streams.

None of them predicts anything and none requests a hold: each compares values received from one
vehicle with one another, or with what it was sent.
"""

from collections.abc import Iterator

from recon.model.control import Commanded
from recon.model.severity import Severity
from recon.model.units import NS_PER_S
from recon.model.vehicle import AltitudeReference, FlightMode
from recon.safety.settings import WatchdogSettings
from recon.safety.watchdogs.traffic_picture import Finding, TrafficPicture, WatchedVehicle

LINK_LATE = "link_late"


def link(picture: TrafficPicture) -> Iterator[Finding]:
    """Find the vehicles in the air whose core telemetry is late."""
    for watched in picture.watched:
        at_ns = watched.state.core_received_at_ns
        if at_ns is None:
            continue
        age_s = (picture.now_ns - at_ns) / NS_PER_S
        if picture.settings.link_late_s <= age_s < picture.prediction.stale_s:
            yield watched.finding(
                LINK_LATE, Severity.WARNING, "no telemetry for more than a second"
            )


ALTITUDE_MISMATCH = "altitude_mismatch"
WGS84_DRIFT_M = 2.0
"""Altitude drift limit for an app that is sent altitudes: the gate refuses missions beyond it."""


def heights(picture: TrafficPicture) -> Iterator[Finding]:
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
        yield watched.finding(ALTITUDE_MISMATCH, severity, text, about=":drift", after_s=1.0)


def _off_its_leg(watched: WatchedVehicle, settings: WatchdogSettings) -> Iterator[Finding]:
    """Yield a finding when the height is outside the heights of the present leg."""
    intent, height_m = watched.intent, watched.state.height_above_takeoff_m.value
    flies_it = watched.state.flight_mode.value is FlightMode.GPS_WAYPOINT
    if intent.commanded is not Commanded.MISSION or intent.mission is None or not flies_it:
        return
    leg = intent.mission.waypoints[max(0, intent.passed - 1) : intent.passed + 1]
    if height_m is None or len(leg) < 2:
        return
    low_m, high_m = sorted(waypoint.height_above_takeoff_m for waypoint in leg)
    for off_m, side in ((low_m - height_m, "below"), (height_m - high_m, "above")):
        if off_m > settings.height_off_m:
            text = f"it flies {off_m:.0f} m {side} the heights of the leg it was sent"
            yield watched.finding(
                ALTITUDE_MISMATCH, Severity.ERROR, text, about=":leg", after_s=3.0
            )


STICK_STARVED = "stick_starved"


def sticks(picture: TrafficPicture) -> Iterator[Finding]:
    """Find vehicles under a steered order to which no stick has gone out for too long."""
    for watched in picture.watched:
        quiet_s = watched.stick_quiet_s
        if quiet_s is not None and quiet_s > picture.settings.stick_quiet_s:
            text = (
                f"no stick has left for it for {quiet_s:.1f} s though it is steered; its app "
                "should stop it within 1 s: if it moves on, hold it, or have its pilot stop it"
            )
            yield watched.finding(STICK_STARVED, Severity.ERROR, text)
