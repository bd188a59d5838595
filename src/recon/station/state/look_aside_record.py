"""The newest look aside of an imaging drone, and what lets one begin by itself."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

from recon.model.geo import LatLon


class LookAsideStage(Enum):
    """Life cycle of a look aside; nothing resumes one that has stopped."""

    ASIDE = "aside"
    """On the way from its place."""
    WAITING = "waiting"
    """Holding beside its place: the gate refuses the way back for now."""
    BACK = "back"
    """On the way back."""
    DONE = "done"
    """Back at its place, holding."""
    STOPPED = "stopped"
    """Ended before that, holding or flown by its pilot."""


@dataclass(frozen=True, slots=True)
class LookAside:
    """One look aside. `place` and height are where it began; `command_id` is the newest way's."""

    serial: str
    name: str
    by: str
    begun_at_ns: int
    place: LatLon
    height_above_takeoff_m: float
    bearing_deg: float
    command_id: int
    stage: LookAsideStage
    since_ns: int
    reason: str = ""
    survey_id: int | None = None
    """The survey for which it began by itself; None: a person asked for it."""
    judged_at_ns: int = 0
    """When the way back was last judged."""

    @property
    def is_over(self) -> bool:
        """Whether it is done or has stopped."""
        return self.stage in (LookAsideStage.DONE, LookAsideStage.STOPPED)

    def at(self, stage: LookAsideStage, now_ns: int, reason: str = "") -> "LookAside":
        """Return it at another stage."""
        return replace(self, stage=stage, since_ns=now_ns, reason=reason)


@dataclass(frozen=True, slots=True)
class LookAsides:
    """The newest look aside; since when light is mostly unknown below each imaging drone.

    That is by serial, and by the capture time of its own shade maps. `due_ns` is when one may begin
    by itself again, `refused` why the last one could not.
    """

    newest: LookAside | None = None
    unknown_since_ns: Mapping[str, int] = field(default_factory=dict)
    due_ns: int = 0
    refused: str | None = None
