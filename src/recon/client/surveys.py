"""Commands to surveys, and their status."""

from collections.abc import Callable, Mapping, Sequence
from datetime import date
from typing import TYPE_CHECKING, Any, Literal
from urllib.parse import quote

import msgspec

from recon.client.messages import AnswerMessage
from recon.model.command import Refusal

if TYPE_CHECKING:
    from recon.client.http import Http

SurveyPhaseName = Literal["planning", "refused", "created", "running", "paused", "aborted", "done"]
WhenDoneName = Literal["return_home", "hover"]


class SurveyProgress(msgspec.Struct, frozen=True):
    """Areas by counted cells; times from the start, None while not reached."""

    region_m2: float
    reached_m2: float
    not_yet_m2: float
    in_shade_m2: float
    in_sun_m2: float
    sun_unknown_m2: float
    not_shown_m2: float
    time_to_95_imaged_s: float | None
    time_to_95_in_sun_s: float | None


class SurveyVehicle(msgspec.Struct, frozen=True):
    """One vehicle of a survey; `not_flying_reason` is the reason why it is not flying rows now."""

    serial: str
    vehicle_name: str
    is_flying_rows: bool
    not_flying_reason: str | None
    refused: str | None
    has_come_home: bool
    """Whether it returned for the survey and landed: it can be added again."""
    takes_off_automatically: bool
    """Whether it takes off from the ground as soon as there are rows for it."""


class ImagerStay(msgspec.Struct, frozen=True):
    """When an imaging drone must return; None with the reason if unknown."""

    serial: str
    vehicle_name: str
    return_due_in_s: float | None
    unknown: str | None


class SurveyLight(msgspec.Struct, frozen=True):
    """How long a running survey has light, and what it flies without; None where unknown."""

    needs_s: float | None
    imagers: tuple[ImagerStay, ...]
    unknown_in_s: float | None
    """Time until the last imaging drone must return; None if the survey is done by then."""
    unknown_for_s: float | None
    without_age_s: float | None
    without_m2: float | None


class SurveyStatus(msgspec.Struct, frozen=True):
    """The status of one survey."""

    id: int
    name: str
    phase: SurveyPhaseName
    reason: str
    planner: str
    when_done: WhenDoneName
    side_step_allowed: bool
    upwind_allowed: bool
    relief_allowed: bool
    spare_serial: str | None
    light: SurveyLight | None
    height_above_takeoff_m: float | None
    height_above_ground_m: float | None
    rows_note: str
    """Whose rows these are, or why they are new; may be empty."""
    rest_since_unix_s: int | None
    """Cells imaged from then on are left out; None: all are flown."""
    round: int
    missions: int
    flown_m: float
    rows: int
    vehicles: tuple[SurveyVehicle, ...]
    figures: SurveyProgress | None


class FlownDayStatus(msgspec.Struct, frozen=True):
    """The area of a region that was imaged last on a day, and last in sun."""

    day: date
    imaged_m2: float
    in_sun_m2: float


class FlownRegionStatus(msgspec.Struct, frozen=True):
    """A region that was surveyed in one way, on any day; `left_m2` since it was begun.

    `changes` are what differs now; with a `refusal` it cannot be flown again.
    """

    id: str
    region: str
    is_simulated: bool
    planner: str
    height_above_takeoff_m: float | None
    height_above_ground_m: float | None
    row_spacing_m: float
    row_bearing_deg: float
    begun_unix_s: int
    started_unix_s: int
    reached_m2: float
    left_m2: float
    days: tuple[FlownDayStatus, ...]
    changes: tuple[str, ...]
    refusal: str | None


class FlownRegionList(msgspec.Struct, frozen=True):
    """The regions that were surveyed, the one flown last first; `today` is the station's day."""

    today: date
    regions: tuple[FlownRegionStatus, ...]
    unreadable: tuple[str, ...]


class DronePreview(msgspec.Struct, frozen=True):
    """What a survey takes of one drone; `serial` is None for an assumed one."""

    serial: str | None
    vehicle_name: str
    time_s: float
    flights: int


class SurveyPreview(msgspec.Struct, frozen=True):
    """What a survey will take, each row flown once, as under a clear sky.

    With a `refusal` times, photos and batteries are None; batteries also while an endurance is not
    known.
    """

    survey_id: int
    refusal: str | None
    region_m2: float
    reached_m2: float
    least_height_above_ground_m: float | None
    most_height_above_ground_m: float | None
    rows: int
    gsd_m: float | None
    blur_px: float
    speed_limit_mps: float
    speed_limited_by: str
    time_s: float | None
    flown_s: float | None
    photos: int | None
    photos_in_all: int | None
    batteries: int | None
    drones: tuple[DronePreview, ...]
    warnings: tuple[str, ...]


