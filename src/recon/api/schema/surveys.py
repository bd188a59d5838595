"""What is asked and told of surveys."""

from typing import Annotated, Literal

from pydantic import Field

from recon.api.schema.asked import Asked
from recon.api.schema.message import Message

SurveyPhaseWord = Literal["planning", "refused", "created", "running", "paused", "aborted", "done"]


WhenDoneWord = Literal["return_home", "hover"]


class SurveyCameraRequest(Asked):
    """The survey drones' camera: fields of view, and the interval its timer is set to."""

    across_deg: float = 66.0
    along_deg: float = 52.0
    interval_s: float = 2.0


class SurveyBudgetRequest(Asked):
    """When the survey ends although it is not done; null: never for that reason."""

    rounds: int = 6
    time_s: float | None = None
    flown_m: float | None = None


class SurveyRequest(Asked):
    """A survey to plan. Either `region`, a survey region of the site by name, or `polygon`.

    Nothing flies by this: see `/api/surveys/{id}/start`.
    """

    name: Annotated[str, Field(min_length=1, max_length=100)] | None = Field(
        default=None, description="null: the region's"
    )
    region: Annotated[str, Field(max_length=200)] | None = None
    polygon: list[list[list[float]]] | None = Field(
        default=None,
        max_length=200,
        description="the rings of a GeoJSON polygon, longitude first: the outline, then its holes",
    )
    height_above_takeoff_m: float
    speed_mps: float
    front_overlap: float = 0.7
    side_overlap: float = 0.6
    row_bearing_deg: float | None = None
    planner: Annotated[str, Field(max_length=100)] = "lawnmower_once"
    counts_neighbours: bool = False
    cell_m: float = 4.0
    when_done: WhenDoneWord = Field(
        default="return_home",
        description="what its vehicles do when it is done, or no battery lasts for a row",
    )
    camera: SurveyCameraRequest = SurveyCameraRequest()
    budget: SurveyBudgetRequest = SurveyBudgetRequest()


class SurveyStartRequest(Asked):
    """With whom to fly. By this word the vehicles are given to the station's guidance.

    `takeoff` is the explicit word that each may leave the ground, once.
    """

    serials: list[Annotated[str, Field(max_length=2048)]] = Field(min_length=1, max_length=64)
    takeoff: bool = False


class SurveyFiguresView(Message):
    """Areas by counted cells; times from the start, null: not yet."""

    region_m2: float
    reached_m2: float = Field(description="what the rows see for sure")
    not_yet_m2: float
    in_shade_m2: float = Field(description="imaged, and not for sure in sun")
    in_sun_m2: float
    sun_unknown_m2: float = Field(description="imaged, and nobody knows in which light")
    time_to_95_imaged_s: float | None
    time_to_95_in_sun_s: float | None


class SurveyCellsView(Message):
    """Where the picture of the cells lies; its number rises as they do."""

    number: int
    corners: list[tuple[float, float]]
    cell_m: float
    rows: int
    cols: int


class SurveyingView(Message):
    """One vehicle of a survey."""

    serial: str
    vehicle_name: str
    is_flying_rows: bool = Field(description="a mission of the survey is under way")
    waits_for: str | None = Field(description="why it flies nothing (more) for the survey now")
    refused: str | None = Field(description="why its newest mission was refused, if it was")
    has_come_home: bool = Field(description="called home by the survey, it has landed")
    mission_command_id: int | None


class SurveyView(Message):
    """One survey: a light summary; its ways and cells are asked for by themselves."""

    id: int
    name: str
    phase: SurveyPhaseWord
    reason: str
    asked_by: str
    age_s: float
    started_by: str | None
    planner: str
    when_done: WhenDoneWord
    height_above_takeoff_m: float
    speed_mps: float
    round: int
    missions: int
    flown_m: float
    vehicles: list[SurveyingView]
    figures: SurveyFiguresView | None
    cells: SurveyCellsView | None
    rows: int = Field(description="how many rows, or pieces of rows, are planned")
    ways: int = Field(description="rises as flown ways grow")


class SurveyWay(Message):
    """The way of one mission: (longitude, latitude) of its corners."""

    serial: str
    number: int
    places: list[tuple[float, float]]


class SurveyWays(Message):
    """A survey's rows, each from end to end; the missions flown now; and the ways flown so far."""

    survey_id: int
    rows: list[list[tuple[float, float]]]
    flying: list[SurveyWay]
    flown: list[SurveyWay]


class SurveyResponse(Message):
    """What became of a word on a survey: taken, or refused for a reason; and the survey."""

    accepted: bool
    rule: str | None
    reason: str | None
    survey: SurveyView | None
