"""Routes for the site's folder: layers, vehicles and the imaging drones' cameras."""

import asyncio
from collections.abc import Callable
from typing import Annotated, Protocol

from fastapi import FastAPI, Query, Request, Response

from recon.api import schema
from recon.api.pictures import frame_jpeg
from recon.api.port import StationPort
from recon.api.responses import PROBLEMS, found
from recon.api.security import person_of


def add_site_routes(app: FastAPI, port: StationPort) -> None:
    """Add all routes of this module."""
    _add_drawing(app, port)
    _add_vehicles(app, port)
    _add_calibration(app, port)


def _add_drawing(app: FastAPI, port: StationPort) -> None:
    @app.get("/api/site/drawing")
    async def drawing() -> schema.SiteDrawingView:
        """The site's layers with all corners, to be drawn on."""
        return await port.site_folder().drawing()

    @app.post("/api/site/drawing/check")
    async def check(
        asked: schema.SiteDrawingRequest, request: Request
    ) -> schema.SiteDrawingResponse:
        """Check a drawing as the station would at its start; nothing is saved."""
        return await port.site_folder().save(asked, person_of(request), is_check=True)

    @app.post("/api/site/drawing")
    async def save(
        asked: schema.SiteDrawingRequest, request: Request
    ) -> schema.SiteDrawingResponse:
        """Save the layers in the site's folder and bring them into force.

        Boundary, zones and pads change only while all vehicles are on the ground, by an
        administrator.
        """
        return await port.site_folder().save(asked, person_of(request), is_check=False)

    @app.post("/api/site/drawing/undo")
    async def undo(asked: schema.SiteUndoRequest, request: Request) -> schema.SiteDrawingResponse:
        """Take back the newest change of the site."""
        return await port.site_folder().undo(asked.revision, person_of(request))

    add_import(app, port.site_folder)


class Importing(Protocol):
    """What reads files with shapes."""

    async def import_features(self, name: str, data: bytes) -> schema.ImportedView:
        """Return the polygons and points of a file, or why it is refused."""
        ...


def add_import(app: FastAPI, importing: Callable[[], Importing]) -> None:
    """Add the route that reads a file."""

    @app.post("/api/site/import")
    async def import_file(
        request: Request, name: Annotated[str, Query(max_length=200)]
    ) -> schema.ImportedView:
        """Read polygons and points of a KML, KMZ, Shapefile (zip), GeoPackage or GeoJSON file.

        The body is the file. Nothing is saved.
        """
        return await importing().import_features(name, await request.body())


def _add_vehicles(app: FastAPI, port: StationPort) -> None:
    @app.get("/api/site/vehicles")
    async def vehicles() -> schema.SiteVehiclesView:
        """The vehicles of the site's folder, also those that have never connected."""
        return await port.site_vehicles().vehicles()

    @app.post("/api/site/vehicles/check")
    async def check_vehicles(
        asked: schema.SiteVehiclesRequest, request: Request
    ) -> schema.SiteVehiclesResponse:
        """Check the vehicles as the station would at its start; nothing is saved."""
        return await port.site_vehicles().save(asked, person_of(request), is_check=True)

    @app.post("/api/site/vehicles")
    async def save_vehicles(
        asked: schema.SiteVehiclesRequest, request: Request
    ) -> schema.SiteVehiclesResponse:
        """Save the vehicles in the site's folder and bring them into force, by an administrator.

        The altitude reference and the number of a vehicle change only while it is on the ground.
        """
        return await port.site_vehicles().save(asked, person_of(request), is_check=False)


def _add_calibration(app: FastAPI, port: StationPort) -> None:
    @app.post("/api/site/calibration/freeze")
    async def freeze(asked: schema.FrozenFrameRequest) -> schema.FrozenFrameView:
        """Keep the newest frame of an imaging drone, for control points to be marked on."""
        return await port.calibration().freeze(asked.serial)

    @app.get("/api/site/calibration/frame.jpg", response_class=Response, responses=PROBLEMS)
    async def frozen(serial: str) -> Response:
        """The kept frame of an imaging drone."""
        frame = found(port.calibration().frame(serial), f"No frame of {serial!r} is kept")
        data = await asyncio.to_thread(frame_jpeg, frame)
        return Response(data, media_type="image/jpeg", headers={"X-Frame-Id": str(frame.id)})

    @app.post("/api/site/calibration/fit")
    async def fit(asked: schema.CalibrationRequest) -> schema.CalibrationView:
        """Solve the camera's pose by control points, with the residual of each; nothing is saved.

        Refused are fewer than four points, points on a line, and points that do not fit.
        """
        return await port.calibration().fit(asked)

    @app.post("/api/site/calibration")
    async def calibrate(
        asked: schema.CalibrationRequest, request: Request
    ) -> schema.CalibrationView:
        """Save the control points in the site's folder; the next frames are placed by them."""
        return await port.calibration().accept(asked, person_of(request))
