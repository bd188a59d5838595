"""Surveys on the terminal: the answer to a command, and a table of each survey's state."""

import msgspec

from recon.cli.exit_codes import DONE, REFUSED
from recon.cli.output import print_json, print_line, print_table
from recon.client import Refusal, SurveyStatus, SurveyVehicle
from recon.model.survey import height_text
from recon.model.units import HECTARE_M2

PHASES = {"created": "planned"}
"""Words that differ from the API's."""


def print_answer(answer: SurveyStatus | Refusal, as_json: bool) -> int:
    """Print what a command to a survey did; return the exit code."""
    if as_json:
        print_json(msgspec.to_builtins(answer))
    elif isinstance(answer, Refusal):
        print_line(f"refused ({answer.rule}): {answer.reason}")
    else:
        print_line(_sentence(answer))
        print_surveys([answer])
    return REFUSED if isinstance(answer, Refusal) else DONE


def _sentence(survey: SurveyStatus) -> str:
    """Return the survey's number, phase and name; later commands use the number."""
    number, phase = survey.id, PHASES.get(survey.phase, survey.phase)
    sentence = f"survey {number}: {phase}, {survey.name}"
    if survey.rows_note:
        sentence = f"{sentence}. {survey.rows_note}"
    if survey.phase != "created":
        return sentence
    return f"{sentence}. Start it with `recon survey start {number} VEHICLE...`"


def print_surveys(surveys: list[SurveyStatus]) -> None:
    """Print surveys and their vehicles."""
    rows = [
        (
            f"survey {s.id}",
            s.name,
            PHASES.get(s.phase, s.phase),
            f"{s.rows} rows",
            height_text(s.height_above_takeoff_m, s.height_above_ground_m),
            *_areas(s),
            s.reason,
        )
        for s in surveys
    ]
    columns = (
        *("number", "name", "phase", "rows", "height", "region"),
        *("not reached", "not yet", "light unknown", "in shade", "in sun", "reason"),
    )
    print_table("surveys", columns, rows)
    members = [
        (f"survey {survey.id}", v.vehicle_name, _activity(v))
        for survey in surveys
        for v in survey.vehicles
    ]
    if members:
        print_table("vehicles", ("survey", "vehicle", "activity"), members)


def _activity(vehicle: SurveyVehicle) -> str:
    """What it does for its survey; a reason against flying counts more than a mission not ended."""
    flies = "flying rows" if vehicle.is_flying_rows else None
    return vehicle.not_flying_reason or flies or vehicle.refused or "idle"


def _areas(survey: SurveyStatus) -> tuple[str, ...]:
    figures = survey.figures
    if figures is None:
        return "", "", "", "", "", ""
    areas = {
        "": figures.region_m2,
        "not reached ": figures.region_m2 - figures.reached_m2,
        "not yet ": figures.not_yet_m2,
        "light unknown ": figures.sun_unknown_m2,
        "in shade ": figures.in_shade_m2,
        "in sun ": figures.in_sun_m2,
    }
    return tuple(f"{what}{area_m2 / HECTARE_M2:.2f} ha" for what, area_m2 in areas.items())
