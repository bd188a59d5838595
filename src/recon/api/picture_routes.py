"""Routes for pictures: camera frames, ground images, shade and predicted sun; sun at a place."""

import asyncio
from typing import Annotated, Literal

from fastapi import FastAPI, Query, Response

from recon.api import pictures
from recon.api.port import StationPort
from recon.api.responses import PNG, PROBLEMS, found, png
from recon.api.schema import SunAtView, UpwindView

Form = Annotated[
    Literal["picture", "values"],
    Query(alias="as", description="in colours, or grey values of one pixel a cell"),
]
NO_GROUND_IMAGE = "No ground image yet: no camera frame has been projected"
NO_SHADE = "No shade map yet: no ground image has been read"


def add_picture_routes(app: FastAPI, port: StationPort) -> None:
    """Add all routes of this module."""
    _add_camera(app, port)
    _add_sun(app, port)


def _add_camera(app: FastAPI, port: StationPort) -> None:
    jpeg: dict[int | str, dict[str, object]] = {200: {"content": {"image/jpeg": {}}}}
    tiff: dict[int | str, dict[str, object]] = {200: {"content": {"image/tiff": {}}}}

    @app.get("/api/vehicle/frame.jpg", response_class=Response, responses=PROBLEMS | jpeg)
    async def frame(serial: str) -> Response:
        """A vehicle's newest camera frame, unchanged."""
        newest = found(port.frame(serial), f"No frame received from {serial!r}")
        data = await asyncio.to_thread(pictures.frame_jpeg, newest)
        return Response(data, media_type="image/jpeg", headers={"X-Frame-Id": str(newest.id)})

    @app.get("/api/ground-image.png", response_class=Response, responses=PROBLEMS | PNG)
    async def ground_png() -> Response:
        """The newest ground image; its corners are in the state."""
        newest = found(await asyncio.to_thread(port.ground_image), NO_GROUND_IMAGE)
        return png(await asyncio.to_thread(pictures.ground_png, newest), newest.frame_id)

    @app.get("/api/ground-image.tif", response_class=Response, responses=PROBLEMS | tiff)
    async def ground_tiff() -> Response:
        """The newest ground image as a GeoTIFF file."""
        newest = found(await asyncio.to_thread(port.ground_image), NO_GROUND_IMAGE)
        data = await asyncio.to_thread(port.geotiff, newest)
        name = f'attachment; filename="recon-ground-{newest.frame_id}.tif"'
        return Response(data, media_type="image/tiff", headers={"Content-Disposition": name})


def _add_sun(app: FastAPI, port: StationPort) -> None:
    @app.get("/api/shade.png", response_class=Response, responses=PROBLEMS | PNG)
    async def shade(form: Form = "picture") -> Response:
        """The newest shade map; its corners are in the state. Values: grey is transmittance."""
        number, newest, seen = found(port.shade(), NO_SHADE)
        if form == "picture":
            return png(await asyncio.to_thread(pictures.shade_png, newest, seen), number)
        return png(await asyncio.to_thread(pictures.shade_values_png, newest), number)

    @app.get("/api/forecast.png", response_class=Response, responses=PROBLEMS | PNG)
    async def forecast(
        lead_s: Annotated[float, Query(ge=0.0, le=86_400.0)] = 0.0, form: Form = "picture"
    ) -> Response:
        """Probability of sun at the nearest of the forecast's leads. Values: grey is probability;
        transparent is beyond the horizon."""
        number, newest = found(port.forecast(), NO_SHADE)
        is_picture = form == "picture"
        draw = pictures.forecast_png if is_picture else pictures.forecast_values_png
        response = png(await asyncio.to_thread(draw, newest, lead_s), number)
        nearest_s = newest.lead_s[pictures.nearest_lead(newest, lead_s)]
        response.headers["X-Lead-S"] = f"{nearest_s:g}"
        return response

    @app.get("/api/sun-at", responses=PROBLEMS)
    async def sun_at(
        latitude_deg: Annotated[float, Query(ge=-90.0, le=90.0)],
        longitude_deg: Annotated[float, Query(ge=-180.0, le=180.0)],
    ) -> SunAtView:
        """The light at a place now, and when it changes next."""
        return found(await asyncio.to_thread(port.sun_at, latitude_deg, longitude_deg), NO_SHADE)

    @app.get("/api/upwind-place")
    async def upwind_place(serial: str | None = None, region: str | None = None) -> UpwindView:
        """Where an imaging drone sees most of the shade that comes over a region.

        It flies there by a goto. By default the site's first imaging drone, and the region of the
        running survey, or all of the site's.
        """
        return await asyncio.to_thread(port.upwind_place, serial, region)
