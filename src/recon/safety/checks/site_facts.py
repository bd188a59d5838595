"""Checks of the vehicle's profile in site.toml, and of the aircraft's report of the same."""

from collections.abc import Iterator

import numpy as np

from recon.model.airspace import HeightDatum, ZoneKind
from recon.model.vehicle import AltitudeReference, Failsafe, VehicleProfile, VehicleState
from recon.safety.airspace import PreparedAirspace, PreparedZone
from recon.safety.check import Check, Point
from recon.safety.datum import takeoff_up_m
from recon.safety.reported_facts import reported_facts
from recon.safety.separation_minima import gate_minima
from recon.safety.situation import Situation

ALTITUDE = Point("altitude_reference", "Altitude reference")
ENDURANCE = Point("endurance", "Endurance")
FAILSAFE = Point("failsafe", "Failsafe")
CAMERA = Point("camera_interval", "Camera interval")

_NO_PROFILE = VehicleProfile("")
_DOES = {
    Failsafe.GO_HOME: "goes home",
    Failsafe.HOVER: "hovers until its battery makes it land",
    Failsafe.LAND: "lands where it is",
}


def altitude_reference(vehicle: VehicleState, _situation: Situation) -> Check:
    """The altitude reference of its app's waypoints is set."""
    reference = _profile(vehicle).waypoint_altitude
    if reference is AltitudeReference.UNSET:
        return ALTITUDE.unknown(
            "altitude reference not set",
            _write(vehicle, 'waypoint_altitude = "takeoff" or "wgs84"'),
        )
    return ALTITUDE.ok(f"{reference.value}")


def endurance(vehicle: VehicleState, _situation: Situation) -> Check:
    """The endurance of a full battery is set."""
    seconds = _profile(vehicle).endurance_s
    if seconds is None:
        return ENDURANCE.unknown("endurance not set", _write(vehicle, "endurance_min = MINUTES"))
    return ENDURANCE.ok(f"{seconds / 60.0:.0f} min")


def failsafe(vehicle: VehicleState, situation: Situation) -> Check:
    """The failsafe for a lost controller is set, and is the aircraft's where that is reported."""
    does = _profile(vehicle).failsafe
    stated = reported_facts(vehicle, situation.now_ns).failsafe
    if does is None:
        value = f'"{stated}"' if stated else '"go_home", "hover" or "land"'
        return FAILSAFE.unknown(
            "failsafe for a lost controller not set",
            _write(vehicle, f"failsafe = {value}, as it is set in the aircraft"),
        )
    if stated is not None and stated != does.value:
        return FAILSAFE.fails(
            f"the aircraft reports {stated}; site.toml states {does.value}", SAME_IN_BOTH
        )
    if stated is not None and does is not Failsafe.GO_HOME:
        return FAILSAFE.attention(
            f"the aircraft reports {stated}, and not go_home",
            "set it to go home when it loses its controller, unless that is meant",
        )
    return FAILSAFE.ok(f"{_DOES[does]} when it loses its controller{_confirmed(stated)}")


SAME_INTERVAL_S = 0.05
SAME_IN_BOTH = "set the same in the aircraft and in site.toml, then load the site again"


def _confirmed(stated: object) -> str:
    return "" if stated is None else ", as the aircraft reports"


def camera_interval(vehicle: VehicleState, situation: Situation) -> Check:
    """The camera interval is set, and is the timer's where that is reported; only photos depend on
    it."""
    seconds = _profile(vehicle).camera_interval_s
    if seconds is None:
        return CAMERA.attention(
            "camera interval not set",
            f"{_write(vehicle, 'camera_interval_s = SECONDS')}, if it takes survey photos",
        )
    stated_s = reported_facts(vehicle, situation.now_ns).photo_interval_s
    if stated_s is not None and abs(stated_s - seconds) > SAME_INTERVAL_S:
        return CAMERA.attention(
            f"the camera's timer is set to {stated_s:g} s; site.toml states {seconds:g} s",
            SAME_IN_BOTH,
        )
    return CAMERA.ok(f"a photo every {seconds:g} s, once the pilot has started the timer")


def _profile(vehicle: VehicleState) -> VehicleProfile:
    return vehicle.profile or _NO_PROFILE


def _write(vehicle: VehicleState, line: str) -> str:
    return f'write {line} under [[vehicles]] serial = "{vehicle.serial}" in site.toml'


HEIGHT = Point("go_home_height", "Go-home height")
SAME_HEIGHT_M = 0.5
"""Aircraft take whole metres."""


