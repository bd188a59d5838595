"""Limits for what a restart restores."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RestartSettings:
    """Times in seconds."""

    forgotten_after_s: float = 5_400.0
    """No aircraft of this size flies for an hour; half an hour more for a clock that was set."""

    settle_s: float = 10.0
    """For this long after a restart, hazard areas of restored vehicles raise no alarm and hold no
    other vehicle: apps reconnect within seconds, and each vehicle that reports again is close to
    the hazard areas of those that are about to. The gate counts these areas from the start."""

    fastest_mps: float = 25.0
    """Ground speed in strong wind that none of these aircraft exceeds."""
    fastest_climb_mps: float = 10.0
    place_error_m: float = 30.0
    height_error_m: float = 5.0
    battery_gain_fraction: float = 0.03
    """A battery in flight only discharges; a gain beyond its gauge error means that it was replaced
    on the ground."""
