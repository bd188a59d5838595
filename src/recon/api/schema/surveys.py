"""Survey requests and their state."""

from datetime import date
from typing import Annotated, Literal

from pydantic import Field

from recon.api.schema.message import ActionResponse, GivenRequest, Message, StrictMessage

SurveyPhaseName = Literal["planning", "refused", "created", "running", "paused", "aborted", "done"]


WhenDoneName = Literal["return_home", "hover"]


class SurveyCameraRequest(StrictMessage):
    """The survey drones' camera: fields of view, and the interval its timer is set to.

    `model` is the name of a camera of `/api/cameras`, instead of fields of view and pixels.
    """

    model: Annotated[str, Field(max_length=40)] | None = None
    across_px: Annotated[int, Field(ge=2, le=100_000)] | None = Field(
        default=None, description="null: the size of a pixel on the ground is not known"
    )
    across_deg: float = 66.0
    along_deg: float = 52.0
    interval_s: float = 2.0


class SurveyBudgetRequest(StrictMessage):
    """Limits that end the survey before it is complete; null: no limit."""

    rounds: int = 6
    time_s: float | None = None
    flown_m: float | None = None


class SurveyRequest(StrictMessage):
    """A survey to plan. Either `region`, a survey region of the site by name, or `polygon`; and
    exactly one height.

    Nothing flies yet: see `/api/surveys/{id}/start`.
    """

    name: Annotated[str, Field(min_length=1, max_length=100)] | None = Field(
        default=None, description="null: the region's name"
    )
    region: Annotated[str, Field(max_length=200)] | None = None
    polygon: list[list[list[float]]] | None = Field(
        default=None,
        max_length=200,
        description="the rings of a GeoJSON polygon, longitude first: the outline, then its holes",
    )
    height_above_takeoff_m: float | None = Field(
        default=None, description="above each vehicle's own takeoff point"
    )
    height_above_ground_m: float | None = Field(
        default=None,
        description="above the ground of the site's elevation model, instead of "
        "height_above_takeoff_m",
    )
    speed_mps: float
    front_overlap: float = 0.7
    side_overlap: float = 0.6
    row_bearing_deg: float | None = None
    planner: Annotated[str, Field(max_length=100)] | None = Field(
        default=None,
        description="null: sunlit_first on a site with an imaging drone, else lawnmower_once",
    )
    counts_neighbours: bool = False
    cell_m: float = 4.0
    when_done: WhenDoneName = Field(
        default="return_home",
        description="what vehicles do when it is complete, or no battery is sufficient for a row",
    )
    side_step_allowed: bool = Field(
        default=False,
        description="the imaging drone may side-step automatically while light is mostly unknown",
    )
    upwind_allowed: bool = Field(
        default=False,
        description="the imaging drone may fly automatically to where it sees more of the shade to "
        "come",
    )
    relief_allowed: bool = Field(
        default=False,
        description="the imaging drone may be relieved automatically, or recalled, when its "
        "battery is at the return threshold",
    )
    spare_serial: Annotated[str, Field(max_length=256)] | None = Field(
        default=None,
        description="the imaging drone that relieves it then, and takes off if the start allows",
    )
    rows: Literal["auto", "as_before", "new"] = Field(
        default="auto",
        description="auto: a region's rows of last time if its outline, height, camera and overlap "
        "are the same; as_before: those, whatever differs",
    )
    camera: SurveyCameraRequest = SurveyCameraRequest()
    budget: SurveyBudgetRequest = SurveyBudgetRequest()


Day = Annotated[date, Field(strict=False, ge=date(1970, 1, 2), le=date(2105, 12, 31))]
"""A day as text, `2026-05-01`; times of cells are kept for this long."""


class SurveyAgainRequest(StrictMessage):
    """A survey to plan as a flown one was, on its rows. Nothing flies yet."""

    id: Annotated[str, Field(max_length=40)] = Field(description="of `/api/flown-regions`")
    since: Day | None = Field(
        default=None,
        description="cells imaged from this day on, by the station's calendar, are left out; null: "
        "those imaged since the survey was begun",
    )
    all_again: bool = Field(default=False, description="no cell is left out")
    gaps: bool = Field(
        default=False, description="all cells are left out but those in gaps of `/api/photos`"
    )


