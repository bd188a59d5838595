"""The newest camera frames, shade map and forecast of a station."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar
from urllib.parse import quote

from recon.client.errors import BadAnswerError
from recon.model.errors import ReconError

if TYPE_CHECKING:
    from recon.client.http import Http
    from recon.model.shade import ShadeMap, SunForecast

Map = TypeVar("Map")


@dataclass(frozen=True, slots=True)
class CameraFrame:
    """A camera frame as a JPEG file; `id` is that of the vehicle's telemetry."""

    id: int
    jpeg: bytes


class PictureCommands:
    """PictureCommands and maps; each raises `RequestRefusedError` while there is none yet."""

    def __init__(self, http: "Http") -> None:
        self._http = http

    async def frame(self, serial: str) -> CameraFrame:
        """Return a vehicle's newest camera frame; an app's own JPEG is unchanged."""
        path = f"/api/vehicle/frame.jpg?serial={quote(serial, safe='')}"
        jpeg, number = await self._http.get_picture(path)
        return CameraFrame(number, jpeg)

    async def shade(self) -> "ShadeMap":
        """Return the newest shade map."""
        # Imported here: commands that need no map need not wait for numpy.
        from recon.model.map_archive import read_shade

        return await self._map("/api/shade.npz", read_shade)

    async def forecast(self) -> "SunForecast":
        """Return the newest forecast of sun."""
        from recon.model.map_archive import read_forecast

        return await self._map("/api/forecast.npz", read_forecast)

    async def _map(self, path: str, read: Callable[[bytes], Map]) -> Map:
        data, _number = await self._http.get_picture(path)
        try:
            return read(data)
        except ReconError as problem:
            raise BadAnswerError(f"{path}: {problem}; is this a Recon station?") from problem