class SurveyMessage(AnswerMessage, frozen=True, kw_only=True):
    """The answer to a survey command."""

    survey: SurveyStatus | None


class SiteOrigin(msgspec.Struct, frozen=True):
    """Origin of the site's local frame; None for a site without a position."""

    latitude_deg: float | None
    longitude_deg: float | None
    ground_altitude_m: float | None


class _SiteMessage(msgspec.Struct, frozen=True):
    site: SiteOrigin | None


class SurveyCommands:
    """Survey commands to a station."""

    def __init__(self, http: "Http", station_time_ms: Callable[[], int | None]) -> None:
        self._http = http
        self._station_time_ms = station_time_ms

    async def create(
        self,
        *,
        region: str | None = None,
        polygon: Sequence[Sequence[Sequence[float]]] | None = None,
        height_above_takeoff_m: float | None = None,
        height_above_ground_m: float | None = None,
        speed_mps: float,
        **more: Any,
    ) -> SurveyStatus | Refusal:
        """Plan a survey of a site region, or of a GeoJSON polygon's rings. Nothing moves.

        Exactly one height is given. `more` are further fields of the API's `SurveyRequest`.
        """
        request = {
            "region": region,
            "polygon": polygon,
            "height_above_takeoff_m": height_above_takeoff_m,
            "height_above_ground_m": height_above_ground_m,
            "speed_mps": speed_mps,
            **more,
        }
        return await self._post("/api/surveys", request)

    async def flown_regions(self) -> FlownRegionList:
        """Return the regions that were surveyed, in this run of the station or an earlier one."""
        return await self._http.get("/api/flown-regions", FlownRegionList, "the flown regions")

    async def again(
        self,
        region_id: str,
        *,
        since: date | None = None,
        all_again: bool = False,
        gaps: bool = False,
    ) -> SurveyStatus | Refusal:
        """Plan what is left of a flown region, on its rows. Nothing moves.

        Cells imaged since it was begun are left out, or those imaged from the day `since` on; none
        with `all_again`; all but the gaps of the photos with `gaps`.
        """
        day = None if since is None else since.isoformat()
        request = {"id": region_id, "since": day, "all_again": all_again, "gaps": gaps}
        return await self._post("/api/surveys/again", request)

    async def start(
        self, survey_id: int, serials: Sequence[str], *, takeoff: bool = False
    ) -> SurveyStatus | Refusal:
        """Start a survey with these vehicles, and give guidance control of them.

        `takeoff` allows each one to take off for this start.
        """
        request = {
            "serials": list(serials),
            "takeoff": takeoff,
            "given_at_unix_ms": self._station_time_ms(),
        }
        return await self._post(f"/api/surveys/{survey_id}/start", request)

    async def pause(self, survey_id: int) -> SurveyStatus | Refusal:
        """Pause a survey; its vehicles hold."""
        return await self._post(f"/api/surveys/{survey_id}/pause", None)

    async def abort(self, survey_id: int) -> SurveyStatus | Refusal:
        """Abort a survey permanently; its vehicles hold."""
        return await self._post(f"/api/surveys/{survey_id}/abort", None)

    async def estimate(self, survey_id: int, serials: Sequence[str] = ()) -> SurveyPreview:
        """Return what a survey will take with these vehicles, or with one drone. Nothing moves."""
        named = "&".join(f"serial={quote(serial, safe='')}" for serial in serials)
        path = f"/api/surveys/{survey_id}/estimate"
        return await self._http.get(
            f"{path}?{named}" if named else path, SurveyPreview, "an estimate"
        )

    async def list(self) -> tuple[SurveyStatus, ...]:
        """Return the surveys of this run of the station, newest first."""
        return await self._http.get("/api/surveys", tuple[SurveyStatus, ...], "the surveys")

    async def site_origin(self) -> SiteOrigin | None:
        """Return the site's origin, which a polygon must be close to."""
        return (await self._http.get("/api/state", _SiteMessage, "a state")).site

    async def _post(self, path: str, request: Mapping[str, Any] | None) -> SurveyStatus | Refusal:
        answer = await self._http.post(
            path, request, SurveyMessage, "the answer to a survey command"
        )
        refusal = answer.refusal
        if refusal is not None or answer.survey is None:
            return refusal or Refusal("unnamed", "no survey in the answer")
        return answer.survey
