"""Routes that begin an operation: a fleet return, a side-step, a relief."""

from fastapi import FastAPI, Request

from recon.api import schema
from recon.api.security import person_of
from recon.model.event import ReliefOrdered, SideStepOrdered
from recon.station.api_views.service import Service
from recon.station.operations.imager_motion import side_step as side_steps
from recon.station.operations.imager_relief import commands as imager_relief_commands


def add_operation_routes(app: FastAPI, service: Service) -> None:
    """Add all routes of this module."""
    driver = service.driver

    @app.post("/api/fleet-return")
    async def fleet_return(
        asked: schema.FleetReturnRequest, request: Request
    ) -> schema.OrderResponse:
        """Return vehicles home by landing missions, each at a height of its own.

        Each result is the hold that it starts with; `fleet_return` in the state shows the progress.
        """
        by = person_of(request)
        return service.orders.fleet_return(asked.serials, by, asked.given_at_ns)

    @app.post("/api/side-step")
    async def side_step(asked: schema.SideStepRequest, request: Request) -> schema.ActionResponse:
        """Have an imaging drone fly 25 m aside and back, so that a flat scene is decided.

        Guidance has it meanwhile; `side_step` in the state shows the progress.
        """
        by = person_of(request)
        event = SideStepOrdered(by.label, asked.given_at_ns, by.name, serial=asked.serial)
        refusal = side_steps.refusal(driver.station, event, driver.now_ns())
        return service.decided(event, refusal)

    @app.post("/api/imager-relief")
    async def imager_relief(asked: schema.ReliefRequest, request: Request) -> schema.ActionResponse:
        """Have an imaging drone take the place of another, or return to its own.

        Guidance has it meanwhile; once its shade maps show the ground, the other one is
        recalled. `imager_relief` in the state shows the progress.
        """
        by, spare = person_of(request), asked.spare or asked.serial
        event = ReliefOrdered(
            asked.serial, spare, by.label, asked.takeoff, asked.given_at_ns, by.name
        )
        refusal = imager_relief_commands.refusal(driver.station, event, driver.now_ns())
        return service.decided(event, refusal)
