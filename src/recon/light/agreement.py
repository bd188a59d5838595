"""How right shade maps are at places of which something else tells sun from shade."""

from dataclasses import dataclass

import numpy as np

from recon.light.points import is_sunlit
from recon.model.arrays import BoolArray
from recon.model.shade import FloatMap

SAYS = ("sun", "shade", "unknown")
SHOWN = ("sun", "shade")
NEAR_S = 2.5
"""A flight's maps are half a second apart, with gaps of seconds."""


@dataclass(frozen=True, slots=True)
class MapAgreement:
    """Counts of comparisons, by what the map says and what is shown on the ground."""

    counts: tuple[int, ...] = (0,) * 6
    """In the order of `SAYS`, and of `SHOWN` in each."""

    def count(self, says: str, shown: str) -> int:
        """Return how often a map said one thing where the other was shown."""
        return self.counts[2 * SAYS.index(says) + SHOWN.index(shown)]

    @property
    def total(self) -> int:
        """All comparisons."""
        return sum(self.counts)

    @property
    def known(self) -> int:
        """Comparisons at places that the maps know."""
        return sum(self.counts[:4])

    @property
    def right(self) -> int:
        """Comparisons in which the map said what was shown."""
        return self.counts[0] + self.counts[3]

    @property
    def sunlit_share(self) -> float:
        """Share of all comparisons in which sun was shown; 0 without any."""
        return sum(self.counts[::2]) / self.total if self.total else 0.0

    @property
    def unknown_share(self) -> float:
        """Share of all comparisons in which the map knew nothing; 0 without any."""
        return 1.0 - self.known / self.total if self.total else 0.0

    def __add__(self, other: "MapAgreement") -> "MapAgreement":
        return MapAgreement(tuple(a + b for a, b in zip(self.counts, other.counts, strict=True)))


def near_enough_s(step_s: float) -> float:
    """Return how far a value may be from a map's time, for a sensor that has one each `step_s`."""
    return max(step_s / 2.0, NEAR_S)


def compared(transmittance: FloatMap, direct: FloatMap) -> MapAgreement:
    """Return the comparisons of a map's values (N,), NaN where it knows nothing, with the share of
    the direct beam (N,) that was shown there; places where that is NaN do not count."""
    known, lit, in_sun = np.isfinite(transmittance), is_sunlit(transmittance), is_sunlit(direct)
    says: tuple[BoolArray, ...] = (known & lit, known & ~lit, ~known)
    shown = tuple(np.isfinite(direct) & each for each in (in_sun, ~in_sun))
    return MapAgreement(tuple(int((one & other).sum()) for one in says for other in shown))
