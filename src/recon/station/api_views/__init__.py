"""The station's routes, and its state as the API's messages.

A route (`*_routes.py`) validates a request by `api/schema/`, makes the event that the driver
handles, and answers with what became of it. `*_view` functions turn the state into messages; they
only read it.
"""

from typing import Protocol, TypedDict

from recon.link.server import LinkServer
from recon.model.command import Refusal
from recon.model.event import Event
from recon.station.state.station import Station


class RunningStation(Protocol):
    """The driver as the API's service sees it."""

    @property
    def station(self) -> Station:
        """The state after the newest step."""

    @property
    def started_at_ns(self) -> int:
        """Station time of the start."""

    @property
    def links(self) -> LinkServer | None:
        """The TCP server for companion apps; None if the station runs without one."""

    def now_ns(self) -> int:
        """Return station time."""

    def handle(self, event: Event) -> None:
        """Step the station by an event before returning, unless a step is already running."""


class ActionOutcome(TypedDict):
    """The fields of `schema.ActionResponse`, with which other responses begin."""

    accepted: bool
    rule: str | None
    reason: str | None


def outcome_of(refusal: Refusal | None) -> ActionOutcome:
    """Return what a response states of a refusal; without one it was accepted."""
    if refusal is None:
        return ActionOutcome(accepted=True, rule=None, reason=None)
    return ActionOutcome(accepted=False, rule=refusal.rule, reason=refusal.reason)
