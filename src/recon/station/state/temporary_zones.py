"""The temporary zones in force."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from recon.model.temporary_zone import TemporaryZone


@dataclass(frozen=True, slots=True)
class TemporaryZones:
    """Temporary zones in force by id, oldest first; an id is never reused, even after a restart.

    `changes` counts what was drawn and ended: plans made before the newest change are old.
    """

    in_force: Mapping[int, TemporaryZone] = field(default_factory=lambda: MappingProxyType({}))
    next_id: int = 1
    changes: int = 0
