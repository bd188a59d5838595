"""A flight battery, as simple as it can be: a share that drains under load."""

from dataclasses import dataclass

from recon.model.vehicle import BatteryWarning

LOW_FRACTION = 0.30
SERIOUS_FRACTION = 0.15
FORCED_LANDING_FRACTION = 0.05


@dataclass(slots=True)
class Battery:
    """What is left, 0..1; `endurance_s` is the hover time of a full one."""

    fraction: float
    endurance_s: float

    def drain(self, seconds: float, load: float) -> None:
        """Use `seconds` worth; `load` counts in hovering in calm air."""
        self.fraction = max(0.0, self.fraction - load * seconds / self.endurance_s)

    def lose_a_cell(self, left_fraction: float) -> None:
        """Keep so much at most."""
        self.fraction = min(self.fraction, left_fraction)

    @property
    def percent(self) -> int:
        """Whole percent, rounded down."""
        return int(self.fraction * 100.0)

    @property
    def warning(self) -> BatteryWarning:
        """What the aircraft's two thresholds say."""
        if self.fraction < SERIOUS_FRACTION:
            return BatteryWarning.SERIOUS
        return BatteryWarning.LOW if self.fraction < LOW_FRACTION else BatteryWarning.NONE
