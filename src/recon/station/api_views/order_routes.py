"""Routes for orders, and for the all stop.

A serial may be any text, also `..` and `A/B`, which no path carries unchanged through every client
and server: it is a query parameter, here and in all other routes.
"""

from fastapi import FastAPI, Request

from recon.api import schema
from recon.api.permissions import order_role, require
from recon.api.security import person_of
from recon.model.event import OperatorOrder, StopReleased
from recon.station.api_views.order_service import order_of
from recon.station.api_views.service import Service
from recon.station.control import stop_latch


def add_order_routes(app: FastAPI, service: Service) -> None:
    """Add all routes of this module."""
    _add_orders(app, service)
    _add_all_stop(app, service)


def _add_orders(app: FastAPI, service: Service) -> None:
    @app.post("/api/orders")
    async def order(asked: schema.OrderRequest, request: Request) -> schema.OrderResponse:
        """Give one order to each named vehicle; refusals are among the results."""
        return service.orders.give(asked.serials, _order(asked, request))

    @app.post("/api/orders/check")
    async def check(asked: schema.OrderRequest, request: Request) -> schema.OrderResponse:
        """Return what the gate would answer to an order now. Nothing is sent; each id is 0."""
        return service.orders.check(asked.serials, _order(asked, request))


def _order(asked: schema.OrderRequest, request: Request) -> OperatorOrder:
    by = person_of(request)
    require(by, order_role(asked.order.kind))
    return order_of(
        asked.order.body(),
        by,
        takeoff=asked.takeoff,
        owner=asked.owner,
        given_at_ns=asked.given_at_ns,
    )


def _add_all_stop(app: FastAPI, service: Service) -> None:
    @app.post("/api/all-stop")
    async def all_stop(request: Request) -> schema.OrderResponse:
        """Hold every vehicle in flight, identified or not. Never stops motors.

        Until released, no order sets a vehicle in motion, not one by guidance either.
        """
        return service.orders.all_stop(person_of(request))

    @app.post("/api/all-stop/release")
    async def release_stop(
        asked: schema.StopReleaseRequest, request: Request
    ) -> schema.ActionResponse:
        """Release vehicles from the all stop. Nothing is sent to them, and nothing resumes."""
        serials = None if asked.serials is None else tuple(dict.fromkeys(asked.serials))
        event = StopReleased(serials, person_of(request).label)
        return service.commanded(event, stop_latch.refusal(service.driver.station, event))
