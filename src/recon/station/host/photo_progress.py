"""How far the work on photos is: pure changes of `PhotoJobView`, by what its commands print.

A command that is asked for it (`LINES_WANTED` in its environment) reports progress and results as
lines of JSON that begin with `LINE_MARK`; no text of a photo does, for it is printed escaped.
"""

import json
from typing import Any

from pydantic import ValidationError

from recon.api import schema
from recon.station.host.json_lines import LINE_MARK

WARNING = "warning: "
FACTS = frozenset(("doing", "share", "clocks", "counts", "gaps", "mosaic"))
MOST_WARNINGS, LONGEST_SENTENCE = 20, 500
STEPS: tuple[schema.PhotoStepName, ...] = ("clock", "tags", "gaps", "mosaic", "report")
FOUND_BY: tuple[tuple[str, schema.PhotoStepName, schema.PhotoStepName], ...] = (
    ("clocks", "clock", "tags"),
    ("counts", "tags", "gaps"),
)
"""What is reported when a step is done, the step, and the one after it."""
MADE: dict[schema.PhotoFileName, tuple[schema.PhotoStepName, str]] = {
    "tags.csv": ("gaps", "tagged/tags.csv"),
    "fly-again.geojson": ("gaps", "tagged/fly-again.geojson"),
    "mosaic.png": ("mosaic", "mosaic/preview.png"),
    "report.html": ("report", "report.html"),
}


def begun(flight: str, folders: list[str], out: str) -> schema.PhotoJobView:
    """Return a job that has found nothing yet."""
    return schema.PhotoJobView(
        flight=flight,
        folders=folders,
        out=out,
        state="running",
        steps=[schema.PhotoStepView(name=name, state="waiting", problem="") for name in STEPS],
        doing="",
        share=None,
        clocks=[],
        counts=None,
        gaps=None,
        mosaic=None,
        files=[],
        warnings=[],
    )


def marked(
    job: schema.PhotoJobView, name: schema.PhotoStepName, state: str, problem: str = ""
) -> schema.PhotoJobView:
    """Return the job with a step in another state; steps that are done have their files."""
    steps = [
        each.model_copy(update={"state": state, "problem": problem}) if each.name == name else each
        for each in job.steps
    ]
    done = {step.name for step in steps if step.state == "done"}
    files = [each for each, (step, _) in MADE.items() if step in done]
    return job.model_copy(update={"steps": steps, "files": files})


def running(job: schema.PhotoJobView) -> schema.PhotoStepName | None:
    """Return the step that runs, None between two commands."""
    return next((step.name for step in job.steps if step.state == "running"), None)


def after_line(job: schema.PhotoJobView, line: str) -> schema.PhotoJobView:
    """Return the job after a line of a command; one that says nothing of it changes nothing."""
    if line.startswith(LINE_MARK):
        return _after_facts(job, line[len(LINE_MARK) :])
    if line.startswith(WARNING):
        text = line.removeprefix(WARNING)[:LONGEST_SENTENCE]
        warnings = list(dict.fromkeys((*job.warnings, text)))[:MOST_WARNINGS]
        return job.model_copy(update={"warnings": warnings})
    return job


def _after_facts(job: schema.PhotoJobView, text: str) -> schema.PhotoJobView:
    try:
        facts: Any = json.loads(text)
        if not isinstance(facts, dict) or not facts.keys() <= FACTS:
            return job
        job = schema.PhotoJobView.model_validate(job.model_dump() | facts)
    except (ValueError, ValidationError, RecursionError):
        return job
    for fact, step, following in FOUND_BY:
        if facts.get(fact) and running(job) == step:
            job = marked(marked(job, step, "done"), following, "running")
    return job
