"""Routes to the shade map and the forecast of sun."""

import asyncio
from typing import Annotated, Literal

from fastapi import FastAPI, Query, Response

from recon.api import sun_pictures
from recon.api.answering import PNG, PROBLEMS, found
from recon.api.port import StationPort

Form = Annotated[
    Literal["picture", "values"],
    Query(alias="as", description="in colours, or grey values of one pixel a cell"),
]
NO_SHADE = "no shade has been read from a frame yet"


def add_sun_routes(app: FastAPI, port: StationPort) -> None:
    """Add them."""

    @app.get("/api/shade.png", response_class=Response, responses=PROBLEMS | PNG)
    async def shade(form: Form = "picture") -> Response:
        """The newest shade map; its corners are in the state. Values: grey is transmittance."""
        number, newest = found(port.shade(), NO_SHADE)
        is_picture = form == "picture"
        draw = sun_pictures.shade_png if is_picture else sun_pictures.shade_values_png
        return _png(await asyncio.to_thread(draw, newest), number)

    @app.get("/api/forecast.png", response_class=Response, responses=PROBLEMS | PNG)
    async def forecast(
        lead_s: Annotated[float, Query(ge=0.0, le=86_400.0)] = 0.0, form: Form = "picture"
    ) -> Response:
        """How likely sun is, at the nearest of the forecast's leads. Values: grey is probability;
        transparent is beyond the horizon."""
        number, newest = found(port.forecast(), NO_SHADE)
        is_picture = form == "picture"
        draw = sun_pictures.forecast_png if is_picture else sun_pictures.forecast_values_png
        response = _png(await asyncio.to_thread(draw, newest, lead_s), number)
        told_s = newest.lead_s[sun_pictures.nearest_lead(newest, lead_s)]
        response.headers["X-Lead-S"] = f"{told_s:g}"
        return response


def _png(data: bytes, number: int) -> Response:
    """A picture with the number it has in the state, under the name that frames have theirs."""
    return Response(data, media_type="image/png", headers={"X-Frame-Id": str(number)})
