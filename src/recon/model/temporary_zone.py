"""Temporary zones: keep-out zones that a person draws and ends while vehicles fly."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType

from recon.model.geo import LatLon


class TemporaryZoneKind(Enum):
    """What a temporary zone is drawn for."""

    PERSON = "person"
    TRACTOR = "tractor"
    CREWED_AIRCRAFT = "crewed_aircraft"


DEFAULT_CEILING_M: Mapping[TemporaryZoneKind, float | None] = MappingProxyType(
    {
        TemporaryZoneKind.PERSON: 30.0,
        TemporaryZoneKind.TRACTOR: 30.0,
        TemporaryZoneKind.CREWED_AIRCRAFT: None,
    }
)
"""Ceilings above ground; None: all heights. Persons and machines are kept clear below usual go-home
heights (40 m and up): with a higher ceiling every flight whose failsafe would cross the zone on its
route home is refused. A crewed aircraft may be at any height."""


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle on the ground."""

    centre: LatLon
    radius_m: float


@dataclass(frozen=True, slots=True)
class Outline:
    """The corners of a polygon; the last one is joined to the first and not repeated."""

    corners: tuple[LatLon, ...]


@dataclass(frozen=True, slots=True)
class DrawnZone:
    """A temporary zone as a person draws it.

    Floor and ceiling are heights above ground; None where open-ended. `lasts_s` is None for a zone
    that lasts until a person ends it.
    """

    kind: TemporaryZoneKind
    shape: Circle | Outline
    reason: str
    floor_m: float | None = None
    ceiling_m: float | None = None
    lasts_s: float | None = None


@dataclass(frozen=True, slots=True)
class TemporaryZone:
    """A temporary zone in force: who drew it, when, and when it ends; times are station time."""

    id: int
    drawn: DrawnZone
    by: str
    drawn_at_ns: int
    ends_at_ns: int | None = None

    @property
    def name(self) -> str:
        """Its name in refusals and alarms, as in "person 3 (temporary)"."""
        return f"{self.drawn.kind.value.replace('_', ' ')} {self.id} (temporary)"
