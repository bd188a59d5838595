"""Routes for pictures: camera frames, ground images, shade and predicted sun; sun at a place."""

import asyncio
from datetime import UTC, datetime
from typing import Annotated, Literal

from fastapi import FastAPI, Query, Response

from recon.api import pictures
from recon.api.responses import ARRAYS, PNG, PROBLEMS, arrays, found, png
from recon.api.schema import SunAtView, UpwindView
from recon.model.imagery import GroundImage
from recon.model.map_archive import forecast_archive, shade_archive
from recon.model.shade import MaskMap, ShadeMap
from recon.model.units import ns_to_seconds
from recon.record.raster.geotiff import geotiff_bytes
from recon.site import Site
from recon.station.api_views.imaging_views import sun_at_view, upwind_view
from recon.station.api_views.service import Service
from recon.station.state.imaging import ShadePipeline

Form = Annotated[
    Literal["picture", "values"],
    Query(alias="as", description="in colours, or grey values of one pixel a cell"),
]
NO_GROUND_IMAGE = "No ground image yet: no camera frame has been projected"
NO_SHADE = "No shade map yet: no ground image has been read"


def add_picture_routes(app: FastAPI, service: Service) -> None:
    """Add all routes of this module."""
    _add_camera(app, service)
    _add_sun(app, service)
    _add_arrays(app, service)


def _add_camera(app: FastAPI, service: Service) -> None:
    jpeg: dict[int | str, dict[str, object]] = {200: {"content": {"image/jpeg": {}}}}
    tiff: dict[int | str, dict[str, object]] = {200: {"content": {"image/tiff": {}}}}

    @app.get("/api/vehicle/frame.jpg", response_class=Response, responses=PROBLEMS | jpeg)
    async def frame(serial: str) -> Response:
        """A vehicle's newest camera frame, unchanged."""
        newest = found(service.frame(serial), f"No frame received from {serial!r}")
        data = await asyncio.to_thread(pictures.frame_jpeg, newest)
        return Response(data, media_type="image/jpeg", headers={"X-Frame-Id": str(newest.id)})

    @app.get("/api/ground-image.png", response_class=Response, responses=PROBLEMS | PNG)
    async def ground_png() -> Response:
        """The newest ground image; its corners are in the state."""
        newest = found(await asyncio.to_thread(service.ground_image), NO_GROUND_IMAGE)
        return png(await asyncio.to_thread(pictures.ground_png, newest), newest.frame_id)

    @app.get("/api/ground-image.tif", response_class=Response, responses=PROBLEMS | tiff)
    async def ground_tiff() -> Response:
        """The newest ground image as a GeoTIFF file."""
        newest = found(await asyncio.to_thread(service.ground_image), NO_GROUND_IMAGE)
        data = await asyncio.to_thread(_geotiff, service.site, newest)
        name = f'attachment; filename="recon-ground-{newest.frame_id}.tif"'
        return Response(data, media_type="image/tiff", headers={"Content-Disposition": name})


def _add_sun(app: FastAPI, service: Service) -> None:
    @app.get("/api/shade.png", response_class=Response, responses=PROBLEMS | PNG)
    async def shade(form: Form = "picture") -> Response:
        """The newest shade map; its corners are in the state. Values: grey is transmittance."""
        number, newest, seen = found(newest_shade(service.driver.station.shade), NO_SHADE)
        if form == "picture":
            return png(await asyncio.to_thread(pictures.shade_png, newest, seen), number)
        return png(await asyncio.to_thread(pictures.shade_values_png, newest), number)

    @app.get("/api/forecast.png", response_class=Response, responses=PROBLEMS | PNG)
    async def forecast(
        lead_s: Annotated[float, Query(ge=0.0, le=86_400.0)] = 0.0, form: Form = "picture"
    ) -> Response:
        """Probability of sun at the nearest of the forecast's leads. Values: grey is probability;
        transparent is beyond the horizon."""
        line = service.driver.station.shade
        newest = found(line.sun, NO_SHADE)
        is_picture = form == "picture"
        draw = pictures.forecast_png if is_picture else pictures.forecast_values_png
        response = png(await asyncio.to_thread(draw, newest, lead_s), line.number)
        nearest_s = newest.lead_s[pictures.nearest_lead(newest, lead_s)]
        response.headers["X-Lead-S"] = f"{nearest_s:g}"
        return response

    @app.get("/api/sun-at", responses=PROBLEMS)
    async def sun_at(
        latitude_deg: Annotated[float, Query(ge=-90.0, le=90.0)],
        longitude_deg: Annotated[float, Query(ge=-180.0, le=180.0)],
    ) -> SunAtView:
        """The light at a place now, and when it changes next."""
        station, now_ns = service.driver.station, service.driver.now_ns()
        place_deg = (latitude_deg, longitude_deg)
        return found(await asyncio.to_thread(sun_at_view, station, place_deg, now_ns), NO_SHADE)

    @app.get("/api/upwind-place")
    async def upwind_place(serial: str | None = None, region: str | None = None) -> UpwindView:
        """Where an imaging drone sees most of the shade that comes over a region.

        It flies there by a goto. By default the site's first imaging drone, and the region of the
        running survey, or all of the site's.
        """
        station, now_ns = service.driver.station, service.driver.now_ns()
        return await asyncio.to_thread(upwind_view, station, service.site, serial, region, now_ns)


def _add_arrays(app: FastAPI, service: Service) -> None:
    @app.get("/api/shade.npz", response_class=Response, responses=PROBLEMS | ARRAYS)
    async def shade_arrays() -> Response:
        """The newest shade map as numpy arrays, each value as it is."""
        number, newest, _seen = found(newest_shade(service.driver.station.shade), NO_SHADE)
        return arrays(await asyncio.to_thread(shade_archive, newest), number)

    @app.get("/api/forecast.npz", response_class=Response, responses=PROBLEMS | ARRAYS)
    async def forecast_arrays() -> Response:
        """The newest forecast as numpy arrays: every lead, in 255ths, and each cell's horizon."""
        line = service.driver.station.shade
        newest = found(line.sun, NO_SHADE)
        return arrays(await asyncio.to_thread(forecast_archive, newest), line.number)


def newest_shade(line: ShadePipeline) -> tuple[int, ShadeMap, MaskMap] | None:
    """Return the number of the newest shade map, the map, and its cells in view."""
    if line.shade is None:
        return None
    return line.number, line.shade, line.shade.valid if line.seen is None else line.seen


def _geotiff(site: Site, image: GroundImage) -> bytes:
    imager = site.imagers.get(image.serial)
    solution = None if imager is None else imager.solution
    rms_px = None if solution is None else solution.rms_px
    captured = datetime.fromtimestamp(ns_to_seconds(image.captured_at_ns), UTC)
    return geotiff_bytes(image, captured_utc=captured.isoformat(), rms_px=rms_px)
