"""What became of an order so far, as the station tells it."""

from collections.abc import Mapping

import msgspec

from recon.model.command import Phase


class PhaseChange(msgspec.Struct, frozen=True):
    """One change in an order's life; `age_s` as of the message that told it."""

    phase: Phase
    age_s: float
    note: str


class Life(msgspec.Struct, frozen=True):
    """An order's life; `history` ends with the present phase."""

    id: int
    kind: str
    serial: str | None
    vehicle_name: str
    phase: Phase
    note: str
    times_sent: int
    history: tuple[PhaseChange, ...]
    part: str | None = None
    """The part of a mission that is flown now, as in `part 2 of 3`; None for a mission of one."""
    rule: str | None = None
    """The safety rule that refused it; `note` is the reason."""
    parameters: Mapping[str, float | int | str] = {}
    """The refusal's measured values and limits, by name with unit."""

    @property
    def is_seen(self) -> bool:
        """Whether telemetry shows now that it is, or was, carried out."""
        return self.phase in (Phase.CONFIRMED, Phase.STARTED, Phase.DONE)

    @property
    def is_there(self) -> bool:
        """Whether a steered order's vehicle has come to its goal."""
        return self.has_reached(Phase.DONE)

    def has_reached(self, phase: Phase) -> bool:
        """Return whether the order is in this phase, has been, or has come farther.

        Confirmed and started are as far as each other: a mission starts where others are confirmed.
        """
        gone = (self.phase, *(change.phase for change in self.history))
        wanted = _HOW_FAR.get(phase)
        if wanted is None:
            return phase in gone
        return any(_HOW_FAR.get(passed, -1) >= wanted for passed in gone)


_HOW_FAR = {
    Phase.QUEUED: 0,
    Phase.SENT: 1,
    Phase.ACKNOWLEDGED: 2,
    Phase.CONFIRMED: 3,
    Phase.STARTED: 3,
    Phase.DONE: 4,
}
