"""Routes for the site's folder: layers, vehicles and the imaging drones' cameras."""

import asyncio

from fastapi import FastAPI, Request, Response

from recon.api import schema
from recon.api.import_route import add_import
from recon.api.pictures import frame_jpeg
from recon.api.responses import PROBLEMS, found
from recon.api.security import person_of
from recon.station.api_views.service import Service


def add_site_routes(app: FastAPI, service: Service) -> None:
    """Add all routes of this module."""
    _add_drawing(app, service)
    _add_vehicles(app, service)
    _add_calibration(app, service)


def _add_drawing(app: FastAPI, service: Service) -> None:
    @app.get("/api/site/drawing")
    async def drawing() -> schema.SiteDrawingView:
        """The site's layers with all corners, to be drawn on."""
        return await service.drawing.drawing()

    @app.post("/api/site/drawing/check")
    async def check(
        asked: schema.SiteDrawingRequest, request: Request
    ) -> schema.SiteDrawingResponse:
        """Check a drawing as the station would at its start; nothing is saved."""
        return await service.drawing.save(asked, person_of(request), is_check=True)

    @app.post("/api/site/drawing")
    async def save(
        asked: schema.SiteDrawingRequest, request: Request
    ) -> schema.SiteDrawingResponse:
        """Save the layers in the site's folder and bring them into force.

        Boundary, zones and pads change only while all vehicles are on the ground, by an
        administrator.
        """
        return await service.drawing.save(asked, person_of(request), is_check=False)

    @app.post("/api/site/drawing/undo")
    async def undo(asked: schema.SiteUndoRequest, request: Request) -> schema.SiteDrawingResponse:
        """Take back the newest change of the site."""
        return await service.drawing.undo(asked.revision, person_of(request))

    add_import(app, lambda: service.drawing)


def _add_vehicles(app: FastAPI, service: Service) -> None:
    @app.get("/api/site/vehicles")
    async def vehicles() -> schema.SiteVehiclesView:
        """The vehicles of the site's folder, also those that have never connected."""
        return await service.site_vehicles.vehicles()

    @app.post("/api/site/vehicles/check")
    async def check_vehicles(
        asked: schema.SiteVehiclesRequest, request: Request
    ) -> schema.SiteVehiclesResponse:
        """Check the vehicles as the station would at its start; nothing is saved."""
        return await service.site_vehicles.save(asked, person_of(request), is_check=True)

    @app.post("/api/site/vehicles")
    async def save_vehicles(
        asked: schema.SiteVehiclesRequest, request: Request
    ) -> schema.SiteVehiclesResponse:
        """Save the vehicles in the site's folder and bring them into force, by an administrator.

        The altitude reference and the number of a vehicle change only while it is on the ground.
        """
        return await service.site_vehicles.save(asked, person_of(request), is_check=False)


def _add_calibration(app: FastAPI, service: Service) -> None:
    @app.post("/api/site/calibration/freeze")
    async def freeze(asked: schema.FrozenFrameRequest) -> schema.FrozenFrameView:
        """Keep the newest frame of an imaging drone, for control points to be marked on."""
        return await service.calibration.freeze(asked.serial)

    @app.get("/api/site/calibration/frame.jpg", response_class=Response, responses=PROBLEMS)
    async def frozen(serial: str) -> Response:
        """The kept frame of an imaging drone."""
        frame = found(service.calibration.frame(serial), f"No frame of {serial!r} is kept")
        data = await asyncio.to_thread(frame_jpeg, frame)
        return Response(data, media_type="image/jpeg", headers={"X-Frame-Id": str(frame.id)})

    @app.post("/api/site/calibration/fit")
    async def fit(asked: schema.CalibrationRequest) -> schema.CalibrationView:
        """Solve the camera's pose by control points, with the residual of each; nothing is saved.

        Refused are fewer than four points, points on a line, and points that do not fit.
        """
        return await service.calibration.fit(asked)

    @app.post("/api/site/calibration")
    async def calibrate(
        asked: schema.CalibrationRequest, request: Request
    ) -> schema.CalibrationView:
        """Save the control points in the site's folder; the next frames are placed by them."""
        return await service.calibration.accept(asked, person_of(request))
