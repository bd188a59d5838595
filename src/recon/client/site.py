"""The site's layers and vehicles: read, checked, saved and undone, as in the console."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import msgspec

from recon.client.errors import OrderInvalidError
from recon.client.messages import AnswerMessage
from recon.client.order import not_finite
from recon.model.command import Refusal

if TYPE_CHECKING:
    from recon.client.http import Http

Layer = Literal["boundary", "keep_out", "height_zones", "landing_pads", "survey_regions"]


class SiteFeature(msgspec.Struct, frozen=True):
    """A feature: GeoJSON geometry of a polygon or a point, attributes as in the layer's file."""

    layer: Layer
    geometry: Mapping[str, Any]
    properties: Mapping[str, str | int | float | bool | None] = {}


class SiteDrawing(msgspec.Struct, frozen=True):
    """The layers in the site's folder."""

    revision: str
    """Revision of what was read: a change of an older revision is refused."""
    features: tuple[SiteFeature, ...]
    locked_reason: str | None
    """Why nothing can be saved; None if it can."""


class SiteVehicle(msgspec.Struct, frozen=True):
    """A vehicle of the site, connected or not; None leaves a key to the station's default."""

    serial: str
    name: str | None = None
    number: int | None = None
    camera: str | None = None
    """The name of a survey camera."""
    waypoint_altitude: Literal["wgs84", "takeoff"] | None = None
    """The app's altitude reference; without one missions are refused."""


class SiteVehicles(msgspec.Struct, frozen=True):
    """The vehicles in the site's folder."""

    revision: str
    """Revision of what was read: a change of an older revision is refused."""
    vehicles: tuple[SiteVehicle, ...]
    locked_reason: str | None
    """Why nothing can be saved; None if it can."""


class _VehiclesMessage(AnswerMessage, frozen=True, kw_only=True):
    vehicles: SiteVehicles | None


class _DrawingMessage(AnswerMessage, frozen=True, kw_only=True):
    drawing: SiteDrawing | None


class SiteCommands:
    """The site of a station."""

    def __init__(self, http: "Http") -> None:
        self._http = http

    async def drawing(self) -> SiteDrawing:
        """Return the layers, with all corners."""
        return await self._http.get("/api/site/drawing", SiteDrawing, "a site's layers")

    async def check(self, features: Sequence[SiteFeature], revision: str) -> Refusal | None:
        """Return why these features cannot be saved now; None if they can. Nothing is saved."""
        answer = await self._sent("/api/site/drawing/check", _request(features, revision))
        return answer if isinstance(answer, Refusal) else answer.refusal

    async def save(self, features: Sequence[SiteFeature], revision: str) -> SiteDrawing | Refusal:
        """Replace all layers with these features, in the folder and in force at once.

        Boundary, zones and pads change only while all vehicles are on the ground.
        """
        return _drawing(await self._sent("/api/site/drawing", _request(features, revision)))

    async def vehicles(self) -> SiteVehicles:
        """Return the vehicles of the site, connected or not."""
        return await self._http.get("/api/site/vehicles", SiteVehicles, "a site's vehicles")

    async def save_vehicles(
        self, vehicles: Sequence[SiteVehicle], revision: str
    ) -> SiteVehicles | Refusal:
        """Replace the vehicles of the site, in the folder and in force at once.

        Altitude reference and number of a vehicle change only while it is on the ground.
        """
        request = {"revision": revision, "vehicles": msgspec.to_builtins(vehicles)}
        try:
            answer = await self._http.post(
                "/api/site/vehicles", request, _VehiclesMessage, "an answer about the site"
            )
        except OrderInvalidError as problem:
            return Refusal("site_form", str(problem))
        if isinstance(answer, Refusal):
            return answer
        missing = "accepted, but the vehicles are not in the answer"
        return answer.vehicles or answer.refusal or Refusal("site_form", missing)

    async def undo(self, revision: str) -> SiteDrawing | Refusal:
        """Take back the newest save."""
        return _drawing(await self._sent("/api/site/drawing/undo", {"revision": revision}))

    async def _sent(self, path: str, request: dict[str, Any]) -> "_DrawingMessage | Refusal":
        fault = not_finite(request, "")
        if fault is not None:
            return Refusal("site_form", fault)
        try:
            return await self._http.post(path, request, _DrawingMessage, "an answer about the site")
        except OrderInvalidError as problem:
            return Refusal("site_form", str(problem))


def _request(features: Sequence[SiteFeature], revision: str) -> dict[str, Any]:
    return {"revision": revision, "features": msgspec.to_builtins(features)}


def _drawing(answer: "_DrawingMessage | Refusal") -> SiteDrawing | Refusal:
    if isinstance(answer, Refusal):
        return answer
    if answer.drawing is not None:
        return answer.drawing
    return answer.refusal or Refusal("site_form", "accepted, but the layers are not in the answer")
