"""The battery, and the load on it, as a multiple of the load of hovering in calm air.

In forward flight induced power falls first, then drag takes over: at 9 m/s of airspeed the load is
that of hovering again, at 15 m/s a quarter more. Climbing lifts the weight, sinking recovers some
of that. A test holds the station's energy model (docs/energy-model.md) to be more pessimistic than
this, at the winds and speeds named there.
"""

from dataclasses import dataclass
from math import hypot

from recon.model.vehicle import BatteryWarning
from recon.sim.flight.kinematics import AircraftMotion, Wind

LOW_FRACTION = 0.30
SERIOUS_FRACTION = 0.15
FORCED_LANDING_FRACTION = 0.05


@dataclass(slots=True)
class Battery:
    """Charge left, 0 to 1; `endurance_s` is the hover time of a full battery."""

    fraction: float
    endurance_s: float

    def drain(self, seconds: float, load: float) -> None:
        """Drain for `seconds` at a load in units of hovering in calm air."""
        self.fraction = max(0.0, self.fraction - load * seconds / self.endurance_s)

    def lose_a_cell(self, left_fraction: float) -> None:
        """Drop to `left_fraction` if there is more."""
        self.fraction = min(self.fraction, left_fraction)

    @property
    def percent(self) -> int:
        """Whole percent, rounded down."""
        return int(self.fraction * 100.0)

    @property
    def warning(self) -> BatteryWarning:
        """The warning by the aircraft's two thresholds."""
        if self.fraction < SERIOUS_FRACTION:
            return BatteryWarning.SERIOUS
        return BatteryWarning.LOW if self.fraction < LOW_FRACTION else BatteryWarning.NONE


GROUND_LOAD = 0.08
"""Electronics only, motors off."""
EASED = 1.0 / 600.0
"""Load saved per (m/s)2 of airspeed; with the next the load is 1 at 9 m/s and 1.25 at 15 m/s."""
DRAGGED = EASED / 9.0
"""Load added per (m/s)3."""
CLIMB_LOAD_PER_MPS = 0.16
"""A drone of 1.4 kg that hovers on 140 W needs 14 W per m/s, at about 60 % efficiency."""
SINK_RELIEF_PER_MPS = 0.04
"""Descending in its own downwash recovers little."""


def flying_load(motion: AircraftMotion, wind: Wind) -> float:
    """Return the load in flight (hover in calm air: 1); `wind` is north, east in m/s."""
    through_mps = hypot(motion.velocity_north_mps - wind[0], motion.velocity_east_mps - wind[1])
    level = 1.0 - EASED * through_mps**2 + DRAGGED * through_mps**3
    up_mps = motion.velocity_up_mps
    if up_mps > 0.0:
        return level + CLIMB_LOAD_PER_MPS * up_mps
    return level + SINK_RELIEF_PER_MPS * up_mps
