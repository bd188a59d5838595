"""Routes for temporary zones: draw and end one; those in force are in every state."""

from fastapi import FastAPI, Request

from recon.api import schema
from recon.api.security import person_of
from recon.model.event import ZoneDrawn, ZoneEnded
from recon.model.geo import LatLon
from recon.model.temporary_zone import (
    DEFAULT_CEILING_M,
    Circle,
    DrawnZone,
    Outline,
    TemporaryZoneKind,
)
from recon.station.api_views.service import Service
from recon.station.api_views.zone_views import zone_views
from recon.station.control import temporary_zones


def add_zone_routes(app: FastAPI, service: Service) -> None:
    """Add all routes of this module."""
    driver = service.driver

    @app.get("/api/zones")
    async def zones() -> list[schema.TemporaryZoneView]:
        """The temporary zones in force, the oldest first."""
        return service.state().temporary_zones

    @app.post("/api/zones")
    async def draw(
        asked: schema.TemporaryZoneRequest, request: Request
    ) -> schema.TemporaryZoneResponse:
        """Draw a temporary zone; everything is kept out of it at once.

        Vehicles about to enter it are held. One that is in it raises an alarm and may be led out.
        """
        event = ZoneDrawn(to_drawn(asked), person_of(request).label)
        refusal = temporary_zones.draw_refusal(driver.station, event)
        answer = service.commanded(event, refusal)
        zone = zone_views(driver.station, driver.now_ns())[-1] if refusal is None else None
        return schema.TemporaryZoneResponse(**answer.model_dump(), zone=zone)

    @app.post("/api/zones/{zone_id}/end")
    async def end(zone_id: int, request: Request) -> schema.ActionResponse:
        """End a temporary zone. Nothing is sent, and nothing that was held resumes."""
        event = ZoneEnded(zone_id, person_of(request).label)
        return service.commanded(event, temporary_zones.end_refusal(driver.station, event))


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
