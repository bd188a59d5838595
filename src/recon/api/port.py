"""The station as the API sees it: `station/api_views/service.py` implements it, and tests do."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
import numpy.typing as npt

from recon.api.schema import (
    ActionResponse,
    AuditPage,
    CalibrationRequest,
    CalibrationView,
    FrozenFrameView,
    ImportedView,
    OrderResponse,
    PreflightView,
    SiteDrawingRequest,
    SiteDrawingResponse,
    SiteDrawingView,
    SiteVehiclesRequest,
    SiteVehiclesResponse,
    SiteVehiclesView,
    StationState,
    SunAtView,
    SurveyCameraView,
    SurveyEstimateView,
    SurveyRequest,
    SurveyResponse,
    SurveyView,
    SurveyWays,
    TemporaryZoneResponse,
    TimelineView,
    UpwindView,
)
from recon.model.command import Body
from recon.model.control import AuthorityHolder
from recon.model.imagery import Frame, GroundImage
from recon.model.person import Person
from recon.model.shade import MaskMap, ShadeMap, SunForecast
from recon.model.temporary_zone import DrawnZone


@dataclass(frozen=True, slots=True, eq=False)
class SurveyCellStates:
    """The states of a survey's cells, (R, C): `state` holds `CellState`s, `inside` the region."""

    number: int
    state: npt.NDArray[np.uint8]
    inside: npt.NDArray[np.bool_]
    light_known: npt.NDArray[np.bool_]
    """Where the light was known when a photo was taken."""


TimelineSubject = Literal["orders", "alarms", "flights", "operations", "station"]
"""What a line of the timeline is about."""


class SiteFolder(Protocol):
    """The site's folder, read and written on threads: its calls take as long as the disk."""

    async def drawing(self) -> SiteDrawingView:
        """Return the layers in the folder, with all corners."""

    async def save(
        self, asked: SiteDrawingRequest, by: Person, *, is_check: bool
    ) -> SiteDrawingResponse:
        """Check a drawing, save it and bring it into force; refusals are results, not errors."""

    async def undo(self, revision: str, by: Person) -> SiteDrawingResponse:
        """Take back the newest change; refusals are results, not errors."""

    async def import_features(self, name: str, data: bytes) -> ImportedView:
        """Return the polygons and points of a file; why it is refused is a result."""


class SiteVehiclesPort(Protocol):
    """The table of the site's vehicles, in its folder."""

    async def vehicles(self) -> SiteVehiclesView:
        """Return the vehicles in the folder."""

    async def save(
        self, asked: SiteVehiclesRequest, by: Person, *, is_check: bool
    ) -> SiteVehiclesResponse:
        """Check vehicles, save them and bring them into force; refusals are results."""


class CalibrationPort(Protocol):
    """Imaging drones' cameras placed by points that are marked on kept frames."""

    async def freeze(self, serial: str) -> FrozenFrameView:
        """Keep the newest frame of an imaging drone; why none is kept is a result."""

    def frame(self, serial: str) -> Frame | None:
        """Return the kept frame."""

    async def fit(self, asked: CalibrationRequest) -> CalibrationView:
        """Return the camera's pose by these points; nothing is saved."""

    async def accept(self, asked: CalibrationRequest, by: Person) -> CalibrationView:
        """Save the points and bring them into force; refusals are results."""


class SurveyPort(Protocol):
    """The surveys of this run; every call returns at once, refusals are results, not errors."""

    def ask(self, asked: SurveyRequest, by: Person) -> SurveyResponse:
        """Request a survey; it is planned in the background, see `view`."""

    def start(
        self,
        survey_id: int,
        serials: list[str],
        *,
        takeoff: bool,
        by: Person,
        given_at_ns: int | None = None,
    ) -> SurveyResponse:
        """Start a survey with these vehicles, or add them; guidance gets control authority."""

    def stop(self, survey_id: int, *, is_aborted: bool, by: Person) -> SurveyResponse:
        """Pause or abort a survey; its vehicles hold."""

    def view(self, survey_id: int) -> SurveyView | None:
        """Return a survey as it stands."""

    def ways(self, survey_id: int) -> SurveyWays | None:
        """Return a survey's planned rows and flown paths; None without rows."""

    def cells(self, survey_id: int) -> SurveyCellStates | None:
        """Return the states of a survey's cells; None without rows."""

    def preview(
        self, survey_id: int, serials: Sequence[str]
    ) -> Callable[[], SurveyEstimateView] | None:
        """Return what estimates a survey with these vehicles; safe on any thread, may take long.

        None without rows.
        """

    def cameras(self) -> list[SurveyCameraView]:
        """Return the survey cameras that requests may name."""


