"""Audit entries of surveys: operator commands, and changes of phase."""

from collections.abc import Iterator
from typing import Any

from recon.model.command import Refusal
from recon.model.event import Event, SurveyRequested, SurveyStarted, SurveyStopped
from recon.record.audit.audit import AuditEntry
from recon.station.operations.survey.commands import start_refusal, stop_refusal
from recon.station.operations.survey.planning import refusal_of
from recon.station.state.station import Station


def survey_entries(
    before: Station, event: Event, after: Station, now_ns: int
) -> Iterator[AuditEntry]:
    """Yield an entry for each command to a survey, and for each change of its phase."""
    match event:
        case SurveyRequested(survey, by):
            refusal = refusal_of(before)
            details = {"id": survey.id, "planner": survey.planner}
            yield _command(
                "asked", f"survey {survey.name}", "is being planned", by, refusal, details
            )
        case SurveyStarted(number, serials, by, takeoff):
            refusal = start_refusal(before, event, now_ns)
            permission = "takeoff allowed" if takeoff else "takeoff not allowed"
            text = f"starts with {', '.join(serials)}; {permission}"
            details = {"id": number, "serials": list(serials), "takeoff": takeoff}
            yield _command("started", _name(before, number), text, by, refusal, details)
        case SurveyStopped(number, by, is_aborted):
            refusal = stop_refusal(before, event, now_ns)
            record = before.surveys.records.get(number)
            kind = "aborted" if is_aborted else "paused"
            text = f"is {kind}; its vehicles hold"
            if record is not None and record.is_over and refusal is None:
                kind, text = "held", "is over; vehicles returning home hold"
            yield _command(kind, _name(before, number), text, by, refusal, {"id": number})
    if after.surveys is not before.surveys:
        yield from _changes(before, event, after)


def _command(
    kind: str, name: str, text: str, by: str, refusal: Refusal | None, details: dict[str, Any]
) -> AuditEntry:
    if refusal is None:
        return AuditEntry(f"survey.{kind}", f"{name} {text}", by, details=details)
    why = {**details, "asked": kind, "rule": refusal.rule, "reason": refusal.reason}
    return AuditEntry("survey.refused", f"{name}: refused: {refusal.reason}", by, details=why)


def _changes(before: Station, event: Event, after: Station) -> Iterator[AuditEntry]:
    """Changes of phase without a command: planned, impossible, done, paused automatically."""
    if isinstance(event, SurveyStarted | SurveyStopped | SurveyRequested):
        return
    for number, record in after.surveys.records.items():
        phase, reason = record.phase
        old = before.surveys.records.get(number)
        if old is None or old is record or old.phase[0] == phase:
            continue
        text = f"survey {record.survey.name} is {phase}: {reason}"
        details = {"id": number, "phase": phase, "reason": reason}
        yield AuditEntry(f"survey.is_{phase}", text, "station", details=details)


def _name(station: Station, number: int) -> str:
    record = station.surveys.records.get(number)
    return f"survey {number}" if record is None else f"survey {record.survey.name}"
