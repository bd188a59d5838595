"""How far a mission has been flown: its parts, and what their chain hangs on."""

from dataclasses import dataclass

from recon.model.authority import ControlAuthority
from recon.model.mission import Mission


@dataclass(frozen=True, slots=True)
class FlightPlan:
    """A mission as it is sent: one part, or several flown one after the other.

    A next part is only sent while the chain is whole: `link_id` is the link the order went to,
    `lead` who led the vehicle then, and `heard_at_ns` when telemetry came last. `broken` says why
    no further part will be flown.
    """

    parts: tuple[Mission, ...]
    repairs: tuple[str, ...] = ()
    index: int = 0
    """Of the part sent last."""
    link_id: int | None = None
    authority: ControlAuthority | None = None
    heard_at_ns: int | None = None
    broken: str | None = None

    @property
    def part(self) -> Mission:
        """The part sent last."""
        return self.parts[self.index]

    @property
    def is_last(self) -> bool:
        """Whether no part follows the present one."""
        return self.index + 1 >= len(self.parts)

    @property
    def label(self) -> str:
        """The present part as people name it; nothing for a mission of one."""
        return "" if len(self.parts) == 1 else f"part {self.index + 1} of {len(self.parts)}"
