"""Routes for one vehicle, an alarm or the separation holds."""

from typing import Literal

from fastapi import FastAPI, HTTPException, Request

from recon.api import schema
from recon.api.permissions import authority_role, require, separation_hold_role
from recon.api.responses import PROBLEMS, found
from recon.api.security import person_of
from recon.model.control import AuthorityHolder
from recon.model.event import (
    AlarmAcknowledged,
    AuthorityTaken,
    HazardDismissed,
    PreflightOverridden,
    SeparationHoldSwitched,
)
from recon.station.api_views.service import Service
from recon.station.api_views.vehicle_views import preflight_view
from recon.station.control import handover
from recon.station.control import preflight as preflight_override
from recon.station.traffic.known_traffic import is_dismissible


def add_vehicle_routes(app: FastAPI, service: Service) -> None:
    """Add all routes of this module."""
    _add_hazards(app, service)
    _add_readiness(app, service)


def _add_hazards(app: FastAPI, service: Service) -> None:
    driver = service.driver

    @app.post("/api/vehicle/hazard/dismiss", responses=PROBLEMS, status_code=204)
    async def dismiss_hazard(serial: str, request: Request) -> None:
        """Dismiss the hazard area of a lost vehicle that has been located.

        A vehicle without a serial is named by its hazard area's `dismissal_name`.
        """
        if not is_dismissible(driver.station, serial, driver.now_ns()):
            raise HTTPException(
                404, f"No hazard area for {serial!r}: it is connected, landed or unknown"
            )
        driver.handle(HazardDismissed(serial, person_of(request).label))

    @app.post("/api/separation-hold/{switch}", status_code=204)
    async def separation_hold(switch: Literal["on", "off"], request: Request) -> None:
        """Switch the separation holds of the watchdogs on or off; off, an alarm stays active."""
        person = person_of(request)
        require(person, separation_hold_role(switch))
        driver.handle(SeparationHoldSwitched(switch == "on", person.label))

    @app.post("/api/alarms/{alarm_id}/acknowledge", responses=PROBLEMS, status_code=204)
    async def acknowledge(alarm_id: int, request: Request) -> None:
        """Acknowledge an alarm; it stays until its cause ends."""
        if alarm_id not in driver.station.alarms.alarms:
            raise HTTPException(404, f"Alarm {alarm_id} not found")
        driver.handle(AlarmAcknowledged(alarm_id, person_of(request).label))


def _add_readiness(app: FastAPI, service: Service) -> None:
    driver = service.driver

    @app.post("/api/vehicle/authority")
    async def authority(
        serial: str, asked: schema.AuthorityRequest, request: Request
    ) -> schema.ActionResponse:
        """Transfer control authority: from now on only `holder` may set the vehicle in motion.

        The person who takes it for the operator, or gives it to guidance, operates the vehicle.
        """
        person, holder = person_of(request), AuthorityHolder(asked.holder)
        require(person, authority_role(asked.holder))
        event = AuthorityTaken(serial, holder, person.label, person.name, asked.take_over)
        return service.commanded(event, handover.refusal(driver.station, event, driver.now_ns()))

    @app.get("/api/vehicle/preflight", responses=PROBLEMS)
    async def preflight(serial: str) -> schema.PreflightView:
        """A vehicle's preflight checklist as of now."""
        view = preflight_view(driver.station, serial, driver.now_ns())
        return found(view, f"No vehicle with serial {serial!r}")

    @app.post("/api/vehicle/preflight/override")
    async def override_preflight(
        serial: str, asked: schema.PreflightOverrideRequest, request: Request
    ) -> schema.ActionResponse:
        """Allow missions although the checklist is not passed, until the vehicle has landed.

        Reason and client are written to the audit.
        """
        event = PreflightOverridden(serial, person_of(request).label, asked.reason)
        return service.commanded(event, preflight_override.refusal(driver.station, event))