class StationPort(Protocol):
    """Every call returns at once."""

    def state(self) -> StationState:
        """Return everything a console shows, as of now."""

    def order(
        self,
        serials: list[str],
        body: Body,
        *,
        takeoff: bool,
        by: Person,
        owner: str | None = None,
        given_at_ns: int | None = None,
    ) -> OrderResponse:
        """Give one order to each named vehicle; refusals are results, not errors.

        `owner` names the open stream that a steered order depends on; `given_at_ns` is when its
        person gave it, in station time.
        """

    def check(
        self,
        serials: list[str],
        body: Body,
        *,
        takeoff: bool,
        by: Person,
        owner: str | None = None,
        given_at_ns: int | None = None,
    ) -> OrderResponse:
        """Return what `order` would answer now, without giving it."""

    def owner_connected(self, owner: str) -> None:
        """Report that an owner stream has opened."""

    def owner_disconnected(self, owner: str) -> None:
        """Report that it has closed or is silent: its steered orders end."""

    def all_stop(self, by: Person) -> OrderResponse:
        """Hold every link that may be in flight, identified or not; latched until released."""

    def release_stop(self, serials: list[str] | None, by: Person) -> ActionResponse:
        """Release vehicles from the all stop in force; None: all."""

    def draw_zone(self, drawn: DrawnZone, by: Person) -> TemporaryZoneResponse:
        """Draw a temporary zone; refusals are results, not errors."""

    def end_zone(self, zone_id: int, by: Person) -> ActionResponse:
        """End a temporary zone; refusals are results, not errors."""

    def admit_app(
        self, link_id: int, serial: str, *, is_for_good: bool, any_address: bool, by: Person
    ) -> ActionResponse:
        """Admit the app that waits on a link; refusals are results, not errors."""

    def refuse_app(self, link_id: int, by: Person) -> ActionResponse:
        """Refuse the app that waits on a link: it is closed, and again for a while."""

    def fleet_return(
        self, serials: list[str] | None, by: Person, given_at_ns: int | None = None
    ) -> OrderResponse:
        """Return vehicles home in layers; None: every vehicle that is or may be in flight.

        Each result is the hold that the return starts with; the state shows waves and heights.
        """

    def look_aside(
        self, serial: str | None, by: Person, given_at_ns: int | None = None
    ) -> ActionResponse:
        """Have an imaging drone look aside; refusals are results, not errors.

        None: the one whose light is unknown, or the site's first.
        """

    def relieve(
        self,
        serial: str,
        spare: str,
        *,
        takeoff: bool,
        by: Person,
        given_at_ns: int | None = None,
    ) -> ActionResponse:
        """Have `spare` take the place of an imaging drone; refusals are results, not errors."""

    def dismiss_hazard(self, name: str, by: Person) -> bool:
        """Dismiss the hazard area of a lost vehicle; False when it has none."""

    def switch_separation_hold(self, is_on: bool, by: Person) -> None:
        """Switch the separation holds of the watchdogs on or off."""

    def take_authority(
        self, serial: str, holder: AuthorityHolder, by: Person, *, takes_over: bool = False
    ) -> ActionResponse:
        """Transfer control authority; refusals are results, not errors.

        `takes_over`: also from another person who operates the vehicle.
        """

    def person_connected(self, by: Person) -> None:
        """Report that a person opened a stream of states."""

    def person_disconnected(self, by: Person) -> None:
        """Report that a stream of states of a person closed."""

    def preflight(self, serial: str) -> PreflightView | None:
        """Return a vehicle's checklist as of now; None for an unknown vehicle."""

    def override_preflight(self, serial: str, reason: str, by: Person) -> ActionResponse:
        """Allow missions although the checklist is not passed."""

    def acknowledge(self, alarm_id: int, by: Person) -> bool:
        """Acknowledge an alarm; False when it does not exist."""

    def timeline(
        self, serial: str | None, about: TimelineSubject | None, before_n: int | None, at_most: int
    ) -> TimelineView:
        """Return what happened, the newest first, of one vehicle and subject or of all."""

    def audit(self, after: int, at_most: int) -> AuditPage:
        """Return the audit's entries after a number, the oldest first."""

    def frame(self, serial: str) -> Frame | None:
        """Return a vehicle's newest camera frame."""

    def ground_image(self) -> GroundImage | None:
        """Return the newest ground image."""

    def shade(self) -> tuple[int, ShadeMap, MaskMap] | None:
        """Return the number of the newest shade map, the map, and its cells in view."""

    def forecast(self) -> tuple[int, SunForecast] | None:
        """Return the newest forecast and its number."""

    def sun_at(self, latitude_deg: float, longitude_deg: float) -> SunAtView | None:
        """Return the light at a place and its next change; None before the first map."""

    def upwind_place(self, serial: str | None, region: str | None) -> UpwindView:
        """Return where an imaging drone sees most of the shade that comes over a region.

        None: the site's first one; the region of the running survey, or all of the site's.
        """

    def surveys(self) -> SurveyPort:
        """Return the surveys."""

    def site_vehicles(self) -> SiteVehiclesPort:
        """Return the table of the site's vehicles."""

    def calibration(self) -> CalibrationPort:
        """Return what places the imaging drones' cameras."""

    def geotiff(self, image: GroundImage) -> bytes:
        """Return a ground image as a GeoTIFF file; may take long, safe on any thread."""

    def site_folder(self) -> SiteFolder:
        """Return the site's folder."""
