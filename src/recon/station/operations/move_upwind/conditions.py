"""The alarms and the audit of a move upwind: what it costs and sees, and why it does not begin."""

from collections.abc import Iterator

from recon.model.event import Event
from recon.record.audit.audit import AuditEntry
from recon.station.operations.imager_motion.notices import (
    by_itself,
    cannot_begin,
    off_its_place,
    stage_entries,
)
from recon.station.state.alarm_book import Condition
from recon.station.state.imager_motion import MoveUpwind
from recon.station.state.station import Station

STAYS = "It stays there until it is sent elsewhere, or its survey is paused and started again"


def conditions(station: Station) -> Iterator[Condition]:
    """Yield what an operator must know: a motion without an order of now, and where it ended.

    Where it hovers after its survey matters to nothing that runs.
    """
    moves = station.upwind_moves
    newest, found, refused = moves.newest, moves.proposal, moves.refused
    if newest is not None and not newest.is_over:
        text = f"moves upwind for its survey: {newest.proposal.sentence}"
        yield from by_itself(station, newest, text)
    if moves.survey_id is not None:
        yield from off_its_place(station, newest, STAYS)
    if found is not None and refused is not None:
        text = f"the imaging drone {found.sentence}, and cannot fly there"
        yield from cannot_begin(MoveUpwind.rule, refused, found.serial, text)


def audit_entries(
    before: Station, _event: Event, after: Station, _now_ns: int
) -> Iterator[AuditEntry]:
    """Yield an entry for each change of stage."""
    new = after.upwind_moves.newest
    if new is not None:
        text = f"move upwind ({new.proposal.sentence})"
        details = {"distance_m": new.proposal.distance_m, "gain": new.proposal.gain}
        yield from stage_entries(before.upwind_moves.newest, new, text, details)
