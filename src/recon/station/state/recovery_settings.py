"""How far what an earlier run of the station saw is believed."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RestartSettings:
    """Times in seconds; each with its reason."""

    forgotten_after_s: float = 5_400.0
    """Nothing that the aircraft of this size can carry keeps them in the air for an hour; half an
    hour more for a clock that was set."""

    settle_s: float = 10.0
    """After a start, where vehicles may be that the last run saw flying is no alarm and no reason
    to hold others for this long: apps connect again within seconds, and each vehicle that is heard
    already flies near the hazard areas of those that are about to be. The gate counts them from the
    first moment on."""

    fastest_mps: float = 25.0
    """Over the ground, with the wind, faster than any of these aircraft flies."""
    fastest_climb_mps: float = 10.0
    place_error_m: float = 30.0
    height_error_m: float = 5.0
    battery_gain_fraction: float = 0.03
    """A battery in flight only loses charge; one that gained more than its gauge errs was changed
    on the ground."""