class FlownDayView(Message):
    """The area of a region that was imaged last on a day, by the station's calendar."""

    day: date
    imaged_m2: float
    in_sun_m2: float = Field(description="imaged last in sun on this day")


class FlownRegionView(Message):
    """A region that was surveyed in one way, on any day; kept through restarts."""

    id: str
    region: str
    is_simulated: bool = Field(description="simulated drones flew it")
    planner: str
    height_above_takeoff_m: float | None
    height_above_ground_m: float | None
    speed_mps: float
    camera_across_deg: float
    camera_along_deg: float
    row_spacing_m: float
    row_bearing_deg: float
    begun_unix_s: int = Field(description="when the survey was begun that can be resumed")
    started_unix_s: int = Field(description="when it was last started")
    reached_m2: float
    left_m2: float = Field(description="not imaged as its planner wants since it was begun")
    gaps_m2: float | None = Field(
        description="of the ground that the photos show too little in sun; null without photos"
    )
    days: list[FlownDayView] = Field(description="the newest first")
    changes: list[str] = Field(description="what differs now, in words: outline, origin")
    refusal: str | None = Field(description="why it cannot be flown again; null: it can")


class FlownRegionsView(Message):
    """The regions that were surveyed, the one flown last first."""

    today: date = Field(description="by the station's calendar")
    regions: list[FlownRegionView]
    unreadable: list[str] = Field(description="a sentence for each kept file that is not used")


class SurveyStartRequest(GivenRequest):
    """The vehicles to fly with. Their control authority passes to the station's guidance.

    `takeoff` explicitly allows each to leave the ground once, for this start.
    """

    serials: list[Annotated[str, Field(max_length=2048)]] = Field(min_length=1, max_length=64)
    takeoff: bool = False


class SurveyFiguresView(Message):
    """Areas by counted cells; times from the start, null: not reached."""

    region_m2: float
    reached_m2: float = Field(description="imaged by the rows with certainty")
    not_yet_m2: float
    in_shade_m2: float = Field(description="imaged, light known, not certainly in sun")
    in_sun_m2: float
    sun_unknown_m2: float = Field(description="imaged, not certainly in sun, light unknown")
    not_shown_m2: float = Field(
        description="reached, but not shown by shade maps: imaged once, in unknown light"
    )
    time_to_95_imaged_s: float | None
    time_to_95_in_sun_s: float | None


class SurveyCellsView(Message):
    """Position of the picture of the cells; `number` rises with every change."""

    number: int
    corners: list[tuple[float, float]]
    cell_m: float
    rows: int
    cols: int


class SurveyingView(Message):
    """One vehicle of a survey."""

    serial: str
    vehicle_name: str
    is_flying_rows: bool = Field(description="a mission of the survey is in flight")
    not_flying_reason: str | None = Field(description="why it does not fly for the survey now")
    decision: str | None = Field(description="what it flies or waits for now, and why")
    refused: str | None = Field(
        description="why its newest mission was refused; null if it was not"
    )
    waits_for: str | None = Field(
        description="the vehicle in the way of its newest mission; null if none is"
    )
    has_come_home: bool = Field(description="landed after the survey returned it home")
    takes_off_automatically: bool = Field(
        description="on the ground: it takes off as soon as there are rows for it"
    )
    mission_command_id: int | None


class ImagerOutlookView(Message):
    """When the battery of an imaging drone over the field will be at the return threshold."""

    serial: str
    vehicle_name: str
    return_due_in_s: float | None = Field(description="null: not known; `unknown` states why")
    unknown: str | None


class AbsentImagerView(Message):
    """An imaging drone that hovered over the field, and can be sent to its place again."""

    serial: str
    vehicle_name: str
    gone_age_s: float
    is_on_ground: bool


class SurveyLightView(Message):
    """How long a running survey will have light, and what it flies without."""

    needs_s: float | None = Field(description="for its missing ground, at its recent pace")
    imagers: list[ImagerOutlookView]
    absent: list[AbsentImagerView]
    unknown_in_s: float | None = Field(
        description="until the last imaging drone must return, if that is before the survey is done"
    )
    unknown_for_s: float | None = Field(description="from then on, without a second imaging drone")
    without_age_s: float | None = Field(description="since the last shade map; null: it has light")
    without_m2: float | None = Field(description="imaged since then, its light unknown")


