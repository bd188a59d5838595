"""The shadows' common velocity."""

from dataclasses import dataclass
from math import hypot


@dataclass(frozen=True, slots=True)
class ShadowMotion:
    """East and north."""

    east_mps: float
    north_mps: float

    @property
    def speed_mps(self) -> float:
        """Speed over the ground."""
        return hypot(self.east_mps, self.north_mps)
