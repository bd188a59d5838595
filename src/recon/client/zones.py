"""Temporary zones: draw and end them, and those in force."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from recon.client.errors import OrderInvalidError
from recon.client.messages import AnswerMessage, TemporaryZoneStatus
from recon.client.order import not_finite
from recon.model.command import Refusal
from recon.model.geo import LatLon
from recon.model.temporary_zone import Circle, TemporaryZoneKind

if TYPE_CHECKING:
    from recon.client.http import Http


class _ZoneMessage(AnswerMessage, frozen=True, kw_only=True):
    zone: TemporaryZoneStatus | None


class ZoneCommands:
    """Temporary zones of a station."""

    def __init__(self, http: "Http") -> None:
        self._http = http

    async def draw(
        self,
        kind: TemporaryZoneKind,
        shape: Circle | Sequence[LatLon],
        reason: str,
        *,
        floor_m: float | None = None,
        ceiling_m: float | None = None,
        lasts_s: float | None = None,
    ) -> TemporaryZoneStatus | Refusal:
        """Draw a zone: a circle, or the corners of an outline; all is kept out of it at once.

        Without a ceiling, the usual one of its kind. Vehicles that are about to enter it are held.
        """
        request: dict[str, Any] = {
            "kind": kind.value,
            "reason": reason,
            "floor_m": floor_m,
            "ceiling_m": ceiling_m,
            "lasts_s": lasts_s,
        }
        if isinstance(shape, Circle):
            request["circle"] = {**_place(shape.centre), "radius_m": shape.radius_m}
        else:
            request["outline"] = [_place(corner) for corner in shape]
        fault = not_finite(request, "")
        if fault is not None:
            return Refusal("zone_form", fault)
        try:
            answer = await self._http.post("/api/zones", request, _ZoneMessage, "a temporary zone")
        except OrderInvalidError as problem:
            return Refusal("zone_form", str(problem))
        if answer.zone is not None:
            return answer.zone
        return answer.refusal or Refusal("zone_form", "accepted, but the zone is not in the answer")

    async def end(self, zone_id: int) -> Refusal | None:
        """End a zone; None on success. Nothing is sent, and nothing that was held resumes."""
        path = f"/api/zones/{zone_id}/end"
        answer = await self._http.post(path, None, AnswerMessage, "an answer to a zone's end")
        return answer.refusal

    async def in_force(self) -> tuple[TemporaryZoneStatus, ...]:
        """Return the zones in force, the oldest first."""
        kind = tuple[TemporaryZoneStatus, ...]
        return await self._http.get("/api/zones", kind, "temporary zones")


def _place(place: LatLon) -> dict[str, float]:
    return {"latitude_deg": place.latitude_deg, "longitude_deg": place.longitude_deg}
