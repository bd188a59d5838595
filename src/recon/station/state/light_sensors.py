"""Light sensors on the ground, beside what the shade maps say where they are.

For people and the record alone: nothing here is read by guidance, the gate or any order.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from recon.light.agreement import MapAgreement
from recon.light.points import FULL_PERCENTILE, direct_share, is_sunlit
from recon.model.geo import LatLon
from recon.model.units import NS_PER_S, seconds_to_ns

READINGS_KEPT = 32
LEAST_STEP_NS = NS_PER_S // 2
"""Maps are not closer in time; of a faster sensor fewer readings are kept."""
SAMPLE = 256
"""Values kept of the whole run, evenly: full light is their 98th percentile."""
STALE_STEPS, LEAST_STALE_S, MOST_STALE_S = 3.0, 10.0, 300.0
"""A sensor is stale after so many of its steps, within these bounds."""

Reading = tuple[int, float]
"""Station time and value."""


@dataclass(frozen=True, slots=True)
class LightSensor:
    """One sensor: its newest readings, and how the maps have agreed with it."""

    source: str
    place: LatLon | None = None
    readings: tuple[Reading, ...] = ()
    """The newest, in the order of their times."""
    sample: tuple[float, ...] = ()
    every: int = 1
    """Of so many values the sample has one."""
    seen: int = 0
    """Values so far."""
    shows: float | None = None
    """Share of the direct beam of the newest value; None while full light is not known."""
    says: float | None = None
    """Transmittance of the newest shade map at its place; None where that knows nothing."""
    agreement: MapAgreement = field(default_factory=MapAgreement)

    @property
    def step_s(self) -> float:
        """Usual seconds between two readings; 0 for a single one."""
        times_ns = [at_ns for at_ns, _value in self.readings]
        return float(np.median(np.diff(times_ns))) / NS_PER_S if len(times_ns) > 1 else 0.0

    def is_live(self, now_ns: int) -> bool:
        """Return whether its newest reading is of now; a clock that is ahead is no better."""
        stale_s = min(max(STALE_STEPS * self.step_s, LEAST_STALE_S), MOST_STALE_S)
        return abs(now_ns - self.readings[-1][0]) <= seconds_to_ns(stale_s)

    def direct(self, value: float) -> float | None:
        """Return the share of the direct beam of a value, by the rule of `recon.light.points`.

        None until the sensor has seen sun and shade: before that, full light is not known.
        """
        sample = np.array(self.sample)
        full = float(np.percentile(sample, FULL_PERCENTILE)) if len(sample) else 0.0
        if full <= 0.0 or bool(is_sunlit(direct_share(sample, full)).all()):
            return None
        return float(direct_share(np.array([value]), full)[0])

    def with_reading(self, at_ns: int, value: float, place: LatLon | None) -> "LightSensor":
        """Return it with its next reading."""
        kept = self.readings
        if len(kept) > 1 and at_ns - kept[-2][0] < LEAST_STEP_NS:
            kept = kept[:-1]
        sample, every = self.sample, self.every
        if self.seen % every == 0:
            sample = (*sample, value)
            if len(sample) > SAMPLE:
                sample, every = sample[::2], 2 * every
        return replace(
            self,
            place=place or self.place,
            readings=(*kept, (at_ns, value))[-READINGS_KEPT:],
            sample=sample,
            every=every,
            seen=self.seen + 1,
        )


@dataclass(frozen=True, slots=True)
class LightSensors:
    """All sensors of this run, by name."""

    sensors: Mapping[str, LightSensor] = field(default_factory=dict)
    compared_number: int = 0
    """Number of the shade map that they were compared with last."""
    refused: int = 0
    """Lines that could not be used."""
    problem: str = ""
    """Why the newest of them could not, and of which logger."""
    problem_at_ns: int | None = None
    """When that was; None without one."""
