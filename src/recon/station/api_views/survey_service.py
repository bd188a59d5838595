"""The surveys of a running station: requests become events, states become views."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from recon.api import schema
from recon.guidance.survey import plan_survey, surroundings_of
from recon.guidance.survey.again import with_rows
from recon.guidance.survey.plan import HEIGHT_FAULT, RULE
from recon.model.airspace import Region
from recon.model.command import Refusal
from recon.model.errors import SiteError
from recon.model.event import SurveyRequested, SurveyStarted, SurveyStopped
from recon.model.person import Person
from recon.model.survey import RowChoice, Survey, SurveyBudget, SurveyCamera, WhenDone
from recon.model.survey_camera import CAMERAS, CameraModel, SurveyCameraError, camera_named
from recon.record.files.flown_region_file import day_of
from recon.site import Site
from recon.site.geojson import Feature, regions_of
from recon.station.api_views import RunningStation, outcome_of
from recon.station.api_views.flown_region_views import flown_regions_view, survey_again
from recon.station.api_views.operation_views import cells_number, survey_paths, survey_view
from recon.station.api_views.survey_exports import SurveyExports
from recon.station.api_views.survey_preview import Preview, previewed_fleet, survey_preview
from recon.station.operations.survey.commands import start_refusal, stop_refusal
from recon.station.operations.survey.planning import NO_SITE
from recon.station.recovery.flown_regions import FlownRegions

DraftPreview = Callable[[], schema.SurveyEstimateView | Refusal]
"""Plans rows and estimates them; safe on any thread, some tens of milliseconds."""


@dataclass(frozen=True, slots=True, eq=False)
class SurveyCellStates:
    """The states of a survey's cells, (R, C): `state` holds `CellState`s, `inside` the region."""

    number: int
    state: npt.NDArray[np.uint8]
    inside: npt.NDArray[np.bool_]
    light_known: npt.NDArray[np.bool_]
    """Where the light was known when a photo was taken."""


@dataclass(frozen=True, slots=True)
class SurveyService:
    """Surveys of a running station."""

    driver: RunningStation
    site: Site
    ids: Callable[[], int]
    flown: FlownRegions = field(default_factory=FlownRegions)
    """What is kept of earlier surveys."""
    gaps_file: Callable[[], Path | None] = lambda: None
    """The gaps of a flight's photos, as `recon tag` writes them."""

    def ask(self, asked: schema.SurveyRequest, by: Person) -> schema.SurveyResponse:
        """Request a survey; an invalid region is refused at once."""
        return self.request(self._drafted(asked, self.ids), by)

    def draft_preview(
        self, asked: schema.SurveyRequest, serials: Sequence[str]
    ) -> DraftPreview | Refusal:
        """Return what plans and estimates a survey that is not requested; nothing is kept of it."""
        survey = self._drafted(asked, lambda: 0)
        station, frame = self.driver.station, self.site.frame
        if isinstance(survey, Refusal) or frame is None:
            return survey if isinstance(survey, Refusal) else Refusal(RULE, NO_SITE)
        surroundings = surroundings_of(station.airspace.airspace)

        def estimate() -> schema.SurveyEstimateView | Refusal:
            plan = plan_survey(survey, frame, surroundings)
            return plan if isinstance(plan, Refusal) else survey_preview(station, plan, serials)()

        return estimate

    def _drafted(self, asked: schema.SurveyRequest, ids: Callable[[], int]) -> Survey | Refusal:
        """Return the survey that is asked for, or why there is none; only one takes a number."""
        if (asked.height_above_takeoff_m is None) == (asked.height_above_ground_m is None):
            return Refusal(RULE, HEIGHT_FAULT)
        region = self._region(asked)
        if isinstance(region, Refusal):
            return region
        imagers, spare = self.driver.station.imaging.imagers, asked.spare_serial
        if spare is not None and spare not in imagers:
            known = ", ".join(imagers) or "none"
            text = f"{spare!a} is no imaging drone of the site; available: {known}"
            return Refusal(RULE, text)
        try:
            camera = _camera(asked.camera, self.site)
        except SurveyCameraError as problem:
            return Refusal(RULE, str(problem))
        # Without an imaging drone no shade is known, and all that can be done is flying rows once.
        planner = asked.planner or ("sunlit_first" if imagers else "lawnmower_once")
        return self._with_rows(_survey(ids(), asked, region, camera, planner), asked.rows)

    def drafted_again(self, asked: schema.SurveyAgainRequest) -> Survey | Refusal:
        """Return the survey of a flown region, or of what is left of it; not on the event loop."""
        self.flown.note()
        return survey_again(asked, self.ids(), self.flown, self.site, self.gaps_file())

    def flown_regions(self) -> schema.FlownRegionsView:
        """Return the regions that were surveyed, as of now; not on the event loop."""
        self.flown.note()
        now_ns = self.driver.now_ns()
        return flown_regions_view(self.flown, self.site, now_ns, self.gaps_file())

    def _with_rows(self, survey: Survey, rows: str) -> Survey | Refusal:
        if self.site.frame is None:
            return survey
        return with_rows(survey, self.site.frame, self.flown.all, RowChoice(rows), day_of)

    def request(self, survey: Survey | Refusal, by: Person) -> schema.SurveyResponse:
        """Request a survey that is drafted. Nothing flies yet."""
        if isinstance(survey, Refusal):
            return _refused(survey)
        self.driver.handle(SurveyRequested(survey, by.label))
        return self._taken(survey.id)

    def start(
        self, survey_id: int, asked: schema.SurveyStartRequest, by: Person
    ) -> schema.SurveyResponse:
        """Start a survey, unless that is refused; the audit has the refusal too."""
        named = tuple(dict.fromkeys(asked.serials))
        event = SurveyStarted(survey_id, named, by.label, asked.takeoff, asked.given_at_ns, by.name)
        refusal = start_refusal(self.driver.station, event, self.driver.now_ns())
        self.driver.handle(event)
        return self._taken(survey_id) if refusal is None else _refused(refusal)

    def stop(self, survey_id: int, *, is_aborted: bool, by: Person) -> schema.SurveyResponse:
        """Pause or abort a survey, unless that is refused."""
        event = SurveyStopped(survey_id, by.label, is_aborted)
        refusal = stop_refusal(self.driver.station, event, self.driver.now_ns())
        self.driver.handle(event)
        return self._taken(survey_id) if refusal is None else _refused(refusal)

    def view(self, survey_id: int) -> schema.SurveyView | None:
        """Return a survey in its present state."""
        station = self.driver.station
        record = station.surveys.records.get(survey_id)
        return None if record is None else survey_view(station, record, self.driver.now_ns())

    def paths(self, survey_id: int) -> schema.SurveyPaths | None:
        """Return a survey's planned rows and flown paths; None without rows."""
        record = self.driver.station.surveys.records.get(survey_id)
        return None if record is None else survey_paths(record)

    def preview(self, survey_id: int, serials: Sequence[str]) -> Preview | None:
        """Return what estimates a survey with these vehicles; None without rows."""
        station = self.driver.station
        record = station.surveys.records.get(survey_id)
        if record is None or record.state is None:
            return None
        return survey_preview(station, record.state.plan, serials)

    def exports(self, survey_id: int, serials: Sequence[str]) -> SurveyExports | None:
        """Return what writes a survey's flights for other programs; None without rows."""
        station = self.driver.station
        record = station.surveys.records.get(survey_id)
        if record is None or record.state is None:
            return None
        return SurveyExports(previewed_fleet(station, record.state.plan, serials))

    def cameras(self) -> list[schema.SurveyCameraView]:
        """Return the survey cameras that requests may name; the site's own come first."""
        known = {**self.site.cameras, **CAMERAS}
        return [_camera_view(self.site.cameras.get(name, model)) for name, model in known.items()]

    def cells(self, survey_id: int) -> SurveyCellStates | None:
        """Return a survey's cells, None without rows."""
        record = self.driver.station.surveys.records.get(survey_id)
        if record is None or record.state is None:
            return None
        state = record.state
        return SurveyCellStates(
            cells_number(state),
            state.progress.state,
            state.plan.cells.is_inside,
            state.progress.is_sun_known,
        )

    def _taken(self, survey_id: int) -> schema.SurveyResponse:
        return schema.SurveyResponse(**outcome_of(None), survey=self.view(survey_id))

    def _region(self, asked: schema.SurveyRequest) -> Region | Refusal:
        """Return the site's region of that name, or the polygon; exactly one must be given."""
        if (asked.region is None) == (asked.polygon is None):
            return Refusal(RULE, "Give either a region of the site or a polygon")
        if self.site.frame is None:
            return Refusal(RULE, NO_SITE)
        if asked.region is not None:
            return self._of_site(asked.region)
        geometry = {"type": "Polygon", "coordinates": asked.polygon}
        try:
            (region,) = regions_of(Feature("polygon", 1, {}, geometry), self.site.frame)
        except SiteError as problem:
            return Refusal(RULE, str(problem))
        return region

    def _of_site(self, name: str) -> Region | Refusal:
        regions = self.site.layers.survey_regions
        if name in regions:
            return regions[name]
        known = ", ".join(regions) or "none, site.toml has no survey_regions layer"
        return Refusal(RULE, f"Survey region {name!a} not found; available: {known}")