def go_home_height(vehicle: VehicleState, situation: Situation) -> Check:
    """Check that it is set, valid, below the ceiling, clear of others' heights and of zones."""
    height_m = None if vehicle.profile is None else vehicle.profile.go_home_height_m
    stated_m = reported_facts(vehicle, situation.now_ns).go_home_height_m
    if height_m is None:
        value = "METRES" if stated_m is None else f"{stated_m:g}"
        return HEIGHT.unknown(
            "go-home height not set",
            f"read it from the aircraft's settings and write go_home_height_m = {value} under "
            f'[[vehicles]] serial = "{vehicle.serial}" in site.toml',
        )
    if stated_m is not None and abs(stated_m - height_m) > SAME_HEIGHT_M:
        return HEIGHT.fails(
            f"the aircraft reports {stated_m:g} m; site.toml states {height_m:g} m", SAME_IN_BOTH
        )
    fault = next(_faults(height_m, vehicle, situation), None)
    if fault is not None:
        return HEIGHT.fails(fault, "set another one in the aircraft and in site.toml")
    low = _not_cleared(height_m, vehicle, situation)
    if low:
        return HEIGHT.attention(
            f"{height_m:g} m does not clear {', '.join(low)}",
            "orders whose route home crosses it are refused; set a greater height to clear it",
        )
    return HEIGHT.ok(f"{height_m:g} m above takeoff{_confirmed(stated_m)}")


def _faults(height_m: float, vehicle: VehicleState, situation: Situation) -> Iterator[str]:
    settings, limits = situation.settings.preflight, situation.airspace.airspace.limits
    if not settings.least_go_home_m <= height_m <= settings.most_go_home_m:
        yield (
            f"must be {settings.least_go_home_m:g} to {settings.most_go_home_m:g} m; got "
            f"{height_m:g} m"
        )
    if height_m > limits.max_height_above_ground_m:
        yield f"must be at most {limits.max_height_above_ground_m:g} m; got {height_m:g} m"
    least_m = gate_minima(limits, situation.settings).vertical_m
    for other, apart_m in _neighbours(vehicle, situation):
        if apart_m < least_m:
            yield (
                f"must be {least_m:.1f} m from that of "
                f"{other.display_name}; got {apart_m:.1f} m at {height_m:g} m"
            )


def _neighbours(
    vehicle: VehicleState, situation: Situation
) -> Iterator[tuple[VehicleState, float]]:
    """Yield the others whose go-home height is known, and how far it is from the vehicle's."""
    own_m = _go_home_up_m(situation.airspace, vehicle)
    for other in situation.facts.others:
        other_m = _go_home_up_m(situation.airspace, other)
        if own_m is not None and other_m is not None:
            yield other, abs(own_m - other_m)


def _go_home_up_m(airspace: PreparedAirspace, vehicle: VehicleState) -> float | None:
    """The go-home height in the site's frame; above the origin without a takeoff point."""
    if vehicle.profile is None or vehicle.profile.go_home_height_m is None:
        return None
    base_m = takeoff_up_m(airspace, vehicle)
    return (0.0 if base_m is None else base_m) + vehicle.profile.go_home_height_m


def _not_cleared(height_m: float, vehicle: VehicleState, situation: Situation) -> list[str]:
    """Keep-out zones with a ceiling that the go-home height is not above, by their names.

    The ground under a zone counts at the corners of its outline; what is flown is judged exactly,
    by the rule keep_out.
    """
    base_m = takeoff_up_m(situation.airspace, vehicle)
    if base_m is None:
        return []
    over_m = base_m + height_m - situation.settings.fences.zone_vertical_margin_m
    zones = situation.airspace.zones_of(ZoneKind.KEEP_OUT)
    tops_m = ((zone.zone.name, _top_up_m(zone, situation.airspace)) for zone in zones)
    return [repr(name) for name, top_m in tops_m if top_m is not None and over_m < top_m]


def _top_up_m(prepared: PreparedZone, airspace: PreparedAirspace) -> float | None:
    zone, frame = prepared.zone, airspace.airspace.frame
    if zone.ceiling_m is None or frame is None:
        return None
    if zone.datum is HeightDatum.WGS84:
        return zone.ceiling_m - frame.origin.ellipsoid_height_m
    ground_m = airspace.ground_up_m(zone.region.outline_m)
    return float(np.fmax.reduce(ground_m)) + zone.ceiling_m  # corners without ground aside
