"""Routes for apps that wait to be admitted: admit or refuse them."""

from fastapi import FastAPI, Request

from recon.api import schema
from recon.api.port import StationPort
from recon.api.security import person_of


def add_pairing_routes(app: FastAPI, port: StationPort) -> None:
    """Add all routes of this module."""

    @app.post("/api/apps/admit")
    async def admit_app(asked: schema.AdmitAppRequest, request: Request) -> schema.ActionResponse:
        """Admit the app that waits on a link as the vehicle with this serial.

        `serial` is what the person saw: an app that reports another one meanwhile is not admitted.
        """
        return port.admit_app(
            asked.link_id,
            asked.serial,
            is_for_good=asked.lasting == "always",
            any_address=asked.any_address,
            by=person_of(request),
        )

    @app.post("/api/apps/refuse")
    async def refuse_app(asked: schema.RefuseAppRequest, request: Request) -> schema.ActionResponse:
        """Close the app that waits on a link, and again for 5 minutes whenever it connects.

        What it reported in flight stays a hazard area until it is dismissed.
        """
        return port.refuse_app(asked.link_id, person_of(request))
