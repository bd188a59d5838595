"""What the API needs of the station. The station implements it; tests may too."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from recon.api.schema import (
    AuditPage,
    OrderResponse,
    PreflightView,
    StationState,
    SurveyRequest,
    SurveyResponse,
    SurveyView,
    SurveyWays,
    WordResponse,
)
from recon.model.authority import AuthorityHolder
from recon.model.command import Body
from recon.model.imagery import Frame, GroundImage
from recon.model.shade import ShadeMap, SunForecast


@dataclass(frozen=True, slots=True, eq=False)
class SurveyCells:
    """A survey's cells, (R, C): `state` holds `CellState`s, `inside` is the region."""

    number: int
    state: npt.NDArray[np.uint8]
    inside: npt.NDArray[np.bool_]


class StationPort(Protocol):
    """The station as the API sees it. Every call returns at once."""

    def state(self) -> StationState:
        """Return everything a console shows, as of now."""

    def order(
        self,
        serials: list[str],
        body: Body,
        *,
        takeoff: bool,
        issued_by: str,
        owner: str | None = None,
    ) -> OrderResponse:
        """Give one order to each named vehicle; refusals are results, not errors.

        `owner` names the stream whose end ends a steered order.
        """

    def check(
        self,
        serials: list[str],
        body: Body,
        *,
        takeoff: bool,
        issued_by: str,
        owner: str | None = None,
    ) -> OrderResponse:
        """Return what `order` would answer now, without giving it."""

    def owner_connected(self, owner: str) -> None:
        """Tell that a stream is open that may hold steered orders."""

    def owner_disconnected(self, owner: str) -> None:
        """Tell that it has ended, or says nothing any more."""

    def all_stop(self, issued_by: str) -> OrderResponse:
        """Hold every link whose telemetry says flying, identified or not."""

    def fleet_return(self, serials: list[str] | None, issued_by: str) -> OrderResponse:
        """Call vehicles home in layers; None calls every one that flies or may.

        The results tell of the hold that each begins with; flights and waves are in the state.
        """

    def dismiss_hazard(self, name: str, by: str) -> bool:
        """Take a vehicle that is not heard out of the air; False when it is no hazard area."""

    def switch_separation_hold(self, is_on: bool, by: str) -> None:
        """Switch on or off that the watchdogs hold vehicles."""

    def take_authority(self, serial: str, holder: AuthorityHolder, by: str) -> WordResponse:
        """Let somebody else lead a vehicle; refusals are answers, not errors."""

    def preflight(self, serial: str) -> PreflightView | None:
        """Return a vehicle's checklist as of now; None when it is not known."""

    def override_preflight(self, serial: str, reason: str, by: str) -> WordResponse:
        """Let a vehicle fly missions although its checklist is not passed."""

    def acknowledge(self, alarm_id: int, by: str) -> bool:
        """Mark an alarm as seen; False when there is none of that number."""

    def audit(self, after: int, at_most: int) -> AuditPage:
        """Return the audit's entries after a number, the oldest first."""

    def frame(self, serial: str) -> Frame | None:
        """Return a vehicle's newest camera frame."""

    def ground_image(self) -> GroundImage | None:
        """Return the newest frame laid on the ground."""

    def shade(self) -> tuple[int, ShadeMap] | None:
        """Return the newest shade map and its number."""

    def forecast(self) -> tuple[int, SunForecast] | None:
        """Return the newest forecast and its number."""

    def ask_survey(self, asked: SurveyRequest, by: str) -> SurveyResponse:
        """Ask for a survey; its rows are worked out then, and `survey` tells when they are."""

    def survey(self, survey_id: int) -> SurveyView | None:
        """Return a survey as it stands."""

    def start_survey(
        self, survey_id: int, serials: list[str], *, takeoff: bool, by: str
    ) -> SurveyResponse:
        """Start a survey with these vehicles, or let them join; they are given to guidance."""

    def stop_survey(self, survey_id: int, *, is_aborted: bool, by: str) -> SurveyResponse:
        """Pause a survey, or abort it for good; its vehicles hold."""

    def survey_ways(self, survey_id: int) -> SurveyWays | None:
        """Return a survey's planned and flown ways."""

    def survey_cells(self, survey_id: int) -> SurveyCells | None:
        """Return a survey's cells as they stand."""

    def geotiff(self, image: GroundImage) -> bytes:
        """Return a ground image as a GeoTIFF file; may take long, safe on any thread."""
