"""Routes for orders and operator commands: orders, fleet return, hazards, authority, preflight.

A serial may be any text, also `..` and `A/B`, which no path carries unchanged through every client
and server: it is a query parameter.
"""

from typing import Literal

from fastapi import FastAPI, HTTPException, Request

from recon.api import schema
from recon.api.permissions import authority_role, order_role, require, separation_hold_role
from recon.api.port import StationPort
from recon.api.responses import PROBLEMS, found, given_at_ns
from recon.api.schema import requests
from recon.api.security import person_of
from recon.model.command import (
    Body,
    FlyMission,
    GoTo,
    HoldPosition,
    Hover,
    LandNow,
    Nudge,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.control import AuthorityHolder
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint


def add_order_routes(app: FastAPI, port: StationPort) -> None:
    """Add all routes of this module."""
    _add_orders(app, port)
    _add_operations(app, port)
    _add_hazards(app, port)
    _add_readiness(app, port)


def _add_orders(app: FastAPI, port: StationPort) -> None:
    @app.post("/api/orders")
    async def order(asked: schema.OrderRequest, request: Request) -> schema.OrderResponse:
        """Give one order to each named vehicle; refusals are among the results."""
        require(person_of(request), order_role(asked.order.kind))
        return port.order(
            asked.serials,
            to_body(asked.order),
            takeoff=asked.takeoff,
            by=person_of(request),
            owner=asked.owner,
            given_at_ns=given_at_ns(asked.given_at_unix_ms),
        )

    @app.post("/api/orders/check")
    async def check(asked: schema.OrderRequest, request: Request) -> schema.OrderResponse:
        """Return what the gate would answer to an order now. Nothing is sent; each id is 0."""
        require(person_of(request), order_role(asked.order.kind))
        return port.check(
            asked.serials,
            to_body(asked.order),
            takeoff=asked.takeoff,
            by=person_of(request),
            owner=asked.owner,
            given_at_ns=given_at_ns(asked.given_at_unix_ms),
        )

    @app.post("/api/all-stop")
    async def all_stop(request: Request) -> schema.OrderResponse:
        """Hold every vehicle in flight, identified or not. Never stops motors.

        Until released, no order sets a vehicle in motion, not one by guidance either.
        """
        return port.all_stop(person_of(request))

    @app.post("/api/all-stop/release")
    async def release_stop(
        asked: schema.StopReleaseRequest, request: Request
    ) -> schema.ActionResponse:
        """Release vehicles from the all stop. Nothing is sent to them, and nothing resumes."""
        return port.release_stop(asked.serials, person_of(request))


def _add_operations(app: FastAPI, port: StationPort) -> None:
    @app.post("/api/fleet-return")
    async def fleet_return(
        asked: schema.FleetReturnRequest, request: Request
    ) -> schema.OrderResponse:
        """Return vehicles home by landing missions, each at a height of its own.

        Each result is the hold that it starts with; `fleet_return` in the state shows the progress.
        """
        given_ns = given_at_ns(asked.given_at_unix_ms)
        return port.fleet_return(asked.serials, person_of(request), given_ns)

    @app.post("/api/look-aside")
    async def look_aside(asked: schema.LookAsideRequest, request: Request) -> schema.ActionResponse:
        """Have an imaging drone fly 25 m aside and back, so that a flat scene is decided.

        Guidance has it meanwhile; `look_aside` in the state shows the progress.
        """
        return port.look_aside(
            asked.serial, person_of(request), given_at_ns(asked.given_at_unix_ms)
        )

    @app.post("/api/imager-relief")
    async def imager_relief(asked: schema.ReliefRequest, request: Request) -> schema.ActionResponse:
        """Have an imaging drone take the place of another, or return to its own.

        Guidance has it meanwhile; once its shade maps show the ground, the other one is called
        home. `imager_relief` in the state shows the progress.
        """
        return port.relieve(
            asked.serial,
            asked.spare or asked.serial,
            takeoff=asked.takeoff,
            by=person_of(request),
            given_at_ns=given_at_ns(asked.given_at_unix_ms),
        )


def _add_hazards(app: FastAPI, port: StationPort) -> None:
    @app.post("/api/vehicle/hazard/dismiss", responses=PROBLEMS, status_code=204)
    async def dismiss_hazard(serial: str, request: Request) -> None:
        """Dismiss the hazard area of a lost vehicle that has been located.

        A vehicle without a serial is named by its hazard area's `dismissal_name`.
        """
        if not port.dismiss_hazard(serial, person_of(request)):
            raise HTTPException(
                404, f"No hazard area for {serial!r}: it is connected, landed or unknown"
            )

    @app.post("/api/separation-hold/{switch}", status_code=204)
    async def separation_hold(switch: Literal["on", "off"], request: Request) -> None:
        """Switch the separation holds of the watchdogs on or off; off, an alarm stays active."""
        require(person_of(request), separation_hold_role(switch))
        port.switch_separation_hold(switch == "on", person_of(request))

    @app.post("/api/alarms/{alarm_id}/acknowledge", responses=PROBLEMS, status_code=204)
    async def acknowledge(alarm_id: int, request: Request) -> None:
        """Acknowledge an alarm; it stays until its cause ends."""
        if not port.acknowledge(alarm_id, person_of(request)):
            raise HTTPException(404, f"Alarm {alarm_id} not found")


def _add_readiness(app: FastAPI, port: StationPort) -> None:
    @app.post("/api/vehicle/authority")
    async def authority(
        serial: str, asked: schema.AuthorityRequest, request: Request
    ) -> schema.ActionResponse:
        """Transfer control authority: from now on only `holder` may set the vehicle in motion.

        The person who takes it for the operator, or gives it to guidance, operates the vehicle.
        """
        person = person_of(request)
        require(person, authority_role(asked.holder))
        holder = AuthorityHolder(asked.holder)
        return port.take_authority(serial, holder, person, takes_over=asked.take_over)

    @app.get("/api/vehicle/preflight", responses=PROBLEMS)
    async def preflight(serial: str) -> schema.PreflightView:
        """A vehicle's preflight checklist as of now."""
        return found(port.preflight(serial), f"No vehicle with serial {serial!r}")

    @app.post("/api/vehicle/preflight/override")
    async def override_preflight(
        serial: str, asked: schema.PreflightOverrideRequest, request: Request
    ) -> schema.ActionResponse:
        """Allow missions although the checklist is not passed, until the vehicle has landed.

        Reason and client are written to the audit.
        """
        return port.override_preflight(serial, asked.reason, person_of(request))


def to_body(order: schema.AnyOrder) -> Body:
    """Return the body of an order; the gate decides whether it may be executed."""
    match order:
        case requests.HoverOrder():
            return Hover()
        case requests.LandOrder():
            return LandNow()
        case requests.ReturnHomeOrder():
            return ReturnHome()
        case requests.CameraStartOrder():
            return StartCamera(fps_hz=order.fps_hz)
        case requests.CameraStopOrder():
            return StopCamera()
        case requests.MissionOrder():
            return FlyMission(_mission(order))
        case requests.StickOrder():
            return _stick(order)
        case requests.GoToOrder():
            return _goto(order)
        case requests.NudgeOrder():
            return Nudge(**order.model_dump(exclude={"kind"}))
        case requests.HoldPositionOrder():
            return HoldPosition()


def _mission(order: requests.MissionOrder) -> Mission:
    return Mission(
        waypoints=tuple(Waypoint(**waypoint.model_dump()) for waypoint in order.waypoints),
        land_at_end=order.land_at_end,
        curved=order.curved,
    )


def _goto(order: requests.GoToOrder) -> GoTo:
    return GoTo(
        target=LatLon(order.latitude_deg, order.longitude_deg),
        height_above_takeoff_m=order.height_above_takeoff_m,
        speed_mps=order.speed_mps,
        yaw_deg=order.yaw_deg,
    )


def _stick(order: requests.StickOrder) -> VirtualStick:
    return VirtualStick(
        frame=StickFrame(order.frame),
        yaw_deg=order.yaw_deg,
        velocity_x_mps=order.velocity_x_mps,
        velocity_y_mps=order.velocity_y_mps,
        height_above_takeoff_m=order.height_above_takeoff_m,
        timeout_s=order.timeout_s,
    )
