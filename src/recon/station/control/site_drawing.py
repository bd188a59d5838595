"""The site's layers drawn anew, or its vehicles edited, while the station runs.

Theory of operation. The change is checked and saved in the site's folder first; then this event
brings boundary, zones, pads and vehicles into force, in one step. The fences that the safety gate
judges by change only while everything is on the ground: a mission was approved inside the fence of
its takeoff, so the fence of a flight in progress neither grows nor shrinks under it. To keep drones
out of a place at once, there are temporary zones; those in force stay. Survey regions limit nothing
and may be drawn at any time. The airspace is prepared in the step: nothing flies that this could
delay.

Of a vehicle, name and camera may change at any time. Everything else is what its flight was judged
by, or what operators select it by: its altitude reference, its number, that it is listed at all.
That changes only while this vehicle is on the ground.
"""

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from recon.model.airspace import Airspace, Region, SiteLayer, Zone, layers_text
from recon.model.command import Refusal
from recon.model.event import SiteRedrawn
from recon.model.geo import GeoPoint
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleProfile
from recon.record.audit.audit import AuditEntry
from recon.safety import PreparedAirspace
from recon.station.control import temporary_zones
from recon.station.control.takeoff_stops import was_shown
from recon.station.state.station import Station
from recon.station.traffic.known_traffic import about_to_fly, in_the_air

RULE = "site_drawing"


def refusal(station: Station, event: SiteRedrawn, now_ns: int) -> Refusal | None:
    """Return why a change of the site cannot come into force now, else None."""
    flying = tuple(_flying(station, now_ns))
    if flying and _changes_fences(station, event):
        names = ", ".join(dict.fromkeys(name for _, name in flying))
        return Refusal(
            RULE,
            "Boundary, zones and pads change only while all vehicles are on the ground. In the "
            f"air, or not known to be on the ground: {names}. Land them, or draw a temporary zone "
            "to keep them out of a place now",
        )
    changed = _changed_for_flight(station, event)
    # A vehicle that has not reported its serial may be any of them.
    fixed = dict.fromkeys(name for s, name in flying if changed and (s is None or s in changed))
    if not fixed:
        return None
    return Refusal(
        RULE,
        "A vehicle's altitude reference and number change, and it is added or removed, only while "
        f"it is on the ground. In the air, or not known to be on the ground: {', '.join(fixed)}. "
        "Land first; name and camera can be changed now",
    )


def _flying(station: Station, now_ns: int) -> Iterator[tuple[str | None, str]]:
    """Yield serial and name of each vehicle that is, or may soon be, in the air."""
    yield from ((serial, vehicle.display_name) for vehicle, serial in in_the_air(station))
    for vehicle, _intent in about_to_fly(station, now_ns):
        yield vehicle.serial, vehicle.display_name
    yield from _may_take_off_late(station, now_ns)


def _changed_for_flight(station: Station, event: SiteRedrawn) -> set[str]:
    """Return the serials of which more than name and camera would change."""
    known, asked = station.fleet.profiles, event.profiles

    def flown_by(profiles: Mapping[str, VehicleProfile], serial: str) -> VehicleProfile:
        return replace(profiles.get(serial, VehicleProfile(serial)), name="", camera=None)

    serials = {*known, *asked}
    return {serial for serial in serials if flown_by(known, serial) != flown_by(asked, serial)}


def redraw(station: Station, event: SiteRedrawn, now_ns: int) -> Station:
    """Return the station with the drawn layers in force, unless that is refused."""
    if refusal(station, event, now_ns) is not None:
        return station
    if _changes_fences(station, event):
        station = _with_fences(station, event)
    if station.fleet.profiles == event.profiles:
        return station
    fleet = station.fleet
    vehicles = {
        serial: replace(vehicle, profile=event.profiles.get(serial))
        for serial, vehicle in fleet.vehicles.items()
    }
    return station.with_fleet(replace(fleet, profiles=event.profiles, vehicles=vehicles))


def _with_fences(station: Station, event: SiteRedrawn) -> Station:
    site = _of_site(station)
    drawn = replace(
        site,
        boundary=event.boundary,
        zones=event.zones,
        landing_pads=event.landing_pads,
        elevation=event.elevation or site.elevation,
    )
    return temporary_zones.moved_to(station, PreparedAirspace(drawn))


