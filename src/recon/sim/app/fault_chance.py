"""Faults by chance: so many an hour, drawn once from the seed, before anything is started."""

from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

from recon.sim.app.faults import Fault, FaultKind, is_for

S_PER_HOUR = 3_600.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Chance:
    """A fault that comes now and then to each vehicle that it is for."""

    kind: FaultKind
    vehicle: str
    per_hour: float
    """On average; the times between two begins are exponential."""
    shortest_s: float
    longest_s: float
    """Each lasts as long as is drawn evenly between the two."""
    from_s: float
    until_s: float
    """The last begins before this."""
    told_at: str = ""

    def is_for(self, serial: str, number: int) -> bool:
        """Return whether the vehicle with this serial, `number` of the fleet, may have it."""
        return is_for(self.vehicle, serial, number)

    def drawn(self, random: Random) -> Iterator[Fault]:
        """Yield one vehicle's faults, in order of time."""
        if self.per_hour < 1e-6:
            return
        start_s = self.from_s
        while (start_s := start_s + random.expovariate(self.per_hour / S_PER_HOUR)) < self.until_s:
            duration_s = random.uniform(self.shortest_s, self.longest_s)
            yield Fault(self.kind, self.vehicle, start_s, duration_s, self.told_at)


def drawn_faults(
    chances: tuple[Chance, ...], seed: int, serial: str, number: int
) -> tuple[Fault, ...]:
    """Return all that chance has for one vehicle; one entry's draws do not move another's."""
    return tuple(
        fault
        for row, chance in enumerate(chances)
        if chance.is_for(serial, number)
        for fault in chance.drawn(Random(f"{seed}/{serial}/chance {row}"))
    )
