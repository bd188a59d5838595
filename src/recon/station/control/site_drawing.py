"""The site's layers drawn anew while the station runs.

Theory of operation. The drawing is checked and saved in the site's folder first; then this event
brings boundary, zones and pads into force, in one step. What the safety gate judges by changes only
while everything is on the ground: a mission was approved inside the fence of its takeoff, so the
fence of a flight in progress neither grows nor shrinks under it. To keep drones out of a place at
once, there are temporary zones; those in force stay. Survey regions limit nothing and may be drawn
at any time. The airspace is prepared in the step: nothing flies that this could delay.
"""

from collections.abc import Iterator

import numpy as np

from recon.model.airspace import Airspace, Region, Zone, layers_text
from recon.model.command import Refusal
from recon.model.event import SiteRedrawn
from recon.model.replacing import replace
from recon.model.units import seconds_to_ns
from recon.record.audit import AuditEntry
from recon.safety import PreparedAirspace
from recon.station.control import temporary_zones
from recon.station.control.takeoff_stops import was_shown
from recon.station.state.station import Station
from recon.station.traffic.known_traffic import about_to_fly, in_the_air

RULE = "site_drawing"


def refusal(station: Station, event: SiteRedrawn, now_ns: int) -> Refusal | None:
    """Return why a drawing cannot come into force now, else None."""
    if not _changes_fences(station, event):
        return None
    flying = [vehicle.display_name for vehicle, _serial in in_the_air(station)]
    flying += [vehicle.display_name for vehicle, _intent in about_to_fly(station, now_ns)]
    flying += _may_take_off_late(station, now_ns)
    if not flying:
        return None
    names = ", ".join(dict.fromkeys(flying))
    return Refusal(
        RULE,
        "Boundary, zones and pads change only while all vehicles are on the ground. In the air, or "
        f"not known to be on the ground: {names}. Land them, or draw a temporary zone to keep them "
        "out of a place now",
    )


def redraw(station: Station, event: SiteRedrawn, now_ns: int) -> Station:
    """Return the station with the drawn layers in force, unless that is refused."""
    if not _changes_fences(station, event) or refusal(station, event, now_ns) is not None:
        return station
    site = _of_site(station)
    drawn = replace(
        site,
        boundary=event.boundary,
        zones=event.zones,
        landing_pads=event.landing_pads,
        elevation=event.elevation or site.elevation,
    )
    station = temporary_zones.moved_to(station, PreparedAirspace(drawn))
    fleet = station.fleet
    profiles = {
        serial: replace(profile, pad=event.pads.get(serial))
        for serial, profile in fleet.profiles.items()
    }
    vehicles = {
        serial: vehicle
        if vehicle.profile is None
        else replace(vehicle, profile=profiles.get(serial, vehicle.profile))
        for serial, vehicle in fleet.vehicles.items()
    }
    return station.with_fleet(replace(fleet, profiles=profiles, vehicles=vehicles))


def entry(before: Station, event: SiteRedrawn, now_ns: int) -> AuditEntry:
    """Return the entry of a drawing: which layers, by whom, or why it was refused."""
    refused = refusal(before, event, now_ns)
    if refused is not None:
        why = {"rule": refused.rule, "reason": refused.reason}
        return AuditEntry("site.refused", refused.reason, event.by, details=why)
    verb = "last change undone" if event.is_undo else "drawn anew"
    details = {
        "layers": [layer.value for layer in event.layers],
        "zones": [zone.name for zone in event.zones],
        "pads": [pad.name for pad in event.landing_pads],
        "has_boundary": event.boundary is not None,
    }
    return AuditEntry(
        "site.redrawn", f"site {verb}: {layers_text(event.layers)}", event.by, details=details
    )


def _may_take_off_late(station: Station, now_ns: int) -> Iterator[str]:
    """Yield the names of vehicles whose app may still begin a flight that it was sent."""
    late_ns = now_ns - seconds_to_ns(station.settings.takeoff_stop_s)
    for record in station.orders.records.values():
        is_recent = record.sent is not None and record.sent.sent_at_ns >= late_ns
        if record.command.takeoff and is_recent and not was_shown(record):
            yield record.vehicle_name


def _of_site(station: Station) -> Airspace:
    """The airspace without the temporary zones."""
    airspace, added = station.airspace.airspace, len(station.airspace.temporary_zones)
    return replace(airspace, zones=airspace.zones[: len(airspace.zones) - added])


def _changes_fences(station: Station, event: SiteRedrawn) -> bool:
    """Whether anything that the gate judges by differs; regions to survey do not count."""
    site = _of_site(station)
    profiles = station.fleet.profiles
    return not (
        _is_same_region(site.boundary, event.boundary)
        and len(site.zones) == len(event.zones)
        and all(map(_is_same_zone, site.zones, event.zones))
        and site.landing_pads == event.landing_pads
        and all(profile.pad == event.pads.get(serial) for serial, profile in profiles.items())
    )


def _is_same_zone(one: Zone, other: Zone) -> bool:
    facts = ((z.name, z.kind, z.floor_m, z.ceiling_m, z.datum) for z in (one, other))
    return next(facts) == next(facts) and _is_same_region(one.region, other.region)


def _is_same_region(one: Region | None, other: Region | None) -> bool:
    if one is None or other is None:
        return one is other
    rings = zip((one.outline_m, *one.holes_m), (other.outline_m, *other.holes_m), strict=False)
    is_as_many = len(one.holes_m) == len(other.holes_m)
    return is_as_many and all(np.array_equal(a, b) for a, b in rings)
