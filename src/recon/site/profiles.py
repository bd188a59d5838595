"""Vehicle profiles and flight limits from their tables in site.toml."""

from dataclasses import replace
from typing import Any

import msgspec

from recon.model.airspace import FlightLimits
from recon.model.errors import SiteError
from recon.model.geo import GeoPoint
from recon.model.vehicle import AltitudeReference, Failsafe, Mount, VehicleProfile
from recon.site.schema import LimitsTable, VehicleTable

PLACEHOLDER_SERIAL = "00000"
"""Sent by apps before they know their aircraft's serial."""

APP_PRESETS: dict[str, dict[str, Any]] = {
    "legacy": {"max_waypoints": 25},
}
"""Limits of older companion apps: they read 25 waypoints, 1,011 bytes, at once."""

_PLAIN_KEYS = (
    "name",
    "model",
    "max_waypoints",
    "battery_factor",
    "video_latency_s",
    "video_latency_sigma_s",
    "packet_gap_s",
    "go_home_height_m",
    "camera_interval_s",
    "priority",
)


def profile_from_table(table: VehicleTable, place: str) -> VehicleProfile:
    """Return the profile; given keys override the app's preset, which overrides the defaults.

    `place` leads the message of the `SiteError` that a placeholder serial raises.
    """
    if table.serial == PLACEHOLDER_SERIAL:
        raise SiteError(
            f"{place}.serial: expected an aircraft's own serial, got the placeholder "
            f"{PLACEHOLDER_SERIAL!r} that apps send before they know it"
        )
    values: dict[str, Any] = dict(APP_PRESETS[table.app]) if table.app else {}
    given = ((key, getattr(table, key)) for key in _PLAIN_KEYS)
    values.update({key: value for key, value in given if value is not None})
    if table.waypoint_altitude is not None:
        values["waypoint_altitude"] = AltitudeReference(table.waypoint_altitude)
    if table.mount is not None:
        values["mount"] = Mount(table.mount)
    if table.failsafe is not None:
        values["failsafe"] = Failsafe(table.failsafe)
    if table.endurance_min is not None:
        values["endurance_s"] = 60.0 * table.endurance_min
    if table.pad is not None:
        pad = table.pad
        values["pad"] = GeoPoint(pad.latitude_deg, pad.longitude_deg, pad.altitude_m)
    return replace(VehicleProfile(table.serial), **values)


def limits_from_table(table: LimitsTable, place: str) -> FlightLimits:
    """Return the limits; `place` leads the `SiteError` for limits that contradict each other."""
    given = {
        key: value for key, value in msgspec.structs.asdict(table).items() if value is not None
    }
    limits = FlightLimits(**given)
    low_m, high_m = limits.min_height_above_ground_m, limits.max_height_above_ground_m
    if low_m >= high_m:
        raise SiteError(
            f"{place}.min_height_above_ground_m: expected less than max_height_above_ground_m, "
            f"{high_m:g} m, got {low_m:g} m"
        )
    return limits