def _camera(asked: schema.SurveyCameraRequest, site: Site) -> SurveyCamera:
    if asked.model is None:
        return SurveyCamera(asked.across_deg, asked.along_deg, asked.interval_s, asked.across_px)
    model = camera_named(asked.model, site.cameras.values())
    fault = model.interval_fault(asked.interval_s)
    if fault is not None:
        raise SurveyCameraError(fault)
    return model.at_interval(asked.interval_s)


def _camera_view(model: CameraModel) -> schema.SurveyCameraView:
    return schema.SurveyCameraView(
        name=model.key,
        title=model.title,
        across_px=model.across_px,
        along_px=model.along_px,
        across_deg=model.across_deg,
        along_deg=model.along_deg,
        timer_s=list(model.timer_s),
        shutter=model.shutter,
        source=model.source,
    )


def _survey(
    number: int, asked: schema.SurveyRequest, region: Region, camera: SurveyCamera, planner: str
) -> Survey:
    budget = asked.budget
    return Survey(
        id=number,
        name=asked.name or asked.region or f"survey {number}",
        region=region,
        height_above_takeoff_m=asked.height_above_takeoff_m,
        height_above_ground_m=asked.height_above_ground_m,
        region_name=asked.region,
        speed_mps=asked.speed_mps,
        camera=camera,
        front_overlap=asked.front_overlap,
        side_overlap=asked.side_overlap,
        row_bearing_deg=asked.row_bearing_deg,
        planner=planner,
        budget=SurveyBudget(budget.rounds, budget.time_s, budget.flown_m),
        counts_neighbours=asked.counts_neighbours,
        cell_m=asked.cell_m,
        when_done=WhenDone(asked.when_done),
        side_step_allowed=asked.side_step_allowed,
        upwind_allowed=asked.upwind_allowed,
        relief_allowed=asked.relief_allowed,
        spare_serial=asked.spare_serial,
    )


def _refused(refusal: Refusal) -> schema.SurveyResponse:
    return schema.SurveyResponse(**outcome_of(refusal), survey=None)
