"""Routes for apps that wait to be admitted: admit or refuse them."""

from fastapi import FastAPI, Request

from recon.api import schema
from recon.api.security import person_of
from recon.fleet import pairing
from recon.model.event import AppAdmitted, AppRefused
from recon.station.api_views.service import Service


def add_pairing_routes(app: FastAPI, service: Service) -> None:
    """Add all routes of this module."""
    driver = service.driver

    @app.post("/api/apps/admit")
    async def admit_app(asked: schema.AdmitAppRequest, request: Request) -> schema.ActionResponse:
        """Admit the app that waits on a link as the vehicle with this serial.

        `serial` is what the person saw: an app that reports another one meanwhile is not admitted.
        """
        by, is_for_good = person_of(request).label, asked.lasting == "always"
        event = AppAdmitted(asked.link_id, asked.serial, by, is_for_good, asked.any_address)
        return service.decided(event, pairing.refusal_to_admit(driver.station.fleet, event))

    @app.post("/api/apps/refuse")
    async def refuse_app(asked: schema.RefuseAppRequest, request: Request) -> schema.ActionResponse:
        """Close the app that waits on a link, and again for 5 minutes whenever it connects.

        What it reported in flight stays a hazard area until it is dismissed.
        """
        event = AppRefused(asked.link_id, person_of(request).label)
        return service.decided(event, pairing.refusal_to_refuse(driver.station.fleet, event))