def entry(before: Station, event: SiteRedrawn, now_ns: int) -> AuditEntry:
    """Return the entry of a change: layers and vehicles, by whom, or why it was refused."""
    refused = refusal(before, event, now_ns)
    if refused is not None:
        why = {"rule": refused.rule, "reason": refused.reason}
        return AuditEntry("site.refused", refused.reason, event.by, details=why)
    vehicles = changed_vehicles(before.fleet.profiles, event.profiles)
    is_drawn = bool(event.layers) or not vehicles
    verb = "last change undone" if event.is_undo else "drawn anew" if is_drawn else "edited"
    details = {
        "layers": [layer.value for layer in event.layers],
        "zones": [zone.name for zone in event.zones],
        "pads": [pad.name for pad in event.landing_pads],
        "has_boundary": event.boundary is not None,
        "vehicles": list(vehicles),
    }
    text = f"site {verb}: {change_text(event.layers, bool(vehicles))}"
    text += "".join(f"; {change}" for change in vehicles)
    return AuditEntry("site.redrawn", text, event.by, details=details)


def change_text(layers: Iterable[SiteLayer], has_vehicles: bool) -> str:
    """Return what a change is about, for readers."""
    parts = (layers_text(layers), "vehicles" if has_vehicles else "")
    return ", ".join(part for part in parts if part)


def changed_vehicles(
    before: Mapping[str, VehicleProfile], after: Mapping[str, VehicleProfile]
) -> tuple[str, ...]:
    """Return one sentence for each vehicle that was added, removed or edited; pads are layers'."""
    serials = dict.fromkeys((*before, *after))
    changes = ((s, _vehicle_change(before.get(s), after.get(s))) for s in serials)
    return tuple(f"{serial} {change}" for serial, change in changes if change)


def _vehicle_change(before: VehicleProfile | None, after: VehicleProfile | None) -> str:
    if before is None or after is None:
        return "" if before is after else "added" if before is None else "removed"
    facts = {
        "name": (before.name, after.name),
        "number": (before.number, after.number),
        "camera": (before.camera, after.camera),
        "altitude reference": (before.waypoint_altitude.value, after.waypoint_altitude.value),
    }
    changed = (
        f"{fact} {a or 'unset'} -> {b or 'unset'}" for fact, (a, b) in facts.items() if a != b
    )
    return ", ".join(changed)


def _may_take_off_late(station: Station, now_ns: int) -> Iterator[tuple[str | None, str]]:
    """Yield serial and name of vehicles whose app may still begin a flight that it was sent."""
    late_ns = now_ns - seconds_to_ns(station.settings.takeoff_stop_s)
    for record in station.orders.records.values():
        is_recent = record.sent is not None and record.sent.sent_at_ns >= late_ns
        if record.command.takeoff and is_recent and not was_shown(record):
            yield record.command.serial, record.vehicle_name


def _of_site(station: Station) -> Airspace:
    """The airspace without the temporary zones."""
    airspace, added = station.airspace.airspace, len(station.airspace.temporary_zones)
    return replace(airspace, zones=airspace.zones[: len(airspace.zones) - added])


def _changes_fences(station: Station, event: SiteRedrawn) -> bool:
    """Whether anything that the gate judges by differs; regions to survey do not count."""
    site = _of_site(station)
    known = station.fleet.profiles
    return not (
        _is_same_region(site.boundary, event.boundary)
        and len(site.zones) == len(event.zones)
        and all(map(_is_same_zone, site.zones, event.zones))
        and site.landing_pads == event.landing_pads
        and all(_pad(known, serial) == _pad(event.profiles, serial) for serial in known)
    )


def _pad(profiles: Mapping[str, VehicleProfile], serial: str) -> GeoPoint | None:
    profile = profiles.get(serial)
    return None if profile is None else profile.pad


def _is_same_zone(one: Zone, other: Zone) -> bool:
    facts = ((z.name, z.kind, z.floor_m, z.ceiling_m, z.datum) for z in (one, other))
    return next(facts) == next(facts) and _is_same_region(one.region, other.region)


def _is_same_region(one: Region | None, other: Region | None) -> bool:
    if one is None or other is None:
        return one is other
    rings = zip((one.outline_m, *one.holes_m), (other.outline_m, *other.holes_m), strict=False)
    is_as_many = len(one.holes_m) == len(other.holes_m)
    return is_as_many and all(np.array_equal(a, b) for a, b in rings)
