"""Routes for surveys: request, start, pause, abort, read."""

import asyncio
from typing import Annotated, Literal

from fastapi import FastAPI, HTTPException, Query, Request, Response

from recon.api import pictures, schema
from recon.api.responses import PNG, PROBLEMS, found, png
from recon.api.security import person_of
from recon.model.command import Refusal
from recon.model.survey import unknown_survey
from recon.plans.flight_plan import PlanExportError
from recon.station.api_views.picture_routes import Form
from recon.station.api_views.service import Service

Serials = Annotated[
    list[Annotated[str, Query(max_length=2048)]],
    Query(max_length=64, description="vehicles; none: one drone"),
]
Named = Annotated[str | None, Query(max_length=64)]
PlanKind = Literal["kmz", "plan", "survey.plan", "waypoints", "csv", "kml", "gpx"]
FILE: dict[int | str, dict[str, object]] = {
    200: {"content": {"application/octet-stream": {}, "application/zip": {}}}
}
NOT_HELD: dict[int | str, dict[str, object]] = {422: {"model": schema.Problem}}

PLANNED_WITHIN_S = 10.0
"""Planning takes tens of milliseconds, after one or two frames in the worker's queue."""
POLL_EVERY_S = 0.02


def add_survey_routes(app: FastAPI, service: Service) -> None:
    """Add all routes of this module."""
    _add_commands(app, service)
    _add_views(app, service)
    _add_exports(app, service)


def _add_commands(app: FastAPI, service: Service) -> None:
    @app.post("/api/surveys")
    async def ask(asked: schema.SurveyRequest, request: Request) -> schema.SurveyResponse:
        """Plan a survey of a region. Responds when its rows are planned; nothing flies."""
        answer = service.surveys.ask(asked, person_of(request))
        if answer.survey is None:
            return answer
        return _planned(await _until_planned(service, answer.survey))

    @app.post("/api/surveys/again")
    async def again(asked: schema.SurveyAgainRequest, request: Request) -> schema.SurveyResponse:
        """Plan a survey of a flown region on its rows: what is left, or all. Nothing flies."""
        drafted = await asyncio.to_thread(service.surveys.drafted_again, asked)
        answer = service.surveys.request(drafted, person_of(request))
        if answer.survey is None:
            return answer
        return _planned(await _until_planned(service, answer.survey))

    estimating = asyncio.Lock()

    @app.post("/api/surveys/estimate", responses=NOT_HELD)
    async def draft_estimate(
        asked: schema.SurveyRequest,
        serial: Serials = [],  # noqa: B006
    ) -> schema.SurveyEstimateView:
        """What a survey would take, without requesting it: its `survey_id` is 0."""
        work = service.surveys.draft_preview(asked, serial)
        if isinstance(work, Refusal):
            raise HTTPException(422, work.reason)
        # A form asks while it is typed into: planning must not take every thread.
        async with estimating:
            made = await asyncio.to_thread(work)
        if isinstance(made, Refusal):
            raise HTTPException(422, made.reason)
        return made

    @app.post("/api/surveys/{survey_id}/start")
    async def start(
        survey_id: int, asked: schema.SurveyStartRequest, request: Request
    ) -> schema.SurveyResponse:
        """Start a survey with these vehicles: control authority passes to the station's guidance.

        On a running survey the vehicles join, or resume.
        """
        return service.surveys.start(survey_id, asked, person_of(request))

    @app.post("/api/surveys/{survey_id}/{command}")
    async def stop(
        survey_id: int, command: Literal["pause", "abort"], request: Request
    ) -> schema.SurveyResponse:
        """Pause a survey, or abort it for good. Its vehicles hold where they are."""
        return service.surveys.stop(survey_id, is_aborted=command == "abort", by=person_of(request))


