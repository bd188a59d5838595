"""Checks of the aircraft's own reports: link, battery, GNSS, wind and its app's warnings."""

from recon.model.units import ns_to_seconds
from recon.model.vehicle import BatteryWarning, VehicleState
from recon.safety.check import Check, Point
from recon.safety.rules.gnss import gnss_refusal
from recon.safety.situation import Situation

LINK = Point("link", "Link")
BATTERY = Point("battery", "Battery")
GNSS = Point("gnss", "GNSS")
WIND = Point("wind", "Wind")
APP = Point("app", "App's warnings")


def link(vehicle: VehicleState, situation: Situation) -> Check:
    """Exactly one app reports the vehicle, with recent telemetry."""
    if vehicle.rival_link_ids:
        return LINK.fails(
            "two connections claim this serial", "close the one that is not this aircraft's"
        )
    received_ns = vehicle.core_received_at_ns
    if received_ns is None:
        return LINK.unknown("no telemetry received yet", "check the app")
    age_s = ns_to_seconds(situation.now_ns - received_ns)
    if age_s > situation.settings.motion_telemetry_s:
        return LINK.fails(f"telemetry is {age_s:.1f} s old", "bring the app's connection back")
    return LINK.ok(f"telemetry is {age_s:.1f} s old")


def battery(vehicle: VehicleState, situation: Situation) -> Check:
    """The charge exceeds the reserve, and the aircraft reports no warning."""
    warning, has = vehicle.battery_warning.value, vehicle.battery_fraction.value
    if warning in (BatteryWarning.LOW, BatteryWarning.SERIOUS):
        return BATTERY.fails("the aircraft warns of a low battery", "change the battery")
    if has is None or warning is None:
        return BATTERY.unknown("battery charge unknown", "check the app")
    reserve = situation.airspace.airspace.limits.battery_reserve_fraction
    if has <= reserve:
        return BATTERY.fails(f"{has:.0%}, all of it reserve ({reserve:.0%})", "change the battery")
    if has < situation.settings.preflight.early_battery_fraction:
        return BATTERY.attention(f"{has:.0%}", "expect a short flight, or change the battery")
    return BATTERY.ok(f"{has:.0%}")


def gnss(vehicle: VehicleState, situation: Situation) -> Check:
    """The GNSS fix passes the gate's rule."""
    refusal = gnss_refusal(vehicle, situation.settings)
    if refusal is not None:
        return GNSS.fails(refusal.reason, "wait for a better fix, or move to open sky")
    count, level = vehicle.gnss_satellite_count.value, vehicle.gnss_signal_level.value
    return GNSS.ok(f"{count} satellites, signal level {level}")


def wind(vehicle: VehicleState, situation: Situation) -> Check:
    """The aircraft reports no strong wind. Not every app reports wind."""
    level = vehicle.wind_level.value
    if level is None:
        return WIND.ok("the app reports no wind")
    if level >= situation.settings.preflight.strong_wind_level:
        return WIND.attention(
            "the aircraft warns of strong wind", "land, or fly low and near; battery goes faster"
        )
    return WIND.ok(f"warning level {level}")


def app(_vehicle: VehicleState, situation: Situation) -> Check:
    """Every warning of the app has been acknowledged."""
    warnings = situation.facts.app_warnings
    if warnings:
        return APP.attention("; ".join(warnings), "read it, and acknowledge the alarm")
    return APP.ok("no unacknowledged warnings")
