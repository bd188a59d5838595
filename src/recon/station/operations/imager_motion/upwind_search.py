"""The search for a place upwind: a job every ten seconds, and since when its answer is better."""

from collections.abc import Sequence
from dataclasses import replace

from recon.guidance.upwind_proposal import (
    LEAST_GAIN,
    MOVE_UPWIND_SETTINGS,
    MoveUpwindSettings,
    UpwindProposal,
    UpwindQuestion,
    propose,
)
from recon.model.airspace import Region
from recon.model.units import seconds_to_ns
from recon.station.imaging.upwind import upwind_question
from recon.station.state.alarm_book import Condition, Severity
from recon.station.state.imager_motion import MoveUpwind, UpwindSearch
from recon.station.state.station import Station
from recon.station.state.steps import Job, JobKind, Stepped


def search(
    station: Station, regions: Sequence[Region], settings: MoveUpwindSettings, now_ns: int
) -> Stepped:
    """Start a job for the best place over these regions, if one is due and can be found."""
    upwind = station.imager_motions.upwind
    every_s = settings.asked_every_s if upwind.job_id is None else settings.answered_within_s
    if upwind.asked_at_ns is not None and now_ns - upwind.asked_at_ns < seconds_to_ns(every_s):
        return station, ()
    asked = upwind_question(station, regions, None, now_ns)
    if isinstance(asked, str):
        return with_search(station, _without(upwind, now_ns)), ()
    number = upwind.next_job_id
    upwind = replace(upwind, asked_at_ns=now_ns, job_id=number, next_job_id=number + 1)
    return with_search(station, upwind), (Job(number, PROPOSE_UPWIND, asked),)


def with_search(station: Station, upwind: UpwindSearch) -> Station:
    """Return the station with another state of the search."""
    return replace(station, imager_motions=replace(station.imager_motions, upwind=upwind))


def _proposed(station: Station, job_id: int, found: UpwindProposal, now_ns: int) -> Stepped:
    upwind = station.imager_motions.upwind
    if job_id != upwind.job_id:
        return station, ()
    since_ns = upwind.better_since_ns
    if found.gain < LEAST_GAIN:
        since_ns = None
    elif since_ns is None and found.gain >= MOVE_UPWIND_SETTINGS.better_by:
        since_ns = now_ns
    upwind = replace(upwind, job_id=None, proposal=found, better_since_ns=since_ns)
    return with_search(station, upwind), ()


def _failed(station: Station, job_id: int, error: str, now_ns: int) -> Stepped:
    station, _ = _dropped(station, job_id, now_ns)
    rule = MoveUpwind.rule
    text = f"no place upwind is proposed for the imaging drone: {error}"
    return station.with_alarm(
        Condition(f"{rule}:error", Severity.WARNING, rule, "", text), now_ns
    ), ()


def _dropped(station: Station, job_id: int, now_ns: int) -> Stepped:
    upwind = station.imager_motions.upwind
    if job_id != upwind.job_id:
        return station, ()
    return with_search(station, _without(upwind, now_ns)), ()


PROPOSE_UPWIND: JobKind[UpwindQuestion, UpwindProposal] = JobKind(
    "propose_upwind", lambda _site: propose, _proposed, _failed, _dropped
)
"""Finds the place from which an imaging drone sees most of the shade to come."""


def _without(upwind: UpwindSearch, now_ns: int) -> UpwindSearch:
    """Return it without a proposal, until the next one is due."""
    return replace(upwind, asked_at_ns=now_ns, job_id=None, proposal=None, better_since_ns=None)
