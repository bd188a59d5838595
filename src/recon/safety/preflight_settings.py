"""The checklist's thresholds, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PreflightSettings:
    """Beside what the site's limits and the gate's rules say."""

    early_battery_fraction: float = 0.5
    """A flight begun with less is a short one; somebody should know."""

    earliest_clock_s: float = 1_735_689_600.0
    """2025-01-01 UTC. A clock before this program was written was never set: a computer without a
    network starts in 1970, or where its battery ran out."""

    clock_set_s: float = 2.0
    """A clock that was set by more since the start: what is recorded no longer fits what other
    clocks say (photos, the sun)."""

    pad_ground_m: float = 5.0
    """A pad's altitude and the elevation model may differ by this: models are good to metres. A
    wrong pad puts every height of its vehicle wrong."""

    strong_wind_level: int = 2
    """The aircraft's own warning of strong wind."""

    least_go_home_m: float = 20.0
    most_go_home_m: float = 500.0
    """What DJI's aircraft can be set to: another number was never read off one."""
