"""Temporary zones, as the API sends them."""

from functools import lru_cache

from recon.api import schema
from recon.model.geo import LocalFrame
from recon.model.temporary_zone import Circle, DrawnZone, TemporaryZone
from recon.model.units import ns_to_seconds
from recon.safety.temporary_zones import MOST_ZONES, drawn_region
from recon.station.api_views.ages import since_s
from recon.station.api_views.site_view import lon_lat_ring
from recon.station.state.station import Station


def zone_views(station: Station, now_ns: int) -> list[schema.TemporaryZoneView]:
    """Return the zones in force, the oldest first."""
    frame, in_force = station.airspace.airspace.frame, station.temporary_zones.in_force
    return [] if frame is None else [zone_view(z, frame, now_ns) for z in in_force.values()]


def zone_view(zone: TemporaryZone, frame: LocalFrame, now_ns: int) -> schema.TemporaryZoneView:
    """Return one zone in force."""
    drawn, ends_at_ns = zone.drawn, zone.ends_at_ns
    return schema.TemporaryZoneView(
        id=zone.id,
        name=zone.name,
        kind=drawn.kind.value,
        ring=list(_ring(drawn, frame)),
        radius_m=drawn.shape.radius_m if isinstance(drawn.shape, Circle) else None,
        floor_m=drawn.floor_m,
        ceiling_m=drawn.ceiling_m,
        reason=drawn.reason,
        by=zone.by,
        # After a restart the clock may be behind that of the last run.
        age_s=max(0.0, since_s(zone.drawn_at_ns, now_ns)),
        ends_in_s=None if ends_at_ns is None else max(0.0, ns_to_seconds(ends_at_ns - now_ns)),
    )


@lru_cache(maxsize=2 * MOST_ZONES)
def _ring(drawn: DrawnZone, frame: LocalFrame) -> tuple[tuple[float, float], ...]:
    """Worked out once: it is part of every state."""
    return tuple(lon_lat_ring(drawn_region(drawn, frame).outline_m, frame))