def _add_views(app: FastAPI, service: Service) -> None:
    @app.get("/api/surveys")
    async def surveys() -> list[schema.SurveyView]:
        """The surveys of this run, the newest first."""
        return service.state().surveys

    @app.get("/api/surveys/{survey_id}", responses=PROBLEMS)
    async def survey(survey_id: int) -> schema.SurveyView:
        """One survey with its figures."""
        known = service.surveys.view(survey_id)
        return found(known, "" if known is not None else _unknown_survey(service, survey_id))

    @app.get("/api/surveys/{survey_id}/paths", responses=PROBLEMS)
    async def paths(survey_id: int) -> schema.SurveyPaths:
        """A survey's planned rows, the missions in flight, and the paths flown so far."""
        rows = service.surveys.paths(survey_id)
        return found(rows, "" if rows is not None else _no_rows(service, survey_id))

    @app.get("/api/surveys/{survey_id}/estimate", responses=PROBLEMS)
    async def estimate(
        survey_id: int,
        serial: Serials = [],  # noqa: B006
    ) -> schema.SurveyEstimateView:
        """What a survey will take with these vehicles: time, photos, batteries. Nothing flies."""
        work = service.surveys.preview(survey_id, serial)
        return await asyncio.to_thread(
            found(work, "" if work is not None else _no_rows(service, survey_id))
        )

    @app.get("/api/flown-regions")
    async def flown_regions() -> schema.FlownRegionsView:
        """The regions that were surveyed on any day: when each was imaged, and what is left."""
        return await asyncio.to_thread(service.surveys.flown_regions)

    @app.get("/api/cameras")
    async def cameras() -> list[schema.SurveyCameraView]:
        """The survey cameras that a request may name: the table's and the site's own."""
        return service.surveys.cameras()

    @app.get(
        "/api/surveys/{survey_id}/cells.png", response_class=Response, responses=PROBLEMS | PNG
    )
    async def cells(survey_id: int, form: Form = "picture") -> Response:
        """A survey's cells: not imaged, light unknown, in shade, in sun; corners in the survey."""
        cells = service.surveys.cells(survey_id)
        known = found(cells, "" if cells is not None else _no_rows(service, survey_id))
        is_picture = form == "picture"
        draw = pictures.cells_png if is_picture else pictures.cells_values_png
        data = await asyncio.to_thread(draw, known.state, known.inside, known.light_known)
        return png(data, known.number)


def _add_exports(app: FastAPI, service: Service) -> None:
    @app.get("/api/surveys/{survey_id}/exports", responses=PROBLEMS)
    async def exports(
        survey_id: int,
        serial: Serials = [],  # noqa: B006
        aircraft: Named = None,
        payload: Named = None,
    ) -> schema.PlanExportsView:
        """In which formats a survey's flights can be downloaded, for other programs to fly."""
        known = service.surveys.exports(survey_id, serial)
        made = found(known, "" if known is not None else _no_rows(service, survey_id))
        return await asyncio.to_thread(made.view, aircraft, payload)

    @app.get(
        "/api/surveys/{survey_id}/plan.{kind}",
        response_class=Response,
        responses=PROBLEMS | FILE | NOT_HELD,
    )
    async def plan_file(
        survey_id: int,
        kind: PlanKind,
        serial: Serials = [],  # noqa: B006
        aircraft: Named = None,
        payload: Named = None,
    ) -> Response:
        """A survey's flights in a format; several files come as an archive. Nothing flies.

        The station neither watches nor stops an aircraft that another program flies.
        """
        known = service.surveys.exports(survey_id, serial)
        made = found(known, "" if known is not None else _no_rows(service, survey_id))
        try:
            file = await asyncio.to_thread(made.file, kind, aircraft, payload)
        except PlanExportError as problem:
            raise HTTPException(422, str(problem)) from problem
        headers = {"Content-Disposition": f'attachment; filename="{file.name}"'}
        return Response(file.data, media_type=file.media_type, headers=headers)


async def _until_planned(service: Service, asked: schema.SurveyView) -> schema.SurveyView:
    """Return a survey once it is planned or refused, or as it is after `PLANNED_WITHIN_S`."""
    newest = asked
    for _ in range(round(PLANNED_WITHIN_S / POLL_EVERY_S)):
        newest = service.surveys.view(asked.id) or newest
        if newest.phase != "planning":
            break
        await asyncio.sleep(POLL_EVERY_S)
    return newest


def _planned(survey: schema.SurveyView) -> schema.SurveyResponse:
    if survey.phase == "refused":
        return schema.SurveyResponse(
            accepted=False, rule="survey", reason=survey.reason, survey=survey
        )
    return schema.SurveyResponse(accepted=True, rule=None, reason=None, survey=survey)


def _no_rows(service: Service, survey_id: int) -> str:
    survey = service.surveys.view(survey_id)
    if survey is None:
        return _unknown_survey(service, survey_id)
    return f"Survey {survey_id} has no rows: {survey.reason}"


def _unknown_survey(service: Service, survey_id: int) -> str:
    return unknown_survey(survey_id, ((s.id, s.name, s.phase) for s in service.state().surveys))
