"""Surveys, as a program asks for them and follows them."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import msgspec

from recon.model.command import Refusal

if TYPE_CHECKING:
    from recon.client.http import Http

SurveyPhaseWord = Literal["planning", "refused", "created", "running", "paused", "aborted", "done"]
WhenDoneWord = Literal["return_home", "hover"]


class SurveyFigures(msgspec.Struct, frozen=True):
    """Areas by counted cells; times from the start, None: not yet."""

    region_m2: float
    reached_m2: float
    not_yet_m2: float
    in_shade_m2: float
    in_sun_m2: float
    sun_unknown_m2: float
    time_to_95_imaged_s: float | None
    time_to_95_in_sun_s: float | None


class Surveying(msgspec.Struct, frozen=True):
    """One vehicle of a survey; `waits_for` says why it flies nothing (more) for it now."""

    serial: str
    vehicle_name: str
    is_flying_rows: bool
    waits_for: str | None
    refused: str | None
    has_come_home: bool
    """Called home by the survey, it has landed: a fresh battery, and it can be started again."""


class Survey(msgspec.Struct, frozen=True):
    """One survey as it stands."""

    id: int
    name: str
    phase: SurveyPhaseWord
    reason: str
    planner: str
    when_done: WhenDoneWord
    round: int
    missions: int
    flown_m: float
    rows: int
    vehicles: tuple[Surveying, ...]
    figures: SurveyFigures | None


class SurveyMessage(msgspec.Struct, frozen=True):
    """What became of a word on a survey."""

    accepted: bool
    rule: str | None
    reason: str | None
    survey: Survey | None


class SiteOrigin(msgspec.Struct, frozen=True):
    """Where a site's frame has its origin; None where the site has no place."""

    latitude_deg: float | None
    longitude_deg: float | None
    ground_altitude_m: float | None


class _SiteMessage(msgspec.Struct, frozen=True):
    site: SiteOrigin | None


class Surveys:
    """The surveys of a station."""

    def __init__(self, http: "Http") -> None:
        self._http = http

    async def create(
        self,
        *,
        region: str | None = None,
        polygon: Sequence[Sequence[Sequence[float]]] | None = None,
        height_above_takeoff_m: float,
        speed_mps: float,
        **more: Any,
    ) -> Survey | Refusal:
        """Ask for a survey of a region of the site, or of a GeoJSON polygon's rings.

        `more` is what `SurveyRequest` of the API has besides. Nothing flies by this.
        """
        asked = {
            "region": region,
            "polygon": polygon,
            "height_above_takeoff_m": height_above_takeoff_m,
            "speed_mps": speed_mps,
            **more,
        }
        return await self._say("/api/surveys", asked)

    async def start(
        self, survey_id: int, serials: Sequence[str], *, takeoff: bool = False
    ) -> Survey | Refusal:
        """Fly a survey with these vehicles; by this word they are led by the station's guidance.

        `takeoff` is the explicit word that each may leave the ground, once.
        """
        asked = {"serials": list(serials), "takeoff": takeoff}
        return await self._say(f"/api/surveys/{survey_id}/start", asked)

    async def pause(self, survey_id: int) -> Survey | Refusal:
        """Pause a survey; its vehicles hold."""
        return await self._say(f"/api/surveys/{survey_id}/pause", None)

    async def abort(self, survey_id: int) -> Survey | Refusal:
        """Abort a survey for good; its vehicles hold."""
        return await self._say(f"/api/surveys/{survey_id}/abort", None)

    async def list(self) -> tuple[Survey, ...]:
        """Return the surveys of the station's run, the newest first."""
        return await self._http.get("/api/surveys", tuple[Survey, ...], "the surveys")

    async def site_origin(self) -> SiteOrigin | None:
        """Return where the site is that a polygon must be near to."""
        return (await self._http.get("/api/state", _SiteMessage, "a state")).site

    async def _say(self, path: str, asked: Mapping[str, Any] | None) -> Survey | Refusal:
        answer = await self._http.post(path, asked, SurveyMessage, "what became of a survey")
        if answer.accepted and answer.survey is not None:
            return answer.survey
        return Refusal(answer.rule or "unnamed", answer.reason or "no reason was given")
