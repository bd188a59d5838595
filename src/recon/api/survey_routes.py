"""Routes to surveys: asked for, started, paused, aborted, looked at."""

import asyncio
from typing import Literal

from fastapi import FastAPI, Request, Response

from recon.api import schema, sun_pictures
from recon.api.answering import PNG, PROBLEMS, found, who
from recon.api.port import StationPort
from recon.api.sun_routes import Form
from recon.model.survey import none_such

PLANNED_WITHIN_S = 10.0
"""Rows are worked out in tens of milliseconds, behind a frame's work or two."""
LOOKED_EVERY_S = 0.02


def add_survey_routes(app: FastAPI, port: StationPort) -> None:
    """Add them."""
    _add_words(app, port)
    _add_looks(app, port)


def _add_words(app: FastAPI, port: StationPort) -> None:
    @app.post("/api/surveys")
    async def ask(asked: schema.SurveyRequest, request: Request) -> schema.SurveyResponse:
        """Plan a survey of a region. Answered when its rows are worked out; nothing flies by it."""
        answer = port.ask_survey(asked, who(request))
        if answer.survey is None:
            return answer
        return _planned(await _until_planned(port, answer.survey))

    @app.post("/api/surveys/{survey_id}/start")
    async def start(
        survey_id: int, asked: schema.SurveyStartRequest, request: Request
    ) -> schema.SurveyResponse:
        """Fly a survey with these vehicles: by this word they are led by the station's guidance.

        Said of a running survey, the vehicles join it, or fly for it again.
        """
        by = who(request)
        return port.start_survey(survey_id, asked.serials, takeoff=asked.takeoff, by=by)

    @app.post("/api/surveys/{survey_id}/{word}")
    async def stop(
        survey_id: int, word: Literal["pause", "abort"], request: Request
    ) -> schema.SurveyResponse:
        """Pause a survey, or abort it for good. Its vehicles hold where they are."""
        return port.stop_survey(survey_id, is_aborted=word == "abort", by=who(request))


def _add_looks(app: FastAPI, port: StationPort) -> None:
    @app.get("/api/surveys")
    async def surveys() -> list[schema.SurveyView]:
        """The surveys of this run, the newest first."""
        return port.state().surveys

    @app.get("/api/surveys/{survey_id}", responses=PROBLEMS)
    async def survey(survey_id: int) -> schema.SurveyView:
        """One survey with its figures."""
        known = port.survey(survey_id)
        return found(known, "" if known is not None else _none_such(port, survey_id))

    @app.get("/api/surveys/{survey_id}/ways", responses=PROBLEMS)
    async def ways(survey_id: int) -> schema.SurveyWays:
        """A survey's planned rows, the missions flown now, and the ways flown so far."""
        rows = port.survey_ways(survey_id)
        return found(rows, "" if rows is not None else _no_rows(port, survey_id))

    @app.get(
        "/api/surveys/{survey_id}/cells.png", response_class=Response, responses=PROBLEMS | PNG
    )
    async def cells(survey_id: int, form: Form = "picture") -> Response:
        """A survey's cells: not yet, in shade, in sun; its corners are in the survey."""
        cells = port.survey_cells(survey_id)
        seen = found(cells, "" if cells is not None else _no_rows(port, survey_id))
        is_picture = form == "picture"
        draw = sun_pictures.cells_png if is_picture else sun_pictures.cells_values_png
        data = await asyncio.to_thread(draw, seen.state, seen.inside)
        headers = {"X-Frame-Id": str(seen.number)}
        return Response(data, media_type="image/png", headers=headers)


async def _until_planned(port: StationPort, asked: schema.SurveyView) -> schema.SurveyView:
    """Return a survey once its rows are worked out or refused, or as it is when that takes long."""
    newest = asked
    for _ in range(round(PLANNED_WITHIN_S / LOOKED_EVERY_S)):
        newest = port.survey(asked.id) or newest
        if newest.phase != "planning":
            break
        await asyncio.sleep(LOOKED_EVERY_S)
    return newest


def _planned(survey: schema.SurveyView) -> schema.SurveyResponse:
    if survey.phase == "refused":
        return schema.SurveyResponse(
            accepted=False, rule="survey", reason=survey.reason, survey=survey
        )
    return schema.SurveyResponse(accepted=True, rule=None, reason=None, survey=survey)


def _no_rows(port: StationPort, survey_id: int) -> str:
    survey = port.survey(survey_id)
    if survey is None:
        return _none_such(port, survey_id)
    return f"the survey {survey_id} has no rows: {survey.reason}"


def _none_such(port: StationPort, survey_id: int) -> str:
    return none_such(survey_id, ((s.id, s.name, s.phase) for s in port.state().surveys))