class SurveyView(Message):
    """Summary of one survey; paths and cells have routes of their own."""

    id: int
    name: str
    region: str | None = Field(description="the site's name of its region; null: it was drawn")
    phase: SurveyPhaseName
    reason: str
    asked_by: str
    age_s: float
    started_by: str | None
    planner: str
    when_done: WhenDoneName
    side_step_allowed: bool
    upwind_allowed: bool
    relief_allowed: bool
    spare_serial: str | None
    light: SurveyLightView | None = Field(description="null: it does not run")
    height_above_takeoff_m: float | None = Field(description="null: it is above ground")
    height_above_ground_m: float | None = Field(description="null: it is above takeoff")
    speed_mps: float
    rows_note: str = Field(description="whose rows these are, or why they are new; may be empty")
    rest_since_unix_s: int | None = Field(
        description="cells imaged from then on are left out; null: all are flown"
    )
    round: int
    missions: int
    flown_m: float
    vehicles: list[SurveyingView]
    figures: SurveyFiguresView | None
    cells: SurveyCellsView | None
    rows: int = Field(description="number of planned rows or parts of rows")
    paths: int = Field(description="rises as flown paths grow")


class SurveyCameraView(Message):
    """A survey camera; the longer side of its photos lies across the flight."""

    name: str
    title: str
    across_px: int
    along_px: int
    across_deg: float
    along_deg: float
    timer_s: list[float] = Field(description="intervals that its timer can be set to")
    shutter: Literal["global", "mechanical", "rolling"]
    source: str


class DroneEstimateView(Message):
    """What a survey takes of one drone; `serial` is null for an assumed one."""

    serial: str | None
    vehicle_name: str
    time_s: float = Field(description="from the start to its last landing, battery swaps included")
    flights: int


class SurveyEstimateView(Message):
    """What a survey will take, each row flown once, as under a clear sky.

    Times, photos and batteries are null with a `refusal`, batteries also while an endurance is
    not known.
    """

    survey_id: int
    refusal: str | None
    region_m2: float
    reached_m2: float
    least_height_above_ground_m: float | None = Field(
        description="of rows over the region; null: the ground or a takeoff point is not known"
    )
    most_height_above_ground_m: float | None
    rows: int = Field(description="whole rows, however many parts they are cut into")
    gsd_m: float | None = Field(description="pixel on the ground; null: pixels are not known")
    blur_px: float = Field(description="of motion during an exposure of 1/1000 s")
    speed_limit_mps: float
    speed_limited_by: str
    time_s: float | None
    flown_s: float | None = Field(description="in the air, all drones added")
    photos: int | None = Field(description="on rows")
    photos_in_all: int | None = Field(description="by a timer that runs from takeoff to landing")
    batteries: int | None
    drones: list[DroneEstimateView]
    rows_note: str = Field(description="whose rows these are, or why they are new; may be empty")
    warnings: list[str]


class PlanFormatView(Message):
    """One format in which a survey's flights can be downloaded, for another program to fly."""

    kind: str = Field(description="of GET /api/surveys/{survey_id}/plan.{kind}")
    title: str
    files: int = Field(description="one each flight, or one for all; several come as a .zip")
    by_hand: list[str] = Field(description="what the pilot sets in the program, as sentences")
    refusal: str | None = Field(description="why there is no file, and what to do")


class PlanAircraftView(Message):
    """An aircraft that a .kmz may name, and the cameras of which it must name one; none: it has
    its own."""

    name: str
    payloads: list[str]


class PlanExportsView(Message):
    """In which formats a survey's flights can be downloaded, for the vehicles asked for."""

    survey_id: int
    formats: list[PlanFormatView]
    aircraft: list[PlanAircraftView]


class SurveyPath(Message):
    """The path of one mission: (longitude, latitude) of its corners."""

    serial: str
    number: int
    places: list[tuple[float, float]]


class SurveyPaths(Message):
    """A survey's rows, each from end to end; the missions in flight; the paths flown so far."""

    survey_id: int
    rows: list[list[tuple[float, float]]]
    flying: list[SurveyPath]
    flown: list[SurveyPath]


class SurveyResponse(ActionResponse):
    """The outcome of a survey command: accepted, or refused with a reason; and the survey."""

    survey: SurveyView | None
