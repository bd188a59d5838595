"""Routes for temporary zones: draw and end one; those in force are in every state."""

from fastapi import FastAPI, Request

from recon.api import schema
from recon.api.port import StationPort
from recon.api.security import person_of
from recon.model.geo import LatLon
from recon.model.temporary_zone import (
    DEFAULT_CEILING_M,
    Circle,
    DrawnZone,
    Outline,
    TemporaryZoneKind,
)


def add_zone_routes(app: FastAPI, port: StationPort) -> None:
    """Add all routes of this module."""

    @app.get("/api/zones")
    async def zones() -> list[schema.TemporaryZoneView]:
        """The temporary zones in force, the oldest first."""
        return port.state().temporary_zones

    @app.post("/api/zones")
    async def draw(
        asked: schema.TemporaryZoneRequest, request: Request
    ) -> schema.TemporaryZoneResponse:
        """Draw a temporary zone; everything is kept out of it at once.

        Vehicles about to enter it are held. One that is in it raises an alarm and may be led out.
        """
        return port.draw_zone(to_drawn(asked), person_of(request))

    @app.post("/api/zones/{zone_id}/end")
    async def end(zone_id: int, request: Request) -> schema.ActionResponse:
        """End a temporary zone. Nothing is sent, and nothing that was held resumes."""
        return port.end_zone(zone_id, person_of(request))


def to_drawn(asked: schema.TemporaryZoneRequest) -> DrawnZone:
    """Return the zone as the station judges it; without a ceiling, the usual one of its kind."""
    kind = TemporaryZoneKind(asked.kind)
    return DrawnZone(
        kind,
        _shape(asked),
        asked.reason,
        floor_m=asked.floor_m,
        ceiling_m=DEFAULT_CEILING_M[kind] if asked.ceiling_m is None else asked.ceiling_m,
        lasts_s=asked.lasts_s,
    )


def _shape(asked: schema.TemporaryZoneRequest) -> Circle | Outline:
    circle = asked.circle
    if circle is not None:
        return Circle(LatLon(circle.latitude_deg, circle.longitude_deg), circle.radius_m)
    corners = asked.outline or []
    return Outline(tuple(LatLon(each.latitude_deg, each.longitude_deg) for each in corners))
