"""The shadows' common velocity."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ShadowMotion:
    """East and north."""

    east_mps: float
    north_mps: float
